/* tests/stress/family_ties.c - events in one instant, edges at commutations, pulses shorter than any step,
 * slow beside fast. */
#include <math.h>

#include "maker.h"

/* Several legs by one gate, all values alike. */
static void alike(maker *m) {
    const int legs = 2 + draw_one(m, 4);
    maker_times(m, draw(m, 1e4, 1e6), draw_even(m, 10, 40));
    const double V = draw(m, 5, 400), I = draw(m, 0.3, 10), L = fit_l(m, V, I);
    m->parasites = m->snubbers = 0;
    netlist_put(m->n, "V%d in 0 %.4g", ++m->ids, V);
    gate(m, "g", 0, draw_even(m, 0.2, 0.7));
    for (int i = 0; i < legs; i++) {
        const char *x = indexed("x", i);
        contact(m, "in", x, "g", "0");
        netlist_put(m->n, "AD%d 0 %s md", ++m->ids, x);
        netlist_put(m->n, "L%d %s out %.4g ic=0", ++m->ids, x, L);
    }
    plain_c(m, "out", "0", fit_c(m, V, I * legs), 0);
    resistor(m, "out", "0", V / I / legs / 2);
}

/* Two legs whose gates are each other's mirror, without dead time: one opens when the other closes. */
static void complementary(maker *m) {
    maker_times(m, draw(m, 1e4, 1e6), draw_even(m, 10, 60));
    const double V = draw(m, 5, 400), I = draw(m, 0.3, 10), D = chance(m, 0.5) ? 0.5 : draw_even(m, 0.2, 0.8);
    m->edge = chance(m, 0.5) ? 1e-9 : m->T * 0.01;
    supply(m, "in", "0", V);
    m->gate_rc = 0;
    for (int i = 0; i < 2; i++) /* of the same corners */
        netlist_put(m->n, "V%d g%c 0 PULSE(%d %d 0 %.4g %.4g %.9g %.9g)", ++m->ids, 'a' + i, i, 1 - i,
                    m->edge, m->edge, D * m->T - m->edge, m->T);
    mosfet(m, "in", "x", "ga");
    mosfet(m, "x", "0", "gb");
    inductor(m, "x", "out", fit_l(m, V, I), 0);
    capacitor(m, "out", "0", fit_c(m, V, I), 0);
    load(m, "out", "0", D * V / I);
}

/* A gate: the source's own node, or one that a closed switch leads to it, with a bleeder: then its threshold
 * is met by the state. */
static const char *behind_a_switch(maker *m, const char *from, const char *name, int is_behind) {
    if (!is_behind)
        return from;
    contact(m, from, name, "en", "0");
    resistor(m, name, "0", draw(m, 100, 1e5));
    return name;
}

/* V volts behind a resistor, at a capacitor that these do not recharge at once; for I amperes. */
static void capacitor_bus(maker *m, double V, double I) {
    resistor(m, "src", "in", V / I * draw(m, 0.1, 1));
    netlist_put(m->n, "V%d src 0 %.4g", ++m->ids, V);
    plain_c(m, "in", "0", m->T * I / V * draw(m, 1, 30), V);
}

/* The same legs at a capacitor that nothing recharges at once: were both switches of a leg closed for a
 * rounding of time, it would be empty. */
static void joined_gates(maker *m) {
    const int legs = 1 + draw_one(m, 3);
    maker_times(m, draw(m, 1e4, 1e6), draw_even(m, 10, 60));
    const double V = draw(m, 5, 400), I = draw(m, 0.3, 10), edge = chance(m, 0.5) ? 1e-9 : m->T * 0.01;
    m->gate_rc = 0;
    netlist_put(m->n, "V%d en 0 PULSE(0 1 %.4g 1n 1n 1 10)", ++m->ids, -1e-6);
    capacitor_bus(m, V, I);
    for (int i = 0; i < legs; i++) {
        const char *h = indexed("h", i), *k = indexed("k", i), *x = indexed("x", i), *y = indexed("y", i);
        const double D = draw_even(m, 0.2, 0.8), t = i ? draw_even(m, 0, 1) * m->T : 0;
        const int which = 1 + draw_one(m, 3);
        netlist_put(m->n, "V%d %s 0 PULSE(0 1 %.17g %.17g %.17g %.17g %.17g)", ++m->ids, h, t, edge, edge,
                    D * m->T - edge, m->T);
        netlist_put(m->n, "V%d %s 0 PULSE(0 1 %.17g %.17g %.17g %.17g %.17g)", ++m->ids, k, t + D * m->T,
                    edge, edge, (1 - D) * m->T - edge, m->T);
        mosfet(m, "in", x, behind_a_switch(m, h, indexed("g", i), which & 1));
        mosfet(m, x, "0", behind_a_switch(m, k, indexed("f", i), which & 2));
        inductor(m, x, y, fit_l(m, V, I), 0);
        resistor(m, y, "0", V / I);
    }
}

