/* tests/stress/family_inverters.c - inverters, modulated by a sine against a triangle. */
#include <math.h>

#include "maker.h"

typedef struct point {
    double V, I;  /* dc supply, amplitude of the current */
    double f, fs; /* of the sine and of the carrier, Hz */
    double depth; /* of modulation */
} point;

static point begin(maker *m, int ratio_most) {
    point w = {.V = draw(m, 20, 800),
               .I = draw(m, 0.5, 50),
               .f = draw(m, 20, 1000),
               .depth = draw_even(m, 0.3, 0.98)};
    const int ratio = 9 + draw_one(m, ratio_most - 9);
    w.fs = w.f * (chance(m, 0.5) ? ratio : ratio + draw_even(m, 0.1, 0.9));
    maker_times(m, w.fs, ratio * draw_even(m, 0.7, 1.3));
    return w;
}

/* A triangle from -1 to 1 V, which begins after a part of a period. */
static void carrier_at(maker *m, const char *name, double from) {
    netlist_put(m->n, "V%d %s 0 PULSE(-1 1 %.6g %.6g %.6g %.3g %.8g)", ++m->ids, name, from * m->T,
                0.4999 * m->T, 0.4999 * m->T, 1e-4 * m->T, m->T);
}

static void reference(maker *m, const char *name, const point *w, double phase) {
    netlist_put(m->n, "V%d %s 0 SIN(0 %.4g %.5g 0 0 %.4g)", ++m->ids, name, w->depth, w->f, phase);
}

/* Two gates of a leg: on while ref > tri, and while tri > ref, in one instant or with a dead time. */
static void leg_gates(maker *m, const char *up, const char *low, const char *ref, const char *tri) {
    const double vt = chance(m, 0.3) ? 0 : draw(m, 3e-3, 0.05), vh = chance(m, 0.5) ? 0 : draw(m, 1e-3, 0.03);
    gate_compare(m, up, ref, tri, vt, vh);
    gate_compare(m, low, tri, ref, vt, vh);
}

static void leg(maker *m, const char *p, const char *x, const char *n, int i, const char *ref,
                const char *tri) {
    const char *up = indexed("gu", i), *low = indexed("gl", i);
    leg_gates(m, up, low, ref, tri);
    mosfet(m, p, x, up);
    mosfet(m, x, n, low);
}

static void dc_link(maker *m, const point *w) {
    supply(m, "p", "n", w->V);
    if (chance(m, 0.5))
        resistor(m, "n", "0", draw(m, 1e-3, 1e6));
    else
        netlist_put(m->n, "V%d n 0 %.4g", ++m->ids, -w->V / 2);
}

static void lr(maker *m, const point *w, const char *x, const char *to) {
    const double R = w->V / (2 * w->I);
    const char *mid = node(m, "o");
    inductor(m, x, mid, R / (6.2832 * w->f) * draw(m, 0.05, 1), 0);
    resistor(m, mid, to, R);
}

static void lc(maker *m, const point *w, const char *x, const char *to) {
    const double R = w->V / (2 * w->I);
    const char *mid = node(m, "o");
    inductor(m, x, mid, R / (6.2832 * w->fs) * draw(m, 1, 5), 0);
    capacitor(m, mid, to, 1 / (6.2832 * w->fs * R) * draw(m, 1, 5), 0);
    load(m, mid, to, R);
}

static void half_bridge_inverter(maker *m) {
    const point w = begin(m, 50);
    netlist_put(m->n, "V%d p 0 %.4g", ++m->ids, w.V / 2);
    netlist_put(m->n, "V%d 0 n %.4g", ++m->ids, w.V / 2);
    reference(m, "ref", &w, 0);
    carrier_at(m, "tri", 0);
    leg(m, "p", "x", "n", 0, "ref", "tri");
    (chance(m, 0.5) ? lr : lc)(m, &w, "x", "0");
}

