/* tests/stress/family_isolated.c - converters with a transformer; the secondary floats or has a bleeder. */
#include <math.h>

#include "maker.h"

typedef struct point {
    double V, I, ratio; /* supply, load current, turns of the secondary per turn of the primary */
    double k, Lm;       /* coupling, magnetising inductance */
} point;

static point begin(maker *m) {
    maker_times(m, draw(m, 3e4, 5e5), draw_even(m, 12, 60));
    point w = {.V = draw(m, 10, 600), .I = draw(m, 0.2, 20), .ratio = draw(m, 0.05, 3)};
    w.k = chance(m, 0.3) ? 1 : chance(m, 0.3) ? 1 - draw(m, 1e-5, 1e-3) : draw_even(m, 0.95, 0.999);
    w.Lm = w.V * m->T / (w.I * w.ratio * draw(m, 0.05, 1));
    return w;
}

/* Ground of the secondary: floats, bled, or joined. */
static const char *secondary_ground(maker *m) {
    const int kind = draw_one(m, 3);
    if (kind == 0)
        return "0";
    if (kind == 1)
        resistor(m, "sg", "0", draw(m, 1, 1e8));
    return "sg";
}

static void output(maker *m, const char *p, const char *n, double volts, double amperes) {
    capacitor(m, p, n, fit_c(m, volts, amperes), chance(m, 0.5) ? 0 : volts * draw_even(m, 0.3, 1.1));
    load(m, p, n, volts / amperes);
}

static void pair(maker *m, const point *w, const char *p1, const char *n1, const char *p2, const char *n2) {
    const char *one = winding(m, p1, n1, w->Lm), *two = winding(m, p2, n2, w->Lm * w->ratio * w->ratio);
    couple(m, one, two, w->k);
}

/* Three windings: the secondary has a tap. */
static void tapped(maker *m, const point *w, const char *p, const char *n, const char *s1, const char *tap,
                   const char *s2) {
    const double second = w->Lm * w->ratio * w->ratio;
    const char *one = winding(m, p, n, w->Lm), *two = winding(m, s1, tap, second),
               *three = winding(m, tap, s2, second);
    couple(m, one, two, w->k);
    couple(m, one, three, w->k);
    couple(m, two, three, w->k);
}

static void rcd(maker *m, const point *w, const char *x, const char *in) {
    const char *clamp = node(m, "cl");
    const double volts = w->V * draw_even(m, 1, 3);
    netlist_put(m->n, "AD%d %s %s md", ++m->ids, x, clamp);
    plain_c(m, clamp, in, m->T * draw(m, 3, 30) * w->I * w->ratio / volts / 10, volts);
    resistor(m, clamp, in, 10 * volts / (w->I * w->ratio));
}

static void flyback(maker *m) {
    const point w = begin(m);
    const double D = draw_even(m, 0.2, 0.6);
    const char *g = secondary_ground(m);
    supply(m, "in", "0", w.V);
    gate(m, "g", 0, D);
    pair(m, &w, "in", "x", g, "s");
    rcd(m, &w, "x", "in");
    mosfet(m, "x", "0", "g");
    diode(m, "s", "out");
    output(m, "out", g, w.V * w.ratio * D / (1 - D), w.I);
}

static void forward(maker *m) {
    const point w = begin(m);
    const double D = draw_even(m, 0.15, 0.45);
    const char *g = secondary_ground(m);
    supply(m, "in", "0", w.V);
    gate(m, "g", 0, D);
    const char *one = winding(m, "in", "x", w.Lm), *two = winding(m, "s", g, w.Lm * w.ratio * w.ratio),
               *reset = winding(m, "r", "in", w.Lm);
    const double k = fmin(w.k, 0.9999);
    couple(m, one, two, k);
    couple(m, one, reset, k);
    couple(m, two, reset, k);
    diode(m, "0", "r");
    mosfet(m, "x", "0", "g");
    rcd(m, &w, "x", "in");
    diode(m, "s", "y");
    diode(m, g, "y");
    inductor(m, "y", "out", fit_l(m, w.V * w.ratio, w.I), 0);
    output(m, "out", g, w.V * w.ratio * D, w.I);
}

static void two_switch_forward(maker *m) {
    const point w = begin(m);
    const double D = draw_even(m, 0.15, 0.45);
    const char *g = secondary_ground(m);
    supply(m, "in", "0", w.V);
    gate(m, "ga", 0, D);
    gate(m, "gb", 0, D);
    mosfet(m, "in", "a", "ga");
    mosfet(m, "b", "0", "gb");
    diode(m, "0", "a");
    diode(m, "b", "in");
    pair(m, &w, "a", "b", "s", g);
    diode(m, "s", "y");
    diode(m, g, "y");
    inductor(m, "y", "out", fit_l(m, w.V * w.ratio, w.I), 0);
    output(m, "out", g, w.V * w.ratio * D, w.I);
}