/* A gate that is the inverse of `from`: a closed switch pulls it down.  Three times, or once. */
static const char *inverse_of(maker *m, const char *from, const char *name) {
    const int stages = chance(m, 0.5) ? 1 : 3;
    for (int i = 0; i < stages; i++) {
        const char *gate = indexed(name, i);
        contact(m, gate, "0", from, "0");
        resistor(m, "one", gate, draw(m, 10, 1e5));
        from = gate;
    }
    return from;
}

/* Legs as these, whose second gate follows from the first one without delay. */
static void inverted_gates(maker *m) {
    const int legs = 1 + draw_one(m, 3);
    maker_times(m, draw(m, 1e4, 1e6), draw_even(m, 10, 60));
    const double V = draw(m, 5, 400), I = draw(m, 0.3, 10), edge = chance(m, 0.5) ? 1e-9 : m->T * 0.01;
    m->gate_rc = 0;
    netlist_put(m->n, "V%d one 0 1", ++m->ids);
    capacitor_bus(m, V, I);
    for (int i = 0; i < legs; i++) {
        const char *h = indexed("h", i), *x = indexed("x", i), *y = indexed("y", i);
        netlist_put(m->n, "V%d %s 0 PULSE(0 1 %.17g %.17g %.17g %.17g %.17g)", ++m->ids, h,
                    draw_even(m, 0, 1) * m->T, edge, edge, draw_even(m, 0.2, 0.8) * m->T - edge, m->T);
        const char *k = inverse_of(m, h, indexed("k", i));
        const int swapped = chance(m, 0.5);
        mosfet(m, "in", x, swapped ? k : h);
        mosfet(m, x, "0", swapped ? h : k);
        inductor(m, x, y, fit_l(m, V, I), 0);
        resistor(m, y, "0", V / I);
    }
}

/* A resonant half wave ends exactly when the gate falls: pi sqrt(LC) is the pulse's width. */
static void edge_at_commutation(maker *m) {
    maker_times(m, draw(m, 1e4, 1e6), draw_even(m, 10, 40));
    const double V = draw(m, 5, 400), C = draw(m, 1e-9, 1e-5), width = draw_even(m, 0.1, 0.4) * m->T;
    const double off = chance(m, 0.5) ? 0 : chance(m, 0.5) ? 1e-9 : -1e-6; /* or nearly then */
    const double L = pow(width * (1 + off) / 3.14159265358979, 2) / C;
    m->edge = m->T * 1e-6;
    m->ron_s = m->ron_d = m->roff_s = m->roff_d = m->vf = 0;
    netlist_put(m->n, "V%d in 0 %.4g", ++m->ids, V);
    netlist_put(m->n, "V%d g 0 PULSE(0 1 0 %.6g %.6g %.12g %.9g)", ++m->ids, 1e-6 * m->T, 1e-6 * m->T,
                width - 1e-6 * m->T, m->T);
    m->gate_rc = 0;
    contact(m, "in", "a", "g", "0");
    netlist_put(m->n, "AD1 a b md");
    netlist_put(m->n, "L1 b c %.17g ic=0", L);
    netlist_put(m->n, "C1 c 0 %.4g ic=0", C);
    resistor(m, "c", "0", m->T / C * draw(m, 0.2, 5));
    netlist_put(m->n, "AD2 0 a md");
}

/* Sources with corners where the diodes commutate. */
static void corners(maker *m) {
    const int legs = 2 + draw_one(m, 5);
    maker_times(m, draw(m, 50, 1e5), draw_even(m, 5, 20));
    const double V = draw(m, 5, 400), R = draw(m, 1, 1000);
    for (int i = 0; i < legs; i++) { /* trapezoids, one after the other */
        const char *v = indexed("v", i);
        netlist_put(m->n, "V%d %s 0 PULSE(%.4g %.4g %.9g %.9g %.9g %.9g %.9g)", ++m->ids, v, -V, V,
                    m->T * i / (2.0 * legs), 0.25 * m->T, 0.25 * m->T, 0.25 * m->T, m->T);
        if (chance(m, 0.5)) {
            const char *a = indexed("a", i);
            inductor(m, v, a, R * m->T * draw(m, 1e-3, 0.05), 0);
            v = a;
        }
        diode(m, v, "p");
        diode(m, "n", v);
    }
    resistor(m, "p", "n", R);
    if (chance(m, 0.5))
        capacitor(m, "p", "n", m->T / R * draw(m, 0.03, 1), 0);
    bleeder(m, "n", "0");
}

