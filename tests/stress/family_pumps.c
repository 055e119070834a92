/* tests/stress/family_pumps.c - capacitors that are switched and clamped; oscillators. */
#include <math.h>

#include "maker.h"

static void clocks(maker *m, double volts) {
    const double edge = m->T * draw(m, 1e-4, 0.02), overlap = chance(m, 0.5) ? 0 : draw(m, 1e-3, 0.05);
    const double R = chance(m, 0.5) ? 0 : draw(m, 0.1, 100);
    static const char *const names[2] = {"ca", "cb"};
    for (int i = 0; i < 2; i++) {
        const char *inner = R > 0 ? node(m, "c") : names[i];
        netlist_put(m->n, "V%d %s 0 PULSE(%g %g %.6g %.4g %.4g %.6g %.6g)", ++m->ids, inner, i ? volts : 0,
                    i ? 0 : volts, i ? overlap * m->T : 0, edge, edge, 0.5 * m->T - edge, m->T);
        if (R > 0)
            resistor(m, inner, names[i], R);
    }
}

static void dickson(maker *m) {
    const int stages = 2 + draw_one(m, 7);
    maker_times(m, draw(m, 1e4, 1e7), draw_even(m, 30, 120));
    const double V = draw(m, 1.5, 20), C = draw(m, 1e-12, 1e-7);
    netlist_put(m->n, "Vdd %s 0 %.4g", indexed("n", 0), V);
    clocks(m, V);
    for (int i = 0; i < stages; i++) {
        diode(m, indexed("n", i), indexed("n", i + 1));
        capacitor(m, i % 2 ? "cb" : "ca", indexed("n", i + 1), C, 0);
    }
    diode(m, indexed("n", stages), "o");
    capacitor(m, "o", "0", C * draw(m, 1, 30), 0);
    resistor(m, "o", "0", m->T / C * draw(m, 5, 500));
}

static void cockcroft_walton(maker *m) {
    const int stages = 2 + draw_one(m, 6);
    maker_times(m, draw(m, 50, 1e5), draw_even(m, 20, 80));
    const double C = draw(m, 1e-10, 1e-5), V = draw(m, 10, 10000);
    sine(m, "in", "0", V, 1 / m->T, 0);
    const char *top = indexed("a", 0);
    resistor(m, "in", top, m->T / C * draw(m, 1e-5, 1e-2));
    for (int i = 0; i < stages; i++) {
        const char *s = i == 0 ? "0" : indexed("s", i);
        capacitor(m, indexed("a", i), indexed("a", i + 1), C, 0);
        capacitor(m, s, indexed("s", i + 1), C, 0);
        diode(m, s, indexed("a", i + 1));
        diode(m, indexed("a", i + 1), indexed("s", i + 1));
    }
    resistor(m, indexed("s", stages), "0", m->T / C * draw(m, 10, 1000));
}

/* Switches join a flying capacitor to the supply, then to the output: doubler, inverter, halver. */
static void switched_capacitor(maker *m) {
    maker_times(m, draw(m, 1e4, 5e6), draw_even(m, 30, 100));
    const double V = draw(m, 1.5, 100), C = draw(m, 1e-9, 1e-5), dead = draw(m, 1e-3, 0.03);
    const int kind = draw_one(m, 3);
    supply(m, "in", "0", V);
    gate(m, "ga", 0, 0.5 - dead);
    gate(m, "gb", 0.5, 0.5 - dead);
    capacitor(m, "f1", "f2", C, 0);
    contact(m, "in", "f1", "ga", "0");
    contact(m, "f2", kind == 2 ? "o" : "0", "ga", "0");
    contact(m, "f1", kind == 1 ? "0" : "o", "gb", "0");
    contact(m, "f2", kind == 1 ? "o" : kind == 0 ? "in" : "0", "gb", "0");
    capacitor(m, "o", "0", C * draw(m, 1, 30), 0);
    load(m, "o", "0", m->T / C * draw(m, 1, 300));
}