static void active_clamp(maker *m) {
    const point w = begin(m);
    const double D = draw_even(m, 0.25, 0.6), dead = draw(m, 5e-3, 0.03);
    const char *g = secondary_ground(m);
    supply(m, "in", "0", w.V);
    gate(m, "ga", 0, D);
    gate(m, "gb", D + dead, 1 - D - 2 * dead);
    pair(m, &w, "in", "x", g, "s");
    mosfet(m, "x", "0", "ga");
    mosfet(m, "c", "x", "gb");
    capacitor(m, "c", "in", fit_c(m, w.V, w.I * w.ratio), 0);
    diode(m, "s", "out");
    output(m, "out", g, w.V * w.ratio * D / (1 - D), w.I);
}

static void tapped_rectifier(maker *m, const point *w, const char *g) {
    diode(m, "s1", "y");
    diode(m, "s2", "y");
    if (chance(m, 0.8))
        inductor(m, "y", "out", fit_l(m, w->V * w->ratio, w->I), 0);
    else
        resistor(m, "y", "out", 0.01 * w->V * w->ratio / w->I);
    output(m, "out", g, w->V * w->ratio, w->I);
}

static void bridge_rectifier(maker *m, const point *w, const char *s1, const char *s2, const char *g,
                             int choke) {
    diode(m, s1, "y");
    diode(m, s2, "y");
    diode(m, g, s1);
    diode(m, g, s2);
    if (choke)
        inductor(m, "y", "out", fit_l(m, w->V * w->ratio, w->I), 0);
    else
        resistor(m, "y", "out", 0.01 * w->V * w->ratio / w->I);
    output(m, "out", g, w->V * w->ratio, w->I);
}

static void push_pull(maker *m) {
    const point w = begin(m);
    const double D = draw_even(m, 0.15, 0.47);
    const char *g = secondary_ground(m);
    supply(m, "in", "0", w.V);
    gate(m, "ga", 0, D);
    gate(m, "gb", 0.5, D);
    const char *l[4] = {winding(m, "in", "xa", w.Lm), winding(m, "xb", "in", w.Lm),
                        winding(m, "s1", g, w.Lm * w.ratio * w.ratio),
                        winding(m, g, "s2", w.Lm * w.ratio * w.ratio)};
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < i; j++)
            couple(m, l[j], l[i], w.k);
    mosfet(m, "xa", "0", "ga");
    mosfet(m, "xb", "0", "gb");
    tapped_rectifier(m, &w, g);
}

static void half_bridge(maker *m) {
    const point w = begin(m);
    const double D = draw_even(m, 0.15, 0.47);
    const char *g = secondary_ground(m);
    supply(m, "in", "0", w.V);
    gate(m, "ga", 0, D);
    gate(m, "gb", 0.5, D);
    mosfet(m, "in", "a", "ga");
    mosfet(m, "a", "0", "gb");
    capacitor(m, "in", "m", fit_c(m, w.V, w.I * w.ratio), w.V / 2);
    capacitor(m, "m", "0", fit_c(m, w.V, w.I * w.ratio), w.V / 2);
    tapped(m, &w, "a", "m", "s1", g, "s2");
    tapped_rectifier(m, &w, g);
}

/* Two legs; the second lags by `shift` of a period. */
static void two_legs(maker *m, double shift, double on) {
    gate(m, "ga", 0, on);
    gate(m, "gb", 0.5, on);
    gate(m, "gc", 0.5 + shift, on);
    gate(m, "gd", shift, on);
    mosfet(m, "in", "a", "ga");
    mosfet(m, "a", "0", "gb");
    mosfet(m, "in", "b", "gc");
    mosfet(m, "b", "0", "gd");
}

static void full_bridge(maker *m) {
    const point w = begin(m);
    const char *g = secondary_ground(m);
    supply(m, "in", "0", w.V);
    two_legs(m, 0, draw_even(m, 0.15, 0.48));
    if (chance(m, 0.5))
        pair(m, &w, "a", "b", "s1", "s2");
    else {
        capacitor(m, "a", "ab", fit_c(m, w.V, w.I * w.ratio), 0);
        pair(m, &w, "ab", "b", "s1", "s2");
    }
    bridge_rectifier(m, &w, "s1", "s2", g, chance(m, 0.7));
}

static void phase_shift_bridge(maker *m) {
    const point w = begin(m);
    const char *g = secondary_ground(m);
    supply(m, "in", "0", w.V);
    two_legs(m, draw_even(m, 0.02, 0.45), 0.5 - draw(m, 2e-3, 0.03));
    inductor(m, "a", "p", w.Lm * draw(m, 3e-3, 0.05), 0);
    tapped(m, &w, "p", "b", "s1", g, "s2");
    tapped_rectifier(m, &w, g);
}

static void current_doubler(maker *m) {
    const point w = begin(m);
    const char *g = secondary_ground(m);
    supply(m, "in", "0", w.V);
    two_legs(m, 0, draw_even(m, 0.15, 0.45));
    pair(m, &w, "a", "b", "s1", "s2");
    diode(m, g, "s1");
    diode(m, g, "s2");
    inductor(m, "s1", "out", fit_l(m, w.V * w.ratio, w.I), 0);
    inductor(m, "s2", "out", fit_l(m, w.V * w.ratio, w.I), 0);
    output(m, "out", g, w.V * w.ratio / 2, w.I);
}

