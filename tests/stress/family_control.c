/* tests/stress/family_control.c - closed loops: the circuit's own state moves its switches. */
#include <math.h>

#include "maker.h"

typedef struct point {
    double V, out, I;
} point;

static point begin(maker *m) {
    maker_times(m, draw(m, 5e4, 1e6), draw_even(m, 30, 120));
    point w = {.V = draw(m, 5, 100), .I = draw(m, 0.3, 20)};
    w.out = w.V * draw_even(m, 0.2, 0.7);
    return w;
}

static void saw(maker *m, const char *name, double low, double high) {
    netlist_put(m->n, "V%d %s 0 PULSE(%.4g %.4g 0 %.6g %.6g %.4g %.6g)", ++m->ids, name, low, high,
                0.98 * m->T, 0.01 * m->T, 0.01 * m->T, m->T);
}

/* The buck's power stage from gate "g" on, output filter of a frequency below a tenth. */
static void power(maker *m, const point *w, int synchronous) {
    const double L = w->out * m->T / (w->I * draw_even(m, 0.2, 0.6)), f0 = draw(m, 0.02, 0.1) / m->T;
    supply(m, "in", "0", w->V);
    netlist_put(m->n, "Vm in im 0");
    contact(m, "im", "x", "g", "0");
    if (synchronous)
        mosfet(m, "x", "0", "gn");
    else
        diode(m, "0", "x");
    netlist_put(m->n, "Lb x ol %.4g ic=0", L);
    netlist_put(m->n, "Vl ol out 0");
    capacitor(m, "out", "0", 1 / (39.5 * f0 * f0 * L), chance(m, 0.5) ? 0 : w->out);
    load(m, "out", "0", w->out / w->I);
}

/* The amplifier: gain and bandwidth, output through a resistor, clamped. */
static void amplifier(maker *m, const char *plus, const char *minus, const char *out, double high) {
    netlist_put(m->n, "Eop o1 0 %s %s %.4g", plus, minus, draw(m, 1e3, 1e5));
    if (chance(m, 0.5)) {
        resistor(m, "o1", "o2", 1000);
        plain_c(m, "o2", "0", draw(m, 1e-8, 3e-6), 0);
        netlist_put(m->n, "Eb o3 0 o2 0 1");
        resistor(m, "o3", out, 100);
    } else
        resistor(m, "o1", out, 100);
    netlist_put(m->n, "Vcl clh 0 %.4g", high);
    netlist_put(m->n, "AD%d %s clh md", ++m->ids, out);
    netlist_put(m->n, "AD%d 0 %s md", ++m->ids, out);
}

/* Type 2 or 3 around it; crossover at a twentieth of the frequency of switching or below. */
static void compensator(maker *m, const point *w, int type, const char *out) {
    const double R1 = 1e4, vref = 2.5, fc = draw(m, 0.01, 0.05) / m->T, R2 = R1 * draw(m, 0.3, 5);
    netlist_put(m->n, "Vref ref 0 PWL(0 0 %.4g %.4g)", m->stop * draw(m, 0.01, 0.3), vref);
    resistor(m, "out", "fb", R1);
    resistor(m, "fb", "0", R1 * vref / fmax(w->out - vref, 0.1 * w->out));
    resistor(m, "fb", "f2", R2);
    plain_c(m, "f2", out, draw(m, 1, 5) / (6.2832 * fc * R2), 0);
    plain_c(m, "fb", out, draw(m, 0.02, 0.2) / (6.2832 * fc * R2), 0);
    if (type == 3) {
        resistor(m, "out", "f1", R1 * draw(m, 0.02, 0.1));
        plain_c(m, "f1", "fb", draw(m, 0.3, 1) / (6.2832 * fc * R1), 0);
    }
    amplifier(m, "ref", "fb", out, 2.2);
}

static void voltage_mode(maker *m) {
    const point w = begin(m);
    const int synchronous = chance(m, 0.4);
    saw(m, "saw", 0.2, 2);
    compensator(m, &w, 2 + draw_one(m, 2), "cmp");
    const double vt = synchronous ? 0.02 : 0, vh = chance(m, 0.5) ? 0 : 0.01;
    gate_compare(m, "g", "cmp", "saw", vt, vh);
    if (synchronous)
        gate_compare(m, "gn", "saw", "cmp", vt, vh);
    power(m, &w, synchronous);
}

/* The gate drives a switch at its output directly: as netlists often have it. */
static void voltage_mode_direct(maker *m) {
    const point w = begin(m);
    saw(m, "saw", 0.2, 2);
    compensator(m, &w, 3, "cmp");
    m->gate_rc = 0;
    netlist_put(m->n, ".model mc ideal_switch(vt=0 vh=%.4g%s)", chance(m, 0.5) ? 0 : 0.01,
                chance(m, 0.5) ? " ron=1m" : "");
    supply(m, "in", "0", w.V);
    netlist_put(m->n, "AS%d in x cmp saw mc", ++m->ids);
    diode(m, "0", "x");
    inductor(m, "x", "out", w.out * m->T / (w.I * 0.4), 0);
    capacitor(m, "out", "0", 100 * m->T * w.I / w.out * draw(m, 0.1, 1), 0);
    load(m, "out", "0", w.out / w.I);
}

