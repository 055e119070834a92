/* tests/stress/family_dcdc.c - converters without a transformer. */
#include <math.h>

#include "maker.h"

typedef struct point {
    double V, D, I; /* supply, duty cycle, load current */
} point;

/* A working point and its times. */
static point begin(maker *m) {
    maker_times(m, draw(m, 2e4, 2e6), draw_even(m, 15, 90));
    return (point){draw(m, 3, 600), draw_even(m, 0.15, 0.8), draw(m, 0.1, 30)};
}

static void output(maker *m, const char *out, double volts, double amperes) {
    capacitor(m, out, "0", fit_c(m, volts, amperes), chance(m, 0.5) ? 0 : volts * draw_even(m, 0.5, 1.1));
    load(m, out, "0", fabs(volts) / amperes);
}

static void buck(maker *m) {
    const point w = begin(m);
    supply(m, "in", "0", w.V);
    gate(m, "g", 0, w.D);
    contact(m, "in", "x", "g", "0");
    diode(m, "0", "x");
    inductor(m, "x", "out", fit_l(m, w.V, w.I), 0);
    output(m, "out", w.D * w.V, w.I);
}

static void buck_sync(maker *m) {
    const point w = begin(m);
    const double dead = draw(m, 1e-3, 0.04);
    supply(m, "in", "0", w.V);
    gate(m, "gh", 0, w.D);
    gate(m, "gl", w.D + dead, 1 - w.D - 2 * dead);
    mosfet(m, "in", "x", "gh");
    mosfet(m, "x", "0", "gl");
    inductor(m, "x", "out", fit_l(m, w.V, w.I), 0);
    output(m, "out", w.D * w.V, w.I);
}

static void boost(maker *m) {
    const point w = begin(m);
    supply(m, "in", "0", w.V);
    gate(m, "g", 0, w.D);
    inductor(m, "in", "x", fit_l(m, w.V, w.I / (1 - w.D)), 0);
    mosfet(m, "x", "0", "g");
    diode(m, "x", "out");
    output(m, "out", w.V / (1 - w.D), w.I);
}

static void boost_sync(maker *m) {
    const point w = begin(m);
    const double dead = draw(m, 1e-3, 0.04);
    supply(m, "in", "0", w.V);
    gate(m, "gl", 0, w.D);
    gate(m, "gh", w.D + dead, 1 - w.D - 2 * dead);
    inductor(m, "in", "x", fit_l(m, w.V, w.I / (1 - w.D)), 0);
    mosfet(m, "x", "0", "gl");
    mosfet(m, "out", "x", "gh");
    output(m, "out", w.V / (1 - w.D), w.I);
}

static void buck_boost(maker *m) {
    const point w = begin(m);
    supply(m, "in", "0", w.V);
    gate(m, "g", 0, w.D);
    contact(m, "in", "x", "g", "0");
    inductor(m, "x", "0", fit_l(m, w.V, w.I / (1 - w.D)), 0);
    diode(m, "out", "x");
    output(m, "out", -w.V * w.D / (1 - w.D), w.I);
}

static void four_switch(maker *m) {
    const point w = begin(m);
    const double dead = draw(m, 1e-3, 0.03), other = draw_even(m, 0.2, 0.8);
    supply(m, "in", "0", w.V);
    gate(m, "ga", 0, w.D);
    gate(m, "gb", w.D + dead, 1 - w.D - 2 * dead);
    gate(m, "gc", 0, other);
    gate(m, "gd", other + dead, 1 - other - 2 * dead);
    mosfet(m, "in", "a", "ga");
    mosfet(m, "a", "0", "gb");
    inductor(m, "a", "b", fit_l(m, w.V, w.I / (1 - other)), 0);
    mosfet(m, "b", "0", "gc");
    mosfet(m, "out", "b", "gd");
    output(m, "out", w.V * w.D / (1 - other), w.I);
}

static void cuk(maker *m) {
    const point w = begin(m);
    const double out = w.V * w.D / (1 - w.D);
    supply(m, "in", "0", w.V);
    gate(m, "g", 0, w.D);
    inductor(m, "in", "x", fit_l(m, w.V, w.I), 0);
    mosfet(m, "x", "0", "g");
    capacitor(m, "x", "y", fit_c(m, w.V + out, w.I), 0);
    diode(m, "y", "0");
    inductor(m, "y", "out", fit_l(m, w.V, w.I), 0);
    output(m, "out", -out, w.I);
}

static void sepic(maker *m) {
    const point w = begin(m);
    const double out = w.V * w.D / (1 - w.D), L = fit_l(m, w.V, w.I);
    supply(m, "in", "0", w.V);
    gate(m, "g", 0, w.D);
    if (chance(m, 0.4)) {
        const char *one = winding(m, "in", "x", L), *two = winding(m, "y", "0", L);
        couple(m, one, two, draw_even(m, 0.5, 0.99));
    } else {
        inductor(m, "in", "x", L, 0);
        inductor(m, "y", "0", fit_l(m, w.V, w.I), 0);
    }
    mosfet(m, "x", "0", "g");
    capacitor(m, "x", "y", fit_c(m, w.V, w.I), 0);
    diode(m, "y", "out");
    output(m, "out", out, w.I);
}

static void zeta(maker *m) {
    const point w = begin(m);
    supply(m, "in", "0", w.V);
    gate(m, "g", 0, w.D);
    mosfet(m, "in", "x", "g");
    inductor(m, "x", "0", fit_l(m, w.V, w.I), 0);
    capacitor(m, "x", "y", fit_c(m, w.V, w.I), 0);
    diode(m, "0", "y");
    inductor(m, "y", "out", fit_l(m, w.V, w.I), 0);
    output(m, "out", w.V * w.D / (1 - w.D), w.I);
}

