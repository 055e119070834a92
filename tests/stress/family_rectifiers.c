/* tests/stress/family_rectifiers.c - rectifiers at 50 to 400 Hz. */
#include <math.h>

#include "maker.h"

typedef struct point {
    double V, R; /* amplitude, load */
    double f;    /* Hz */
    double Ls;   /* of a line */
} point;

static point begin(maker *m, double periods) {
    const double f = chance(m, 0.7) ? 50 : draw(m, 16, 1000);
    maker_times(m, f, periods * draw_even(m, 0.7, 1.3));
    point w = {.V = draw(m, 5, 600), .R = draw(m, 2, 500), .f = f};
    w.Ls = w.R * m->T * draw(m, 1e-4, 0.03);
    m->coss = 0;
    return w;
}

static void line(maker *m, const point *w, const char *p, const char *n, double phase) {
    const char *inner = node(m, "l");
    sine(m, inner, n, w->V, w->f, phase);
    if (chance(m, 0.2)) {
        const char *more = node(m, "l");
        resistor(m, inner, more, w->R * draw(m, 1e-3, 0.05));
        inner = more;
    }
    inductor(m, inner, p, w->Ls, 0);
}

static void smoothing(maker *m, const point *w, const char *p, const char *n) {
    const int kind = draw_one(m, 3);
    if (kind == 0) {
        capacitor(m, p, n, m->T / w->R * draw(m, 0.1, 5), 0);
        load(m, p, n, w->R);
    } else if (kind == 1) {
        const char *mid = node(m, "y");
        inductor(m, p, mid, w->R * m->T * draw(m, 0.03, 3), 0);
        load(m, mid, n, w->R);
    } else {
        const char *mid = node(m, "y");
        inductor(m, p, mid, w->R * m->T * draw(m, 0.01, 0.5), 0);
        capacitor(m, mid, n, m->T / w->R * draw(m, 0.05, 2), 0);
        load(m, mid, n, w->R);
    }
}

static void half_wave(maker *m) {
    const point w = begin(m, 10);
    line(m, &w, "a", "0", 0);
    diode(m, "a", "p");
    if (chance(m, 0.5))
        diode(m, "0", "p");
    smoothing(m, &w, "p", "0");
}

static void bridge(maker *m) {
    const point w = begin(m, 10);
    const char *n = chance(m, 0.5) ? "0" : "n"; /* which side is ground */
    line(m, &w, "a", n[0] == '0' ? "b" : "0", draw_one(m, 2) * 90);
    const char *b = n[0] == '0' ? "b" : "0";
    diode(m, "a", "p");
    diode(m, b, "p");
    diode(m, n, "a");
    diode(m, n, b);
    smoothing(m, &w, "p", n);
}

static void centre_tap(maker *m) {
    const point w = begin(m, 10);
    const double L = w.R * m->T * 30;
    sine(m, "v", "0", w.V, w.f, 0);
    resistor(m, "v", "pr", w.R * 0.01);
    const char *one = winding(m, "pr", "0", L), *two = winding(m, "s1", "t", L),
               *three = winding(m, "t", "s2", L);
    const double k = chance(m, 0.5) ? 1 : draw_even(m, 0.98, 0.9999);
    couple(m, one, two, k);
    couple(m, one, three, k);
    couple(m, two, three, k);
    diode(m, "s1", "p");
    diode(m, "s2", "p");
    smoothing(m, &w, "p", "t");
    bleeder(m, "t", "0");
}

static void doubler(maker *m) {
    const point w = begin(m, 12);
    line(m, &w, "a", "0", 0);
    if (chance(m, 0.5)) { /* Delon */
        diode(m, "a", "p");
        diode(m, "n", "a");
        capacitor(m, "p", "0", m->T / w.R * draw(m, 0.3, 5), 0);
        capacitor(m, "0", "n", m->T / w.R * draw(m, 0.3, 5), 0);
        load(m, "p", "n", w.R);
    } else { /* Greinacher */
        capacitor(m, "a", "b", m->T / w.R * draw(m, 0.3, 5), 0);
        diode(m, "0", "b");
        diode(m, "b", "p");
        capacitor(m, "p", "0", m->T / w.R * draw(m, 0.3, 5), 0);
        load(m, "p", "0", w.R);
    }
}