/* A latch: a node q that a set switch pulls up and a reset switch pulls down, held by a switch with
 * hysteresis. */
static void latch(maker *m, const char *set, const char *reset_p, const char *reset_n) {
    netlist_put(m->n, "V%d lvc 0 1", ++m->ids);
    netlist_put(m->n, ".model mset ideal_switch(vt=0.5)");
    netlist_put(m->n, ".model mres ideal_switch(vt=0 vh=%.3g)", draw(m, 1e-4, 1e-2));
    netlist_put(m->n, ".model mhold ideal_switch(vt=0.5 vh=0.2)");
    resistor(m, "lvc", "ls", 100);
    netlist_put(m->n, "AS%d ls q %s 0 mset", ++m->ids, set);
    netlist_put(m->n, "AS%d q 0 %s %s mres", ++m->ids, reset_p, reset_n);
    plain_c(m, "q", "0", m->T * 1e-5, 0);
    resistor(m, "q", "0", 1e4);
    resistor(m, "lvc", "lh", 1e3);
    netlist_put(m->n, "AS%d lh q q 0 mhold", ++m->ids);
}

static void peak_current(maker *m) {
    const point w = begin(m);
    const double gain = 1 / (2 * w.I);
    netlist_put(m->n, "Vclk clk 0 PULSE(0 1 0 %.4g %.4g %.4g %.6g)", 0.002 * m->T, 0.002 * m->T, 0.02 * m->T,
                m->T);
    saw(m, "slope", 0, draw_even(m, 0.1, 0.6));
    netlist_put(m->n, "Hs is 0 Vl %.4g", gain);
    netlist_put(m->n, "Es isum is slope 0 1");
    netlist_put(m->n, "Esum sns 0 isum 0 1");
    compensator(m, &w, 2, "cmp");
    latch(m, "clk", "sns", "cmp");
    if (chance(m, 0.5))
        netlist_put(m->n, "Eg g 0 q 0 %d", m->gate_rc ? 15 : 1);
    else {
        netlist_put(m->n, "Vhalf half 0 0.5");
        gate_compare(m, "g", "q", "half", 0, 0.1);
    }
    power(m, &w, 0);
}

static void hysteretic_current(maker *m) {
    const point w = begin(m);
    netlist_put(m->n, "Hs is 0 Vl %.4g", 1 / w.I);
    netlist_put(m->n, "Vr ref 0 %.4g", draw_even(m, 0.5, 1.2));
    const double vh = draw(m, 0.02, 0.3), vt = chance(m, 0.5) ? 0 : 0.2 * vh;
    gate_compare(m, "g", "ref", "is", vt, vh);
    const int synchronous = chance(m, 0.5);
    if (synchronous)
        gate_compare(m, "gn", "is", "ref", vt, vh);
    power(m, &w, synchronous);
}

/* The output's ripple decides. */
static void hysteretic_voltage(maker *m) {
    const point w = begin(m);
    const double L = w.out * m->T / w.I, C = m->T * w.I / w.out * draw(m, 0.3, 5);
    netlist_put(m->n, "Vr ref 0 %.4g", w.out);
    gate_compare(m, "g", "ref", "out", 0, w.out * draw(m, 3e-3, 0.05));
    supply(m, "in", "0", w.V);
    contact(m, "in", "x", "g", "0");
    diode(m, "0", "x");
    inductor(m, "x", "out", L, 0);
    resistor(m, "out", "oc", m->T / C * draw(m, 0.03, 0.5));
    plain_c(m, "oc", "0", C, 0);
    load(m, "out", "0", w.out / w.I);
}

/* A complementary pair about a sine, in one instant or with a dead time. */
static void hysteretic_inverter(maker *m) {
    const double V = draw(m, 20, 600), I = draw(m, 1, 50), f = draw(m, 20, 400),
                 band = I * draw(m, 0.01, 0.1);
    maker_times(m, f * 100, 150);
    m->gate_rc = m->gate_rc && chance(m, 0.5);
    netlist_put(m->n, "V%d p 0 %.4g", ++m->ids, V);
    netlist_put(m->n, "V%d n 0 %.4g", ++m->ids, -V);
    netlist_put(m->n, "La x xs %.4g ic=0", V / (100 * f * band) * draw(m, 0.3, 3));
    netlist_put(m->n, "Vs xs o 0");
    resistor(m, "o", "0", V / I * draw_even(m, 0.1, 0.7));
    netlist_put(m->n, "H1 is 0 Vs 1");
    netlist_put(m->n, "Vr r 0 SIN(0 %.4g %.4g)", I, f);
    const double vt = chance(m, 0.5) ? 0 : 0.2 * band;
    gate_compare(m, "gu", "r", "is", vt, band);
    gate_compare(m, "gl", "is", "r", vt, band);
    mosfet(m, "p", "x", "gu");
    mosfet(m, "x", "n", "gl");
}

