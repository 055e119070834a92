/* tests/stress/family_random.c - networks that no one would build, but that have a solution: every source is
 * in series with a resistor or beside one, so no devices can contradict it. */
#include <math.h>

#include "maker.h"

typedef struct ranges {
    double r, c, l; /* decades about 100 ohm, 1 uF, 1 mH */
    int nodes;
} ranges;

static ranges begin(maker *m, int most, double decades) {
    const int nodes = dice_size(&m->d, 2, most);
    maker_times(m, 1e3, draw_even(m, 4, 15));
    m->coss = m->parasites = m->snubbers = 0;
    m->gate_rc = 0;
    return (ranges){decades, decades, decades, nodes};
}

static const char *any(maker *m, const ranges *w) {
    const int i = draw_one(m, w->nodes + 1);
    return i == 0 ? "0" : indexed("n", i);
}

/* Two that differ. */
static void any_two(maker *m, const ranges *w, const char **p, const char **n) {
    const int i = draw_one(m, w->nodes + 1), j = (i + 1 + draw_one(m, w->nodes)) % (w->nodes + 1);
    *p = i == 0 ? "0" : indexed("n", i);
    *n = j == 0 ? "0" : indexed("n", j);
}

/* One that is not node i. */
static const char *other(maker *m, const ranges *w, int i) {
    const int j = (i + 1 + draw_one(m, w->nodes)) % (w->nodes + 1);
    return j == 0 ? "0" : indexed("n", j);
}

static double about(maker *m, double middle, double decades) {
    return draw(m, middle * pow(10, -decades / 2), middle * pow(10, decades / 2));
}

static void source(maker *m, const ranges *w) {
    const char *p = any(m, w), *n = any(m, w), *inner = node(m, "v");
    const double V = draw(m, 0.1, 100);
    const int kind = draw_one(m, 4);
    if (kind == 0)
        netlist_put(m->n, "V%d %s %s %.4g", ++m->ids, inner, n, V);
    else if (kind == 1)
        netlist_put(m->n, "V%d %s %s SIN(0 %.4g %.4g 0 0 %d)", ++m->ids, inner, n, V, draw(m, 0.3, 10) / m->T,
                    90 * draw_one(m, 4));
    else
        netlist_put(m->n, "V%d %s %s PULSE(%.4g %.4g %.4g %.4g %.4g %.4g %.6g)", ++m->ids, inner, n,
                    -V * (kind == 3), V, m->T * draw_even(m, 0, 1), m->T * draw(m, 1e-6, 0.1),
                    m->T * draw(m, 1e-6, 0.1), m->T * draw_even(m, 0.1, 0.5), m->T * draw_even(m, 0.8, 2));
    resistor(m, inner, p, about(m, 100, w->r));
}

static void passive(maker *m, const ranges *w) {
    const char *p, *n;
    const int kind = draw_one(m, 10);
    any_two(m, w, &p, &n);
    if (kind < 4)
        resistor(m, p, n, about(m, 100, w->r));
    else if (kind < 7)
        plain_c(m, p, n, about(m, 1e-6, w->c), chance(m, 0.3) ? draw_even(m, -10, 10) : 0);
    else
        netlist_put(m->n, "L%d %s %s %.4g ic=0", ++m->ids, p, n, about(m, 1e-3, w->l));
}

static void device(maker *m, const ranges *w, int own_state) {
    const char *p, *n;
    any_two(m, w, &p, &n);
    if (chance(m, 0.6)) {
        netlist_put(m->n, "AD%d %s %s md", ++m->ids, p, n);
    } else if (own_state && chance(m, 0.5)) {
        const char *model = node(m, "mo");
        netlist_put(m->n, ".model %s ideal_switch(vt=%.4g vh=%.4g)", model, draw_even(m, -5, 5),
                    draw(m, 0.01, 3));
        netlist_put(m->n, "AS%d %s %s %s %s %s", ++m->ids, p, n, any(m, w), any(m, w), model);
    } else {
        const char *g = node(m, "g");
        gate(m, g, draw_even(m, 0, 1), draw_even(m, 0.1, 0.9));
        contact(m, p, n, g, "0");
    }
}