static void h_bridge(maker *m) {
    const point w = begin(m, 50);
    const int unipolar = chance(m, 0.5);
    dc_link(m, &w);
    reference(m, "ra", &w, 0);
    if (unipolar)
        reference(m, "rb", &w, 180);
    carrier_at(m, "tri", 0);
    leg(m, "p", "a", "n", 0, "ra", "tri");
    leg(m, "p", "b", "n", 1, unipolar ? "rb" : "tri", unipolar ? "tri" : "ra");
    (chance(m, 0.5) ? lr : lc)(m, &w, "a", "b");
}

/* Three lines to a star point that floats or has a bleeder. */
static void star(maker *m, const point *w) {
    for (int i = 0; i < 3; i++)
        lr(m, w, indexed("x", i), "st");
    if (chance(m, 0.7))
        resistor(m, "st", "0", draw(m, 1e3, 1e7));
}

static void three_references(maker *m, const point *w) {
    for (int i = 0; i < 3; i++)
        reference(m, indexed("r", i), w, -120 * i);
}

static void two_level(maker *m) {
    const point w = begin(m, 30);
    dc_link(m, &w);
    three_references(m, &w);
    carrier_at(m, "tri", 0);
    for (int i = 0; i < 3; i++)
        leg(m, "p", indexed("x", i), "n", i, indexed("r", i), "tri");
    star(m, &w);
}

/* Gates from square waves with dead times: the circuit's own state moves no switch. */
static void six_step(maker *m) {
    const point w = begin(m, 12);
    m->T = 1 / w.f;
    m->stop = 3 * m->T;
    dc_link(m, &w);
    const double dead = draw(m, 1e-3, 0.03), on = (chance(m, 0.5) ? 0.5 : 1.0 / 3) - dead;
    for (int i = 0; i < 3; i++) {
        const char *x = indexed("x", i), *up = indexed("gu", i), *low = indexed("gl", i);
        gate(m, up, i / 3.0, on);
        gate(m, low, i / 3.0 + 0.5, on);
        mosfet(m, "p", x, up);
        mosfet(m, x, "n", low);
    }
    star(m, &w);
}

/* Two carriers, one above the other: each is half as high. */
static void two_carriers(maker *m) {
    netlist_put(m->n, "V%d tu 0 PULSE(0 1 0 %.6g %.6g %.3g %.8g)", ++m->ids, 0.4999 * m->T, 0.4999 * m->T,
                1e-4 * m->T, m->T);
    netlist_put(m->n, "V%d tl 0 PULSE(-1 0 0 %.6g %.6g %.3g %.8g)", ++m->ids, 0.4999 * m->T, 0.4999 * m->T,
                1e-4 * m->T, m->T);
}

static void split_link(maker *m, const point *w) {
    if (chance(m, 0.5)) {
        netlist_put(m->n, "V%d p m %.4g", ++m->ids, w->V / 2);
        netlist_put(m->n, "V%d m n %.4g", ++m->ids, w->V / 2);
    } else {
        const double farads = w->I / w->f / w->V * draw(m, 1, 20);
        supply(m, "p", "n", w->V);
        capacitor(m, "p", "m", farads, w->V / 2);
        capacitor(m, "m", "n", farads, w->V / 2);
    }
    resistor(m, "m", "0", draw(m, 1e-3, 1e5));
}

static void npc_leg(maker *m, int i, const char *ref) {
    const char *x = indexed("x", i), *a = indexed("a", i), *b = indexed("b", i), *g[4];
    for (int k = 0; k < 4; k++)
        g[k] = indexed(indexed("g", k), i);
    leg_gates(m, g[0], g[2], ref, "tu");
    leg_gates(m, g[1], g[3], ref, "tl");
    mosfet(m, "p", a, g[0]);
    mosfet(m, a, x, g[1]);
    mosfet(m, x, b, g[2]);
    mosfet(m, b, "n", g[3]);
    diode(m, "m", a);
    diode(m, b, "m");
}

static void npc(maker *m) {
    const point w = begin(m, 40);
    split_link(m, &w);
    two_carriers(m);
    reference(m, "ref", &w, 0);
    npc_leg(m, 0, "ref");
    (chance(m, 0.5) ? lr : lc)(m, &w, indexed("x", 0), "0");
}