/* The same without comparators between. */
static void mirrored(maker *m) {
    const double V = draw(m, 20, 600), I = draw(m, 1, 50), f = draw(m, 20, 400),
                 band = I * draw(m, 0.01, 0.1);
    maker_times(m, f * 100, 150);
    netlist_put(m->n, "V%d p 0 %.4g", ++m->ids, V);
    netlist_put(m->n, "V%d n 0 %.4g", ++m->ids, -V);
    inductor(m, "x", "xs", V / (100 * f * band) * draw(m, 0.3, 3), 0);
    netlist_put(m->n, "Vs xs o 0");
    resistor(m, "o", "0", V / I * draw_even(m, 0.1, 0.7));
    netlist_put(m->n, "H1 is 0 Vs 1");
    netlist_put(m->n, "Vr r 0 SIN(0 %.4g %.4g)", I, f);
    netlist_put(m->n, "Eer h 0 r is 1");
    netlist_put(m->n, ".model mh ideal_switch(vt=0 vh=%.6g%s)", band, chance(m, 0.5) ? " ron=1m" : "");
    netlist_put(m->n, "AS1 p x h 0 mh");
    netlist_put(m->n, "AS2 x n 0 h mh");
    netlist_put(m->n, "AD1 x p md");
    netlist_put(m->n, "AD2 n x md");
}

/* Average current control of a boost from a rectified sine: multiplier left out, the reference is the sine.
 */
static void pfc_average(maker *m) {
    const double V = draw(m, 50, 350), I = draw(m, 1, 20), f = 50, ratio = 40 + draw_one(m, 100);
    maker_times(m, f * ratio, ratio * 0.6);
    sine(m, "a", "b", V, f, 0);
    for (int i = 0; i < 2; i++) {
        diode(m, i ? "b" : "a", "r");
        diode(m, "0", i ? "b" : "a");
    }
    netlist_put(m->n, "Vr rs 0 SIN(0 1 %g)", f);
    netlist_put(m->n, "AD%d rs rr md", ++m->ids); /* the reference: half waves */
    resistor(m, "rr", "0", 1e4);
    netlist_put(m->n, "Vm r rm 0");
    netlist_put(m->n, "Hs is 0 Vm %.4g", 1 / I);
    inductor(m, "rm", "x", V * m->T / (4 * I * draw_even(m, 0.1, 0.4)), 0);
    resistor(m, "is", "fb", 1e4);
    resistor(m, "fb", "f2", 1e4 * draw(m, 0.5, 3));
    plain_c(m, "f2", "cmp", m->T / 1e3, 0);
    amplifier(m, "rr", "fb", "cmp", 2);
    saw(m, "saw", 0.1, 2);
    gate_compare(m, "g", "cmp", "saw", 0, 0.02);
    mosfet(m, "x", "0", "g");
    diode(m, "x", "out");
    capacitor(m, "out", "0", I / f / V * draw(m, 0.3, 2), 1.4 * V);
    load(m, "out", "0", 2.4 * V / I);
}

/* With a diode, which changes with each switching, and a hysteresis; or with neither: the switch slides. */
static void bang_bang(maker *m) {
    const point w = begin(m);
    const int slides = chance(m, 0.5);
    m->gate_rc = 0;
    m->coss = 0;
    netlist_put(m->n, "Vr ref 0 %.4g", w.out);
    netlist_put(m->n, ".model mb ideal_switch(vt=0 vh=%.4g%s)", slides ? 0 : 0.01 * w.out,
                chance(m, 0.5) ? " ron=1m" : "");
    netlist_put(m->n, "V%d in 0 %.4g", ++m->ids, w.V);
    netlist_put(m->n, "AS1 in x ref out mb");
    if (slides)
        resistor(m, "x", "0", w.out / w.I * draw(m, 0.1, 1));
    else
        netlist_put(m->n, "AD1 0 x md");
    inductor(m, "x", "l", w.out * m->T / w.I, 0);
    resistor(m, "l", "out", w.out / w.I * 0.01);
    resistor(m, "out", "oc", w.out / w.I * draw(m, 0.01, 0.5));
    plain_c(m, "oc", "0", m->T * w.I / w.out * draw(m, 1, 30), 0);
    resistor(m, "out", "0", w.out / w.I);
}

const family families_control[] = {{"voltage-mode", voltage_mode},
                                   {"voltage-mode-direct", voltage_mode_direct},
                                   {"peak-current", peak_current},
                                   {"hysteretic-current", hysteretic_current},
                                   {"hysteretic-voltage", hysteretic_voltage},
                                   {"hysteretic-inverter", hysteretic_inverter},
                                   {"mirrored", mirrored},
                                   {"pfc-average", pfc_average},
                                   {"bang-bang", bang_bang},
                                   {NULL, NULL}};
