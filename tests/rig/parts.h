/* tests/rig/parts.h - elements of a rig, by name, and what the sparse marcher makes of them. */
#ifndef PARTS_H
#define PARTS_H

#include "rig.h"

/* The tolerance of a step is 1e-11, what is expected is met a hundred times that. */
static const double close_enough = 1e-9;

static inline void make(rig *k, double h) {
    const ns_march_options o = {.h = h, .method = NS_SPARSE, .reltol = 1e-11};
    make_by(k, &o);
}

static inline void ready(rig *k, double h) {
    make(k, h);
    start_at_rest(k);
}

static inline void near(double got, double expected, double size) {
    if (!(fabs(got - expected) <= close_enough * size))
        fail_msg("%.17g, expected %.17g", got, expected);
}

static inline void resistor(rig *k, const char *name, int p, int n, double r) {
    assert_int_equal(ns_circuit_resistor(k->c, name, p, n, r, NULL), NS_OK);
}

static inline void capacitor(rig *k, const char *name, int p, int n, double c, double v) {
    assert_int_equal(ns_circuit_capacitor(k->c, name, p, n, c, v, NULL), NS_OK);
}

static inline int inductor(rig *k, const char *name, int p, int n, double l) {
    int id;
    assert_int_equal(ns_circuit_inductor(k->c, name, p, n, l, 0, &id), NS_OK);
    return id;
}

static inline void diode(rig *k, const char *name, int p, int n) {
    const ns_diode ideal = {0, 0, INFINITY, INFINITY, 0};
    assert_int_equal(ns_circuit_diode(k->c, name, p, n, &ideal, NULL), NS_OK);
}

static inline void source(rig *k, const char *name, int p, const ns_signal *s) {
    assert_int_equal(ns_circuit_source(k->c, name, NS_VOLTAGE, p, 0, s, NULL), NS_OK);
}

static inline void constant(rig *k, const char *name, int p, double v) {
    source(k, name, p, &(ns_signal){.kind = NS_DC, .u.dc = v});
}

/* A gate that is 1 from 0 to on, 0 up to period, and so on; edges are jumps. */
static inline void gate(rig *k, const char *name, int p, double on, double period) {
    ns_signal s = {.kind = NS_PULSE};
    s.u.pulse.v2 = 1;
    s.u.pulse.pw = on;
    s.u.pulse.per = period;
    source(k, name, p, &s);
}

static inline void contact(rig *k, const char *name, int p, int n, int control, double vt, double vh) {
    const ns_switch sw = {vt, vh, 0, INFINITY};
    assert_int_equal(ns_circuit_switch(k->c, name, p, n, control, 0, &sw, NULL), NS_OK);
}

static inline double voltage(const rig *k, int node) {
    return k->x[ns_circuit_node_unknown(k->c, node)];
}

#endif
