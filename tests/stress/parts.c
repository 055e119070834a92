/* tests/stress/parts.c - parts with parasitics, devices with snubbers, gates. */
#include <math.h>
#include <string.h>

#include "maker.h"

void resistor(maker *m, const char *p, const char *n, double ohms) {
    netlist_put(m->n, "R%d %s %s %.4g", ++m->ids, p, n, ohms);
}

void plain_c(maker *m, const char *p, const char *n, double farads, double ic) {
    netlist_put(m->n, "C%d %s %s %.4g ic=%.4g", ++m->ids, p, n, farads, ic);
}

void capacitor(maker *m, const char *p, const char *n, double farads, double ic) {
    if (chance(m, m->parasites)) { /* ESR with R C of some 1e-3 to 0.1 periods */
        const char *inner = node(m, "e");
        resistor(m, p, inner, m->T * draw(m, 1e-3, 0.1) / farads);
        p = inner;
    }
    if (chance(m, 0.3 * m->parasites)) { /* ESL that rings 30 times a period */
        const char *inner = node(m, "e");
        netlist_put(m->n, "L%d %s %s %.4g ic=0", ++m->ids, p, inner,
                    pow(m->T * draw(m, 1e-3, 1e-2), 2) / farads);
        p = inner;
    }
    plain_c(m, p, n, farads, ic);
    if (chance(m, 0.3 * m->parasites))
        resistor(m, p, n, m->T * draw(m, 1e3, 1e6) / farads);
}

void inductor(maker *m, const char *p, const char *n, double henries, double ic) {
    if (chance(m, m->parasites)) {
        const char *inner = node(m, "w");
        resistor(m, p, inner, henries / m->T * draw(m, 1e-3, 0.1));
        p = inner;
    }
    netlist_put(m->n, "L%d %s %s %.4g ic=%.4g", ++m->ids, p, n, henries, ic);
    if (chance(m, 0.25 * m->parasites)) { /* the winding's capacitance, damped */
        const char *inner = node(m, "w");
        const double farads = pow(m->T * draw(m, 3e-3, 2e-2), 2) / henries;
        plain_c(m, p, inner, farads, 0);
        resistor(m, inner, n, sqrt(henries / farads) * draw(m, 0.03, 1));
    }
}

const char *winding(maker *m, const char *p, const char *n, double henries) {
    const char *name = node(m, "L");
    netlist_put(m->n, "%s %s %s %.6g ic=0", name, p, n, henries);
    return name;
}

void couple(maker *m, const char *l1, const char *l2, double k) {
    netlist_put(m->n, "K%d %s %s %.6g", ++m->ids, l1, l2, k);
}

static void snubber(maker *m, const char *p, const char *n) {
    const char *inner = node(m, "s");
    const double farads = draw(m, 1e-10, 1e-8) * fmin(1, m->T / 1e-5);
    resistor(m, p, inner, draw(m, 1e-3, 3e-2) * m->T / farads);
    plain_c(m, inner, n, farads, 0);
}

void diode(maker *m, const char *a, const char *k) {
    netlist_put(m->n, "AD%d %s %s md", ++m->ids, a, k);
    if (chance(m, m->snubbers))
        snubber(m, a, k);
    else if (m->coss > 0 && chance(m, 0.3))
        plain_c(m, a, k, m->coss * draw(m, 0.1, 1), 0);
}

void contact(maker *m, const char *p, const char *n, const char *g, const char *ref) {
    netlist_put(m->n, "AS%d %s %s %s %s %s", ++m->ids, p, n, g, ref, m->gate_rc ? "mg" : "ms");
}

void mosfet(maker *m, const char *d, const char *s, const char *g) {
    contact(m, d, s, g, "0");
    netlist_put(m->n, "AD%d %s %s md", ++m->ids, s, d);
    if (m->coss > 0)
        plain_c(m, d, s, m->coss, 0);
    else if (chance(m, m->snubbers))
        snubber(m, d, s);
}

void igbt(maker *m, const char *c, const char *e, const char *g) {
    const char *inner = node(m, "k");
    contact(m, c, inner, g, "0");
    netlist_put(m->n, "AD%d %s %s md", ++m->ids, inner, e);
    if (m->coss > 0)
        plain_c(m, c, e, m->coss, 0);
}