static void series_parallel(maker *m) {
    const int cells = 2 + draw_one(m, 3);
    maker_times(m, draw(m, 1e4, 5e6), draw_even(m, 30, 80));
    const double V = draw(m, 1.5, 100), C = draw(m, 1e-9, 1e-5), dead = draw(m, 1e-3, 0.03);
    supply(m, "in", "0", V);
    gate(m, "ga", 0, 0.5 - dead);
    gate(m, "gb", 0.5, 0.5 - dead);
    for (int i = 0; i < cells; i++) {
        const char *p = indexed("p", i), *n = indexed("n", i);
        capacitor(m, p, n, C, 0);
        contact(m, "in", p, "ga", "0");
        contact(m, n, "0", "ga", "0");
        contact(m, n, i == 0 ? "in" : indexed("p", i - 1), "gb", "0");
    }
    contact(m, indexed("p", cells - 1), "o", "gb", "0");
    capacitor(m, "o", "0", C * draw(m, 1, 30), 0);
    load(m, "o", "0", m->T / C * draw(m, 3, 300));
}

static void wave(maker *m, const char *p, double volts) {
    if (chance(m, 0.5))
        sine(m, p, "0", volts, 1 / m->T, draw_one(m, 4) * 90);
    else
        netlist_put(m->n, "V%d %s 0 PULSE(%.4g %.4g 0 %.4g %.4g %.4g %.4g)", ++m->ids, p, -volts, volts,
                    0.02 * m->T, 0.02 * m->T, 0.4 * m->T, m->T);
}

static void clamp(maker *m) {
    maker_times(m, draw(m, 50, 1e6), draw_even(m, 10, 40));
    const double R = draw(m, 1, 1e5);
    wave(m, "in", draw(m, 1, 300));
    resistor(m, "in", "a", R * draw(m, 1e-4, 0.1));
    capacitor(m, "a", "b", m->T / R * draw(m, 0.3, 100), 0);
    if (chance(m, 0.5))
        netlist_put(m->n, "AD%d 0 b md", ++m->ids);
    else
        netlist_put(m->n, "AD%d b 0 md", ++m->ids);
    resistor(m, "b", "0", R);
}

static void peak_detector(maker *m) {
    maker_times(m, draw(m, 50, 1e6), draw_even(m, 10, 40));
    const double R = draw(m, 1, 1e6);
    wave(m, "in", draw(m, 0.1, 300));
    if (chance(m, 0.5))
        resistor(m, "in", "a", R * draw(m, 1e-5, 0.1));
    else
        inductor(m, "in", "a", R * m->T * draw(m, 1e-4, 0.1), 0);
    diode(m, "a", "p");
    capacitor(m, "p", "0", m->T / R * draw(m, 0.3, 300), 0);
    resistor(m, "p", "0", R);
    if (chance(m, 0.5)) {
        diode(m, "n", "a");
        capacitor(m, "n", "0", m->T / R * draw(m, 0.3, 300), 0);
        resistor(m, "n", "0", R);
    }
}

static void limiter(maker *m) {
    maker_times(m, draw(m, 50, 1e6), draw_even(m, 10, 40));
    const double V = draw(m, 1, 300), R = draw(m, 1, 1e5);
    wave(m, "in", V);
    resistor(m, "in", "a", R);
    inductor(m, "a", "b", R * m->T * draw(m, 1e-3, 0.3), 0);
    capacitor(m, "b", "0", m->T / R * draw(m, 1e-3, 0.3), 0);
    netlist_put(m->n, "V%d hi 0 %.4g", ++m->ids, V * draw_even(m, 0.1, 0.8));
    netlist_put(m->n, "V%d lo 0 %.4g", ++m->ids, -V * draw_even(m, 0.1, 0.8));
    resistor(m, "c", "b", R * 0.01);
    diode(m, "c", "hi");
    diode(m, "lo", "c");
}