static void llc(maker *m) {
    point w = begin(m);
    const double on = 0.5 - draw(m, 2e-3, 0.03), R = w.V / (2 * w.I * w.ratio),
                 f = draw_even(m, 0.7, 1.4) / m->T;
    const double Q = draw_even(m, 0.2, 1), Lr = Q * R / (6.2832 * f);
    const char *g = secondary_ground(m);
    supply(m, "in", "0", w.V);
    gate(m, "ga", 0, on);
    gate(m, "gb", 0.5, on);
    mosfet(m, "in", "a", "ga");
    mosfet(m, "a", "0", "gb");
    inductor(m, "a", "p", Lr, 0);
    w.Lm = Lr * draw_even(m, 3, 8);
    tapped(m, &w, "p", "n", "s1", g, "s2");
    plain_c(m, "n", "0", 1 / (6.2832 * 6.2832 * f * f * Lr), 0);
    diode(m, "s1", "out");
    diode(m, "s2", "out");
    output(m, "out", g, w.V * w.ratio / 2, w.I);
}

static void series_resonant(maker *m) {
    const point w = begin(m);
    const double f = draw_even(m, 0.5, 2) / m->T, Z = w.V / (w.I * w.ratio) * draw(m, 0.3, 3);
    const char *g = secondary_ground(m);
    supply(m, "in", "0", w.V);
    two_legs(m, 0, 0.5 - draw(m, 2e-3, 0.03));
    inductor(m, "a", "r", Z / (6.2832 * f), 0);
    plain_c(m, "r", "p", 1 / (6.2832 * f * Z), 0);
    pair(m, &w, "p", "b", "s1", "s2");
    bridge_rectifier(m, &w, "s1", "s2", g, 0);
}

static void dual_active_bridge(maker *m) {
    const point w = begin(m);
    const double on = 0.5 - draw(m, 2e-3, 0.02), shift = draw_even(m, 0.01, 0.24), out = w.V * w.ratio;
    const char *g = secondary_ground(m);
    supply(m, "in", "0", w.V);
    two_legs(m, 0, on);
    inductor(m, "a", "p", w.V * m->T * shift * draw_even(m, 0.3, 1) / (w.I * w.ratio), 0);
    pair(m, &w, "p", "b", "s1", "s2");
    gate(m, "ge", shift, on);
    gate(m, "gf", shift + 0.5, on);
    mosfet(m, "out", "s1", "ge");
    mosfet(m, "s1", g, "gf");
    mosfet(m, "out", "s2", "gf");
    mosfet(m, "s2", g, "ge");
    output(m, "out", g, out, w.I);
}

static void current_fed(maker *m) {
    const point w = begin(m);
    const double D = draw_even(m, 0.55, 0.75);
    const char *g = secondary_ground(m);
    supply(m, "in", "0", w.V);
    gate(m, "ga", 0, D);
    gate(m, "gb", 0.5, D);
    inductor(m, "in", "t", fit_l(m, w.V, w.I * w.ratio), 0);
    const char *a = winding(m, "t", "xa", w.Lm), *b = winding(m, "xb", "t", w.Lm),
               *s = winding(m, "s1", "s2", w.Lm * w.ratio * w.ratio);
    const double k = fmin(w.k, 0.9999);
    couple(m, a, b, k);
    couple(m, a, s, k);
    couple(m, b, s, k);
    mosfet(m, "xa", "0", "ga");
    mosfet(m, "xb", "0", "gb");
    rcd(m, &w, "xa", "in");
    rcd(m, &w, "xb", "in");
    bridge_rectifier(m, &w, "s1", "s2", g, 0);
}

static void class_e(maker *m) {
    const point w = begin(m);
    const double R = w.V / w.I, f = 1 / m->T, Q = draw_even(m, 3, 12);
    supply(m, "in", "0", w.V);
    gate(m, "g", 0, 0.5);
    inductor(m, "in", "x", 30 * R / f, 0);
    contact(m, "x", "0", "g", "0");
    netlist_put(m->n, "AD%d 0 x md", ++m->ids);
    plain_c(m, "x", "0", 0.1836 / (6.2832 * f * R) * draw(m, 0.5, 2), 0);
    plain_c(m, "x", "r", 1 / (6.2832 * f * R * (Q - 1.15)), 0);
    inductor(m, "r", "o", Q * R / (6.2832 * f), 0);
    resistor(m, "o", "0", R);
}

const family families_isolated[] = {{"flyback", flyback},
                                    {"forward", forward},
                                    {"two-switch-forward", two_switch_forward},
                                    {"active-clamp", active_clamp},
                                    {"push-pull", push_pull},
                                    {"half-bridge", half_bridge},
                                    {"full-bridge", full_bridge},
                                    {"psfb", phase_shift_bridge},
                                    {"current-doubler", current_doubler},
                                    {"llc", llc},
                                    {"series-resonant", series_resonant},
                                    {"dab", dual_active_bridge},
                                    {"current-fed", current_fed},
                                    {"class-e", class_e},
                                    {NULL, NULL}};