static void three_lines(maker *m, const point *w, const char *stem, double turn) {
    for (int i = 0; i < 3; i++)
        line(m, w, indexed(stem, i), "0", turn - 120 * i);
}

static void three_pulse(maker *m) {
    const point w = begin(m, 6);
    three_lines(m, &w, "a", 0);
    for (int i = 0; i < 3; i++)
        diode(m, indexed("a", i), "p");
    smoothing(m, &w, "p", "0");
}

static void six_pulse_at(maker *m, const char *stem, const char *p, const char *n) {
    for (int i = 0; i < 3; i++) {
        diode(m, indexed(stem, i), p);
        diode(m, n, indexed(stem, i));
    }
}

static void six_pulse(maker *m) {
    const point w = begin(m, 5);
    three_lines(m, &w, "a", 0);
    six_pulse_at(m, "a", "p", "n");
    smoothing(m, &w, "p", "n");
    bleeder(m, "n", "0");
}

static void twelve_pulse(maker *m) {
    const point w = begin(m, 4);
    three_lines(m, &w, "a", 0);
    three_lines(m, &w, "b", 30);
    six_pulse_at(m, "a", "pa", "n");
    six_pulse_at(m, "b", "pb", chance(m, 0.5) ? "n" : "pa"); /* side by side, or in series */
    inductor(m, "pa", "p", w.Ls * 3, 0);
    inductor(m, "pb", "p", w.Ls * 3, 0);
    smoothing(m, &w, "p", "n");
    bleeder(m, "n", "0");
}

static void eighteen_pulse(maker *m) {
    const point w = begin(m, 2);
    for (int b = 0; b < 3; b++) {
        three_lines(m, &w, indexed("b", b), 20.0 * b - 20);
        six_pulse_at(m, indexed("b", b), indexed("p", b), "n");
        inductor(m, indexed("p", b), "p", w.Ls * 3, 0);
    }
    smoothing(m, &w, "p", "n");
    bleeder(m, "n", "0");
}

/* A thyristor: a diode and a switch that its own current holds closed, a gate that closes it. */
static void thyristor(maker *m, const char *a, const char *k, double fire, double w) {
    const char *in = node(m, "t"), *mid = node(m, "t"), *g = node(m, "tg"), *c = node(m, "tc"),
               *s = node(m, "tc"), *model = node(m, "mt"), *meter = node(m, "Vt");
    fire -= floor(fire);
    netlist_put(m->n, "V%d %s 0 PULSE(0 1 %.7g 1u 1u %.5g %.5g)", ++m->ids, g, fire * m->T, w * m->T, m->T);
    netlist_put(m->n, "%s %s %s 0", meter, a, in);
    netlist_put(m->n, "AD%d %s %s md", ++m->ids, in, mid);
    netlist_put(m->n, "H%d %s 0 %s 1", ++m->ids, s, meter);
    netlist_put(m->n, "E%d %s %s %s 0 10", ++m->ids, c, s, g);
    netlist_put(m->n, "AS%d %s %s %s 0 %s", ++m->ids, mid, k, c, model);
    netlist_put(m->n, ".model %s ideal_switch(vt=0.02 vh=0.01%s)", model, chance(m, 0.5) ? " ron=1m" : "");
    if (chance(m, 0.4)) {
        const char *inner = node(m, "s");
        resistor(m, a, inner, draw(m, 10, 200));
        plain_c(m, inner, k, draw(m, 1e-9, 1e-7), 0);
    }
}

static void two_pulse_controlled(maker *m) {
    const point w = begin(m, 6);
    const double fire = draw_even(m, 0.02, 0.4);
    line(m, &w, "a", "b", 0);
    bleeder(m, "b", "0");
    thyristor(m, "a", "p", fire, 0.05);
    thyristor(m, "b", "p", fire + 0.5, 0.05);
    diode(m, "0", "a");
    diode(m, "0", "b");
    inductor(m, "p", "o", w.R * m->T * draw(m, 0.1, 3), 0);
    resistor(m, "o", "0", w.R);
}

static void six_pulse_controlled(maker *m) {
    const point w = begin(m, 4);
    const double angle = draw_even(m, 0.01, 0.25);
    three_lines(m, &w, "a", 0);
    for (int i = 0; i < 3; i++) {
        thyristor(m, indexed("a", i), "p", (60 + 120 * i) / 360.0 + angle - 0.08, 0.2);
        thyristor(m, "n", indexed("a", i), (240 + 120 * i) / 360.0 + angle - 0.08, 0.2);
    }
    inductor(m, "p", "o", w.R * m->T * draw(m, 0.1, 3), 0);
    resistor(m, "o", "n", w.R);
    bleeder(m, "n", "0");
}