static void npc_three(maker *m) {
    const point w = begin(m, 16);
    split_link(m, &w);
    two_carriers(m);
    three_references(m, &w);
    for (int i = 0; i < 3; i++)
        npc_leg(m, i, indexed("r", i));
    star(m, &w);
}

static void t_type_leg(maker *m, int i, const char *ref) {
    const char *x = indexed("x", i), *y = indexed("y", i), *g[4];
    for (int k = 0; k < 4; k++)
        g[k] = indexed(indexed("g", k), i);
    leg_gates(m, g[0], g[2], ref, "tu");
    leg_gates(m, g[1], g[3], ref, "tl");
    mosfet(m, "p", x, g[0]);
    mosfet(m, x, "n", g[3]);
    mosfet(m, "m", y, g[1]); /* two back to back */
    mosfet(m, x, y, g[2]);
}

static void t_type(maker *m) {
    const point w = begin(m, 40);
    split_link(m, &w);
    two_carriers(m);
    reference(m, "ref", &w, 0);
    t_type_leg(m, 0, "ref");
    lr(m, &w, indexed("x", 0), "0");
}

static void t_type_three(maker *m) {
    const point w = begin(m, 16);
    split_link(m, &w);
    two_carriers(m);
    three_references(m, &w);
    for (int i = 0; i < 3; i++)
        t_type_leg(m, i, indexed("r", i));
    star(m, &w);
}

static void flying_capacitor(maker *m) {
    const point w = begin(m, 40);
    const int cells = 2 + draw_one(m, 3);
    netlist_put(m->n, "V%d %s 0 %.4g", ++m->ids, indexed("u", 0), w.V / 2);
    netlist_put(m->n, "V%d 0 %s %.4g", ++m->ids, indexed("l", 0), w.V / 2);
    reference(m, "ref", &w, 0);
    for (int i = 0; i < cells; i++) {
        const int last = i == cells - 1;
        const char *tri = indexed("t", i), *up = indexed("gu", i), *low = indexed("gl", i);
        carrier_at(m, tri, (double)i / cells);
        leg_gates(m, up, low, "ref", tri);
        mosfet(m, indexed("u", i), last ? "x" : indexed("u", i + 1), up);
        mosfet(m, last ? "x" : indexed("l", i + 1), indexed("l", i), low);
        if (!last)
            capacitor(m, indexed("u", i + 1), indexed("l", i + 1), w.I / (w.fs * w.V) * draw(m, 3, 30),
                      w.V * (cells - 1 - i) / cells);
    }
    lr(m, &w, "x", "0");
}

static void cascaded(maker *m) {
    const point w = begin(m, 24);
    const int cells = 2 + draw_one(m, 3);
    reference(m, "ra", &w, 0);
    reference(m, "rb", &w, 180);
    for (int i = 0; i < cells; i++) {
        const char *p = indexed("p", i), *n = indexed("n", i), *tri = indexed("t", i);
        netlist_put(m->n, "V%d %s %s %.4g", ++m->ids, p, n, w.V / cells);
        carrier_at(m, tri, 0.5 * i / cells);
        leg(m, p, i == 0 ? "out" : indexed("y", i), n, 2 * i, "ra", tri);
        leg(m, p, i == cells - 1 ? "0" : indexed("y", i + 1), n, 2 * i + 1, "rb", tri);
    }
    lr(m, &w, "out", "0");
}

/* A leg of a modular multilevel converter. */
static void mmc(maker *m) {
    const point w = begin(m, 16);
    const int cells = 2 + draw_one(m, 4);
    netlist_put(m->n, "V%d %s 0 %.4g", ++m->ids, indexed("u", 0), w.V / 2);
    netlist_put(m->n, "V%d 0 %s %.4g", ++m->ids, indexed("u", 2 * cells + 1), w.V / 2);
    reference(m, "ra", &w, 180);
    reference(m, "rb", &w, 0);
    for (int i = 0; i < 2 * cells; i++) {
        const int lower = i >= cells;
        const char *top = indexed("u", i + lower), *bottom = indexed("u", i + lower + 1),
                   *c = indexed("c", i), *tri = indexed("t", i), *up = indexed("gu", i),
                   *low = indexed("gl", i);
        carrier_at(m, tri, (double)(i % cells) / cells);
        leg_gates(m, up, low, lower ? "rb" : "ra", tri);
        mosfet(m, c, top, up);
        mosfet(m, top, bottom, low);
        capacitor(m, c, bottom, w.I / (w.f * w.V) * cells * draw(m, 0.3, 3), w.V / cells);
    }
    const double R = w.V / (2 * w.I);
    inductor(m, indexed("u", cells), "x", R / (6.2832 * w.f) * draw(m, 0.03, 0.3), 0);
    inductor(m, "x", indexed("u", cells + 1), R / (6.2832 * w.f) * draw(m, 0.03, 0.3), 0);
    lr(m, &w, "x", "0");
}