/* Pulses of picoseconds to nanoseconds once a period of milliseconds. */
static void short_pulses(maker *m) {
    maker_times(m, draw(m, 10, 1000), draw_even(m, 4, 12));
    const double width = draw(m, 1e-12, 1e-7), V = draw(m, 5, 400), L = width * V / draw(m, 0.1, 10);
    netlist_put(m->n, "V%d in 0 %.4g", ++m->ids, V);
    netlist_put(m->n, "V%d g 0 PULSE(0 1 %.6g %.4g %.4g %.4g %.6g)", ++m->ids, m->T * draw_even(m, 0, 0.9),
                width / 100, width / 100, width, m->T);
    m->gate_rc = 0;
    inductor(m, "in", "x", L, 0);
    contact(m, "x", "0", "g", "0");
    diode(m, "x", "out");
    plain_c(m, "out", "0", draw(m, 1e-9, 1e-6), V);
    resistor(m, "out", "0", draw(m, 1e4, 1e7));
    if (chance(m, 0.5)) { /* and a comparator that sees the pulse's filtered copy */
        resistor(m, "g", "gf", 1000);
        plain_c(m, "gf", "0", width / 1000 * draw(m, 0.2, 3), 0);
        netlist_put(m->n, ".model mf ideal_switch(vt=0.3 vh=0.1)");
        netlist_put(m->n, "AS%d out y gf 0 mf", ++m->ids);
        resistor(m, "y", "0", draw(m, 10, 1e4));
    }
}

/* 1 Hz beside 1 MHz: a few periods of the slow one cost a million; only a part of it is run. */
static void slow_beside_fast(maker *m) {
    maker_times(m, draw(m, 3e5, 3e6), draw_even(m, 50, 400));
    const double V = draw(m, 5, 400), I = draw(m, 0.3, 10);
    netlist_put(m->n, "V%d in s %.4g", ++m->ids, V);
    netlist_put(m->n, "V%d s 0 SIN(0 %.4g 1 0 0 %d)", ++m->ids, V * 0.3, 90 * draw_one(m, 4));
    gate(m, "g", 0, draw_even(m, 0.2, 0.7));
    contact(m, "in", "x", "g", "0");
    diode(m, "0", "x");
    inductor(m, "x", "out", fit_l(m, V, I), 0);
    capacitor(m, "out", "0", fit_c(m, V, I), V / 2);
    resistor(m, "out", "0", V / I);
    resistor(m, "out", "sl", draw(m, 1e5, 1e7)); /* a filter of a second */
    plain_c(m, "sl", "0", draw(m, 1e-8, 1e-5), V / 2);
    diode(m, "sl", "pk");
    plain_c(m, "pk", "0", 1e-6, 0);
}

/* Gates of two frequencies whose edges meet now and then. */
static void beats(maker *m) {
    maker_times(m, draw(m, 1e4, 1e6), 60);
    const double V = draw(m, 5, 400), I = draw(m, 0.3, 10);
    const int p = 2 + draw_one(m, 5), q = p + 1 + draw_one(m, 4);
    supply(m, "in", "0", V);
    gate_at(m, "ga", 0, 0.5, m->T);
    gate_at(m, "gb", 0, 0.5, m->T * p / q);
    contact(m, "in", "x", "ga", "0");
    contact(m, "in", "y", "gb", "0");
    diode(m, "0", "x");
    diode(m, "0", "y");
    inductor(m, "x", "out", fit_l(m, V, I), 0);
    inductor(m, "y", "out", fit_l(m, V, I), 0);
    capacitor(m, "out", "0", fit_c(m, V, I), 0);
    load(m, "out", "0", V / I / 2);
}

const family families_ties[] = {{"alike", alike},
                                {"complementary", complementary},
                                {"joined-gates", joined_gates},
                                {"inverted-gates", inverted_gates},
                                {"edge-at-commutation", edge_at_commutation},
                                {"corners", corners},
                                {"short-pulses", short_pulses},
                                {"slow-beside-fast", slow_beside_fast},
                                {"beats", beats},
                                {NULL, NULL}};