void supply(maker *m, const char *p, const char *n, double volts) {
    const int kind = draw_one(m, 4);
    const char *inner = kind >= 2 ? node(m, "v") : p;
    netlist_put(m->n, "V%d %s %s %.4g", ++m->ids, inner, n, volts);
    if (kind == 2)
        resistor(m, inner, p, draw(m, 1e-3, 0.05));
    if (kind == 3) { /* an inductor and an input capacitor */
        const double farads = draw(m, 1e-6, 1e-3) * m->T / 1e-5;
        const char *hot = node(m, "v");
        resistor(m, inner, hot, draw(m, 1e-3, 0.1));
        netlist_put(m->n, "L%d %s %s %.4g ic=0", ++m->ids, hot, p, pow(m->T * draw(m, 0.05, 1), 2) / farads);
        capacitor(m, p, n, farads, volts);
    }
}

static void step_load(maker *m, const char *p, const char *n, double ohms) {
    const char *inner = node(m, "q"), *command = node(m, "y");
    netlist_put(m->n, "V%d %s 0 PULSE(0 15 %.4g 1n 1n %.4g %.4g)", ++m->ids, command,
                m->stop * draw_even(m, 0.2, 0.5), m->stop * draw_even(m, 0.1, 0.3), 2 * m->stop);
    contact(m, p, inner, command, "0");
    resistor(m, inner, n, ohms);
}

void load(maker *m, const char *p, const char *n, double ohms) {
    const int kind = draw_one(m, 6);
    if (kind == 0) {
        const char *inner = node(m, "q");
        resistor(m, p, inner, ohms);
        netlist_put(m->n, "L%d %s %s %.4g ic=0", ++m->ids, inner, n, ohms * m->T * draw(m, 0.01, 10));
    } else {
        resistor(m, p, n, ohms);
        if (kind == 1)
            step_load(m, p, n, ohms * draw_even(m, 0.3, 3));
    }
}

void bleeder(maker *m, const char *p, const char *n) {
    if (chance(m, 0.7))
        resistor(m, p, n, draw(m, 1e4, 1e8));
}

/* --- gates --- */

/* From the driver's node to the gate's; returns the resistance. */
static double drive(maker *m, const char *driver, const char *name) {
    const double farads = draw(m, 3e-10, 5e-9), ohms = m->gate_tau / farads;
    resistor(m, driver, name, ohms);
    plain_c(m, name, "0", farads, 0);
    if (chance(m, 0.3)) { /* off faster than on */
        const char *inner = node(m, "g");
        netlist_put(m->n, "AD%d %s %s md", ++m->ids, name, inner);
        resistor(m, inner, driver, ohms * draw_even(m, 0.1, 0.5));
    }
    return ohms;
}

void gate_at(maker *m, const char *name, double from, double on, double period) {
    const double edge = fmin(m->edge, 0.2 * fmin(on, 1 - on) * period);
    const char *driver = m->gate_rc ? node(m, "d") : name;
    from -= floor(from);
    const double wraps = from + on - 1; /* on at the start */
    if (wraps > 1e-9)
        netlist_put(m->n, "V%d %s 0 PULSE(%d 0 %.9g %.4g %.4g %.9g %.9g)", ++m->ids, driver,
                    m->gate_rc ? 15 : 1, wraps * period, edge, edge, (1 - on) * period - edge, period);
    else
        netlist_put(m->n, "V%d %s 0 PULSE(0 %d %.9g %.4g %.4g %.9g %.9g)", ++m->ids, driver,
                    m->gate_rc ? 15 : 1, from * period, edge, edge, on * period - edge, period);
    if (m->gate_rc)
        drive(m, driver, name);
}

void gate(maker *m, const char *name, double from, double on) {
    gate_at(m, name, from, on, m->T);
}

void gate_compare(maker *m, const char *name, const char *p, const char *n, double vt, double vh) {
    const char *rail = node(m, "vc"), *model = node(m, "mc"), *driver = m->gate_rc ? node(m, "d") : name;
    netlist_put(m->n, ".model %s ideal_switch(vt=%.4g vh=%.4g)", model, vt, vh);
    netlist_put(m->n, "V%d %s 0 %d", ++m->ids, rail, m->gate_rc ? 15 : 1);
    netlist_put(m->n, "AS%d %s %s %s %s %s", ++m->ids, rail, driver, p, n, model);
    resistor(m, driver, "0", (m->gate_rc ? drive(m, driver, name) : 1e4) * draw(m, 1e-3, 0.03));
}

void sine(maker *m, const char *p, const char *n, double volts, double hertz, double degrees) {
    netlist_put(m->n, "V%d %s %s SIN(0 %.4g %.4g 0 0 %.4g)", ++m->ids, p, n, volts, hertz, degrees);
}