static void ac_controller(maker *m) {
    const point w = begin(m, 8);
    const double fire = draw_even(m, 0.05, 0.4);
    line(m, &w, "a", "0", 0);
    thyristor(m, "a", "b", fire, 0.03);
    thyristor(m, "b", "a", fire + 0.5, 0.03);
    resistor(m, "b", "c", w.R);
    inductor(m, "c", "0", w.R * m->T * draw(m, 0.003, 0.1), 0);
}

/* Three-level, three-phase, switches in diode bridges; carriers compared or fixed duty cycles. */
static void vienna(maker *m) {
    point w = begin(m, 1);
    w.Ls = w.R * m->T * draw(m, 3e-3, 0.02);
    const double fs = w.f * (20 + draw_one(m, 60)), T = m->T;
    m->T = 1 / fs;
    m->gate_tau = m->T * draw(m, 1e-3, 0.01);
    three_lines(m, &w, "x", 0);
    for (int i = 0; i < 3; i++) {
        const char *x = indexed("x", i), *y = indexed("y", i), *z = indexed("z", i), *g = indexed("g", i);
        diode(m, x, "p");
        diode(m, "n", x);
        diode(m, x, y);
        diode(m, z, x);
        diode(m, "m", y);
        diode(m, z, "m");
        gate(m, g, i / 3.0, draw_even(m, 0.2, 0.7));
        contact(m, y, z, g, "0");
    }
    capacitor(m, "p", "m", T / w.R * draw(m, 0.2, 2), w.V);
    capacitor(m, "m", "n", T / w.R * draw(m, 0.2, 2), w.V);
    resistor(m, "p", "n", w.R * 3);
    bleeder(m, "m", "0");
}

static void boost_pfc(maker *m) {
    const point w = begin(m, 1);
    const double T = m->T;
    m->T = T / (20 + draw_one(m, 80));
    line(m, &w, "a", "b", 0);
    diode(m, "a", "r");
    diode(m, "b", "r");
    diode(m, "0", "a");
    diode(m, "0", "b");
    plain_c(m, "r", "0", m->T / w.R * 0.3, 0);
    gate(m, "g", 0, draw_even(m, 0.2, 0.6));
    inductor(m, "r", "x", fit_l(m, w.V, w.V / w.R), 0);
    mosfet(m, "x", "0", "g");
    diode(m, "x", "out");
    capacitor(m, "out", "0", T / w.R * draw(m, 0.2, 2), w.V);
    load(m, "out", "0", 2 * w.R);
}

static void synchronous_rectifier(maker *m) {
    const point w = begin(m, 8);
    m->gate_rc = 0;
    sine(m, "s", "b", w.V, w.f, 0);
    inductor(m, "s", "a", w.Ls, 0);
    gate_compare(m, "g1", "s", "b", w.V * 0.05, w.V * 0.03);
    gate_compare(m, "g2", "b", "s", w.V * 0.05, w.V * 0.03);
    mosfet(m, "p", "a", "g1");
    mosfet(m, "b", "0", "g1");
    mosfet(m, "p", "b", "g2");
    mosfet(m, "a", "0", "g2");
    resistor(m, "p", "q", w.R * 0.05);
    capacitor(m, "q", "0", m->T / w.R * draw(m, 0.1, 1), 0);
    load(m, "q", "0", w.R);
}

const family families_rectifiers[] = {{"half-wave", half_wave},
                                      {"bridge", bridge},
                                      {"centre-tap", centre_tap},
                                      {"doubler", doubler},
                                      {"three-pulse", three_pulse},
                                      {"six-pulse", six_pulse},
                                      {"twelve-pulse", twelve_pulse},
                                      {"eighteen-pulse", eighteen_pulse},
                                      {"two-pulse-thyristor", two_pulse_controlled},
                                      {"six-pulse-thyristor", six_pulse_controlled},
                                      {"ac-controller", ac_controller},
                                      {"vienna", vienna},
                                      {"boost-pfc", boost_pfc},
                                      {"synchronous-rectifier", synchronous_rectifier},
                                      {NULL, NULL}};