/* Three lines to one output by three switches that conduct both ways. */
static void matrix_row(maker *m) {
    const point w = begin(m, 40);
    m->gate_rc = 0;
    for (int i = 0; i < 3; i++) {
        const char *a = indexed("a", i), *y = indexed("y", i), *g = indexed("g", i);
        sine(m, a, "0", w.V, w.f, -120 * i);
        gate(m, g, i / 3.0, 1.0 / 3 - 0.01);
        if (chance(m, 0.5)) {
            contact(m, a, y, g, "0");
            resistor(m, y, "x", 1e-3 * w.V / w.I);
        } else {
            mosfet(m, a, y, g);
            mosfet(m, "x", y, g);
        }
    }
    resistor(m, "x", "sn", w.V / w.I);
    plain_c(m, "sn", "0", m->T * w.I / w.V * 0.03, 0);
    lr(m, &w, "x", "0");
}

static void rectifier_inverter(maker *m) {
    const point w = begin(m, 14);
    for (int i = 0; i < 3; i++) {
        sine(m, indexed("s", i), "0", w.V / 1.7, w.f, -120 * i + 10);
        inductor(m, indexed("s", i), indexed("a", i), w.V / w.I / (6.2832 * w.f) * draw(m, 0.003, 0.05), 0);
        diode(m, indexed("a", i), "p");
        diode(m, "n", indexed("a", i));
    }
    capacitor(m, "p", "n", w.I / (w.f * w.V) * draw(m, 0.3, 5), w.V);
    three_references(m, &w);
    carrier_at(m, "tri", 0);
    for (int i = 0; i < 3; i++)
        leg(m, "p", indexed("x", i), "n", i, indexed("r", i), "tri");
    star(m, &w);
}

/* A current source into switches that only conduct one way, capacitors at the load. */
static void current_source_inverter(maker *m) {
    const point w = begin(m, 12);
    m->T = 1 / w.f;
    m->stop = 4 * m->T;
    supply(m, "v", "n", w.V);
    resistor(m, "n", "0", draw(m, 1, 1e5));
    inductor(m, "v", "p", w.V / w.I / w.f * draw(m, 0.3, 2), w.I);
    for (int i = 0; i < 3; i++) {
        const char *x = indexed("x", i), *up = indexed("gu", i), *low = indexed("gl", i);
        gate(m, up, i / 3.0, 1.0 / 3 + 0.01);
        gate(m, low, i / 3.0 + 0.5, 1.0 / 3 + 0.01);
        igbt(m, "p", x, up);
        igbt(m, x, "n", low);
        capacitor(m, x, "st", w.I / w.V / w.f * draw(m, 0.03, 0.3), 0);
        resistor(m, x, "st", w.V / w.I);
    }
    bleeder(m, "st", "0");
}

const family families_inverters[] = {{"half-bridge-inverter", half_bridge_inverter},
                                     {"h-bridge", h_bridge},
                                     {"two-level", two_level},
                                     {"six-step", six_step},
                                     {"npc", npc},
                                     {"npc-three", npc_three},
                                     {"t-type", t_type},
                                     {"t-type-three", t_type_three},
                                     {"flying-capacitor", flying_capacitor},
                                     {"cascaded", cascaded},
                                     {"mmc", mmc},
                                     {"matrix-row", matrix_row},
                                     {"rectifier-inverter", rectifier_inverter},
                                     {"csi", current_source_inverter},
                                     {NULL, NULL}};