/* A capacitor charged through a resistor and let go by a switch with hysteresis. */
static void relaxation(maker *m) {
    maker_times(m, draw(m, 50, 1e6), draw_even(m, 10, 60));
    const double R = draw(m, 10, 1e6), V = draw(m, 5, 100), vt = V * draw_even(m, 0.3, 0.6);
    netlist_put(m->n, "V%d in 0 %.4g", ++m->ids, V);
    resistor(m, "in", "a", R);
    plain_c(m, "a", "0", m->T / R, 0);
    if (chance(m, 0.5))
        resistor(m, "a", "b", R * draw(m, 1e-4, 0.1));
    else
        inductor(m, "a", "b", R * m->T * draw(m, 1e-6, 1e-3), 0);
    netlist_put(m->n, ".model mr ideal_switch(vt=%.4g vh=%.4g%s)", vt, vt * draw_even(m, 0.1, 0.8),
                chance(m, 0.5) ? " ron=1m" : "");
    netlist_put(m->n, "AS%d b 0 a 0 mr", ++m->ids);
    if (!chance(m, 0.5))
        netlist_put(m->n, "AD%d 0 b md", ++m->ids);
}

/* A capacitor through an inductor into another one, again and again: resonant transfer, loops of capacitors.
 */
static void resonant_transfer(maker *m) {
    maker_times(m, draw(m, 1e3, 1e6), draw_even(m, 10, 60));
    const double C = draw(m, 1e-9, 1e-4), L = pow(m->T * draw(m, 0.02, 0.15), 2) / C, V = draw(m, 5, 500);
    supply(m, "in", "0", V);
    gate(m, "ga", 0, 0.4);
    gate(m, "gb", 0.5, 0.4);
    resistor(m, "in", "i2", sqrt(L / C) * draw(m, 0.01, 0.3));
    contact(m, "i2", "a", "ga", "0");
    diode(m, "a", "b");
    inductor(m, "b", "c", L, 0);
    capacitor(m, "c", "0", C, 0);
    contact(m, "c", "d", "gb", "0");
    inductor(m, "d", "e", L, 0);
    diode(m, "e", "o");
    diode(m, "0", "d");
    diode(m, "0", "b");
    capacitor(m, "o", "0", C * draw(m, 1, 30), 0);
    load(m, "o", "0", m->T / C * draw(m, 0.5, 10));
}

static void voltage_multiplier_bridge(maker *m) {
    const int stages = 1 + draw_one(m, 4);
    maker_times(m, draw(m, 50, 1e5), draw_even(m, 15, 60));
    const double C = draw(m, 1e-10, 1e-5), V = draw(m, 10, 3000);
    sine(m, "xa", "0", V, 1 / m->T, 0);
    sine(m, "xb", "0", V, 1 / m->T, 180);
    resistor(m, "xa", indexed("a", 0), m->T / C * draw(m, 1e-5, 1e-2));
    resistor(m, "xb", indexed("b", 0), m->T / C * draw(m, 1e-5, 1e-2));
    for (int i = 0; i < stages; i++) {
        const char *s = i == 0 ? "0" : indexed("s", i);
        capacitor(m, s, indexed("s", i + 1), C, 0);
        capacitor(m, indexed("a", i), indexed("a", i + 1), C, 0);
        capacitor(m, indexed("b", i), indexed("b", i + 1), C, 0);
        diode(m, s, indexed("a", i + 1));
        diode(m, s, indexed("b", i + 1));
        diode(m, indexed("a", i + 1), indexed("s", i + 1));
        diode(m, indexed("b", i + 1), indexed("s", i + 1));
    }
    resistor(m, indexed("s", stages), "0", m->T / C * draw(m, 10, 1000));
}

const family families_pumps[] = {{"dickson", dickson},
                                 {"cockcroft-walton", cockcroft_walton},
                                 {"switched-capacitor", switched_capacitor},
                                 {"series-parallel", series_parallel},
                                 {"clamp", clamp},
                                 {"peak-detector", peak_detector},
                                 {"limiter", limiter},
                                 {"relaxation", relaxation},
                                 {"resonant-transfer", resonant_transfer},
                                 {"symmetric-multiplier", voltage_multiplier_bridge},
                                 {NULL, NULL}};