static void interleaved_buck(maker *m) {
    const point w = begin(m);
    const int phases = 2 + draw_one(m, 4);
    supply(m, "in", "0", w.V);
    for (int i = 0; i < phases; i++) {
        const char *g = indexed("g", i), *x = indexed("x", i);
        gate(m, g, (double)i / phases, w.D);
        contact(m, "in", x, g, "0");
        diode(m, "0", x);
        inductor(m, x, "out", fit_l(m, w.V, w.I / phases), 0);
    }
    output(m, "out", w.V * w.D, w.I);
}

static void interleaved_boost(maker *m) {
    const point w = begin(m);
    const int phases = 2 + draw_one(m, 3);
    supply(m, "in", "0", w.V);
    for (int i = 0; i < phases; i++) {
        const char *g = indexed("g", i), *x = indexed("x", i);
        gate(m, g, (double)i / phases, w.D);
        inductor(m, "in", x, fit_l(m, w.V, w.I / phases / (1 - w.D)), 0);
        mosfet(m, x, "0", g);
        diode(m, x, "out");
    }
    output(m, "out", w.V / (1 - w.D), w.I);
}

static void quadratic_boost(maker *m) {
    const point w = begin(m);
    const double D = fmin(w.D, 0.6), mid = w.V / (1 - D);
    supply(m, "in", "0", w.V);
    gate(m, "g", 0, D);
    inductor(m, "in", "a", fit_l(m, w.V, w.I / (1 - D) / (1 - D)), 0);
    diode(m, "a", "b");
    diode(m, "a", "x");
    capacitor(m, "b", "0", fit_c(m, mid, w.I / (1 - D)), 0);
    inductor(m, "b", "x", fit_l(m, mid, w.I / (1 - D)), 0);
    mosfet(m, "x", "0", "g");
    diode(m, "x", "out");
    output(m, "out", mid / (1 - D), w.I);
}

static void three_level_buck(maker *m) {
    const point w = begin(m);
    const double D = fmin(w.D, 0.7);
    supply(m, "in", "0", w.V);
    gate(m, "g1", 0, D);
    gate(m, "g2", 0.5, D);
    contact(m, "in", "a", "g1", "0");
    contact(m, "a", "x", "g2", "0");
    diode(m, "b", "x");
    diode(m, "0", "b");
    capacitor(m, "a", "b", fit_c(m, w.V / 2, w.I), w.V / 2);
    inductor(m, "x", "out", fit_l(m, w.V / 2, w.I), 0);
    output(m, "out", D * w.V, w.I);
}

static void tapped_buck(maker *m) {
    const point w = begin(m);
    const double L = fit_l(m, w.V, w.I), turns = draw_even(m, 0.3, 3);
    supply(m, "in", "0", w.V);
    gate(m, "g", 0, w.D);
    mosfet(m, "in", "x", "g");
    const char *one = winding(m, "x", "t", L), *two = winding(m, "t", "out", L * turns * turns);
    couple(m, one, two, draw_even(m, 0.9, 0.999));
    diode(m, "0", "t");
    resistor(m, "x", "sn", draw(m, 10, 1000));
    plain_c(m, "sn", "0", 1e-9, 0);
    output(m, "out", w.V * w.D, w.I);
}

/* One supply, two converters, a filter between. */
static void two_stages(maker *m) {
    const point w = begin(m);
    supply(m, "in", "0", w.V);
    gate(m, "g1", 0, w.D);
    gate(m, "g2", draw_even(m, 0, 1), draw_even(m, 0.2, 0.7));
    inductor(m, "in", "x", fit_l(m, w.V, w.I / (1 - w.D)), 0);
    mosfet(m, "x", "0", "g1");
    diode(m, "x", "bus");
    capacitor(m, "bus", "0", fit_c(m, w.V, w.I), w.V);
    contact(m, "bus", "y", "g2", "0");
    diode(m, "0", "y");
    inductor(m, "y", "out", fit_l(m, w.V, w.I), 0);
    output(m, "out", w.V / 2, w.I);
}

static void single_inductor_two_outputs(maker *m) {
    const point w = begin(m);
    supply(m, "in", "0", w.V);
    gate(m, "g", 0, w.D);
    gate(m, "ga", w.D, 0.4 * (1 - w.D));
    inductor(m, "in", "x", fit_l(m, w.V, w.I / (1 - w.D)), 0);
    mosfet(m, "x", "0", "g");
    contact(m, "x", "ya", "ga", "0");
    diode(m, "ya", "oa");
    diode(m, "x", "ob");
    output(m, "oa", w.V / (1 - w.D) * 0.7, w.I / 2);
    output(m, "ob", w.V / (1 - w.D), w.I / 2);
}

const family families_dcdc[] = {{"buck", buck},
                                {"buck-sync", buck_sync},
                                {"boost", boost},
                                {"boost-sync", boost_sync},
                                {"buck-boost", buck_boost},
                                {"four-switch", four_switch},
                                {"cuk", cuk},
                                {"sepic", sepic},
                                {"zeta", zeta},
                                {"interleaved-buck", interleaved_buck},
                                {"interleaved-boost", interleaved_boost},
                                {"quadratic-boost", quadratic_boost},
                                {"three-level-buck", three_level_buck},
                                {"tapped-buck", tapped_buck},
                                {"two-stages", two_stages},
                                {"sido", single_inductor_two_outputs},
                                {NULL, NULL}};