/* Every node reaches ground by a resistor, a chain of them, or capacitors only. */
static void ground_all(maker *m, const ranges *w) {
    for (int i = 1; i <= w->nodes; i++) {
        const char *to = i == 1 ? "0" : indexed("n", 1 + draw_one(m, i - 1));
        if (chance(m, 0.6))
            resistor(m, indexed("n", i), to, about(m, 100, w->r));
        else
            plain_c(m, indexed("n", i), to, about(m, 1e-6, w->c), 0);
    }
}

static void fill(maker *m, const ranges *w, int own_state) {
    const int sources = 1 + draw_one(m, 3);
    for (int i = 0; i < sources; i++)
        source(m, w);
    ground_all(m, w);
    for (int i = 0; i < w->nodes; i++)
        passive(m, w);
    const int devices = 1 + draw_one(m, w->nodes < 12 ? w->nodes : 12);
    for (int i = 0; i < devices; i++)
        device(m, w, own_state);
}

static void random_small(maker *m) {
    const ranges w = begin(m, 8, 2);
    fill(m, &w, 0);
}

static void random_large(maker *m) {
    const ranges w = begin(m, 60, 2);
    fill(m, &w, 0);
}

static void random_wide(maker *m) { /* values over 18 decades */
    const ranges w = begin(m, 12, 18);
    fill(m, &w, 0);
}

static void random_feedback(maker *m) { /* switches that the state controls, with hysteresis */
    const ranges w = begin(m, 10, 2);
    fill(m, &w, 1);
}

static void random_ideal(maker *m) {
    const ranges w = begin(m, 12, 3);
    maker_ideality(m);
    fill(m, &w, 0);
}

static void capacitor_loops(maker *m) {
    const ranges w = begin(m, 8, 2);
    source(m, &w);
    for (int i = 1; i <= w.nodes; i++)
        plain_c(m, indexed("n", i), i == 1 ? "0" : indexed("n", i - 1), about(m, 1e-6, w.c),
                draw_even(m, -10, 10));
    plain_c(m, indexed("n", w.nodes), "0", about(m, 1e-6, w.c), draw_even(m, -10, 10));
    for (int i = 0; i < w.nodes; i++) {
        const char *p, *n;
        any_two(m, &w, &p, &n);
        plain_c(m, p, n, about(m, 1e-6, w.c), draw_even(m, -10, 10));
        device(m, &w, 0);
    }
    resistor(m, indexed("n", 1), "0", about(m, 100, w.r));
}

static void inductor_cutsets(maker *m) {
    const ranges w = begin(m, 8, 2);
    source(m, &w);
    for (int i = 1; i <= w.nodes; i++) { /* nodes that only inductors and devices reach */
        for (int k = 0; k < 2; k++)
            netlist_put(m->n, "L%d %s %s %.4g ic=0", ++m->ids, indexed("n", i), other(m, &w, i),
                        about(m, 1e-3, w.l));
        device(m, &w, 0);
        if (chance(m, 0.5))
            resistor(m, indexed("n", i), other(m, &w, i), about(m, 100, w.r));
    }
    resistor(m, indexed("n", 1), "0", about(m, 100, w.r));
}

/* Windings with k up to 1. */
static void coupled(maker *m) {
    const ranges w = begin(m, 6, 2);
    const int windings = 2 + draw_one(m, 3);
    const double k = chance(m, 0.4) ? 1 : 1 - draw(m, 1e-9, 0.5);
    const char *l[4];
    fill(m, &w, 0);
    for (int i = 0; i < windings; i++) {
        const char *inner = node(m, "w");
        const char *p, *n;
        any_two(m, &w, &p, &n);
        resistor(m, p, inner, about(m, 10, 2));
        l[i] = winding(m, inner, n, about(m, 1e-3, 2));
        for (int j = 0; j < i; j++)
            couple(m, l[j], l[i], k);
    }
}

const family families_random[] = {{"random-small", random_small},
                                  {"random-large", random_large},
                                  {"random-wide", random_wide},
                                  {"random-feedback", random_feedback},
                                  {"random-ideal", random_ideal},
                                  {"capacitor-loops", capacitor_loops},
                                  {"inductor-cutsets", inductor_cutsets},
                                  {"coupled", coupled},
                                  {NULL, NULL}};
