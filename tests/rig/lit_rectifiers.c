/* tests/rig/lit_rectifiers.c - the diode circuits of the literature, by hand and as netlists. */
#include "lit_rectifiers.h"

#include <math.h>
#include <stdlib.h>

static const lit_run runs[LIT_RECTIFIERS] = {
    {"R-L-C-diode", 10e-6, 50e-6, 100, 2, {10, 0.1}},
    {"LC bridge", 1e-6, 50e-6, 100, 2, {10, 0.1}},
    {"bridge with filter", 1e-6, 50e-6, 100, 3, {10, 0.1, 10}},
    {"power supply", 1e-6, 50e-6, 100, 1, {10}},
    {"resonant converter", 50e-9, 100e-6, 20, 4, {0.1, 10, 0.1, 10}}, /* 100 us: 11 half periods */
};

const lit_run *lit_run_of(lit_rectifier which) {
    return &runs[which];
}

static void must(int status) {
    if (status != NS_OK)
        abort();
}

/* --- by hand --- */

static ns_system *make(int n, int m, int nz) {
    ns_system *s;
    must(ns_system_create(n, m, nz, 0, &s));
    return s;
}

static void set(double *a, int rows, int i, int j, double v) {
    a[i + j * rows] = v;
}

/* C v' = -i - v/.., L i' = v in rows 0 and 1. */
static void set_tank(ns_system *s) {
    set(s->M, s->n, 0, 0, 1e-6);
    set(s->M, s->n, 1, 1, 10e-3);
    set(s->A, s->n, 0, 1, -1);
    set(s->A, s->n, 1, 0, 1);
}

/* lambda: current of the diode;  y = R lambda - v. */
static ns_system *rlcd(void) {
    ns_system *s = make(2, 1, 0);
    set_tank(s);
    set(s->B, 2, 0, 0, -1);
    set(s->C, 1, 0, 0, -1);
    set(s->D, 1, 0, 0, 1e3);
    return s;
}

/* lambda = (-v_D1, -v_D3, i_D2, i_D4), y = (i_D1, i_D3, -v_D2, -v_D4) for the bridge D1 p->t, D2 n->t,
 * D3 g->n, D4 g->p, whose load draws what g (per state and per volt at t) says: with v = v_p - v_n,
 *     v_t = v + lambda_1 + lambda_2,  i_D1 = i_load - lambda_3,  i_D3 = i_load - lambda_4,
 * and the bridge draws i_load - lambda_3 - lambda_4 from p. */
static void set_bridge(ns_system *s, double g, int load) {
    const double D[4][4] = {{g, g, -1, 0}, {g, g, 0, -1}, {1, 0, 0, 0}, {0, 1, 0, 0}};
    const int v = load < 0 ? 0 : 1;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            set(s->D, 4, i, j, D[i][j]);
    for (int i = 0; i < 2; i++) {
        set(s->C, 4, i, v, g);
        set(s->C, 4, 2 + i, v, 1);
        set(s->B, s->n, v, i, -g);
        set(s->B, s->n, v, 2 + i, 1);
        if (load >= 0)
            set(s->C, 4, i, load, 1);
    }
    s->A[v * (s->n + 1)] -= g;
    if (load >= 0)
        set(s->A, s->n, v, load, -1);
}

static ns_system *bridge(void) {
    ns_system *s = make(2, 4, 0);
    set_tank(s);
    set_bridge(s, 1e-3, -1);
    return s;
}

/* lambda: currents of D1..D4; y: what they block, raised by vf; t and n are rows 'load' and 'n':
 * 0 = lambda_1 + lambda_2 - lambda_3 - lambda_4. */
static void set_currents(ns_system *s, int load, int n, double vf) {
    set(s->M, s->n, load, load, 0.3e-6);
    set(s->A, s->n, load, load, -1e-3);
    for (int i = 0; i < 4; i++) {
        if (i < 2)
            set(s->B, s->n, load, i, 1);
        set(s->B, s->n, n, i, i < 2 ? 1 : -1);
        set(s->C, 4, i, n, i < 2 ? -1 : 1);
        if (i < 2)
            set(s->C, 4, i, load, 1);
        s->e[i] = vf;
    }
}

/* x = (v, i_L, v_load, v_n) */
static ns_system *filter(void) {
    ns_system *s = make(4, 4, 0);
    set_tank(s);
    set_currents(s, 2, 3, 0);
    set(s->B, 4, 0, 0, -1);
    set(s->B, 4, 0, 3, 1);
    set(s->C, 4, 0, 0, -1);
    set(s->C, 4, 3, 0, 1);
    return s;
}

static ns_signal cosine(void) {
    ns_signal z = {.kind = NS_SIN};
    z.u.sin.va = 10;
    z.u.sin.freq = 1e4 / 6.283185307179586477;
    z.u.sin.phase = 90;
    return z;
}

/* x = (v_load, v_n), z = v_p - v_n */
static ns_system *supply(void) {
    ns_system *s = make(2, 4, 1);
    const ns_signal z = cosine();
    set_currents(s, 0, 1, 0.21);
    set(s->F, 4, 0, 0, -1);
    set(s->F, 4, 3, 0, 1);
    must(ns_system_set_input(s, 0, &z));
    return s;
}

static ns_signal square(void) {
    ns_signal z = {.kind = NS_PULSE};
    z.u.pulse.v1 = -1;
    z.u.pulse.v2 = 1;
    z.u.pulse.pw = 0.5 / 55e3;
    z.u.pulse.per = 1 / 55e3;
    return z;
}

/* x = (i_L1, v_C, i_L2, v_load);  L1 i1' = z - v_C,  L2 i2' = v_t - v_load */
static ns_system *resonant(void) {
    ns_system *s = make(4, 4, 1);
    const double M[] = {150e-6, 68e-9, 0.4e-3, 2.2e-6};
    const ns_signal z = square();
    for (int i = 0; i < 4; i++)
        set(s->M, 4, i, i, M[i]);
    set_bridge(s, 0, 2);
    set(s->A, 4, 0, 1, -1);
    set(s->E, 4, 0, 0, 1);
    set(s->A, 4, 1, 0, 1);
    set(s->A, 4, 2, 1, 1);
    set(s->A, 4, 2, 3, -1);
    set(s->B, 4, 2, 0, 1);
    set(s->B, 4, 2, 1, 1);
    set(s->A, 4, 3, 2, 1);
    set(s->A, 4, 3, 3, -1.0 / 33);
    must(ns_system_set_input(s, 0, &z));
    return s;
}

ns_system *lit_hand(lit_rectifier which, double *w0) {
    ns_system *(*const make_it[LIT_RECTIFIERS])(void) = {rlcd, bridge, filter, supply, resonant};
    for (int i = 0; i < LIT_X; i++)
        w0[i] = 0;
    if (which <= LIT_FILTER)
        w0[0] = 1e-6 * 10;
    return make_it[which]();
}

void lit_hand_out(lit_rectifier which, const double *x, double *out) {
    for (int i = 0; i < runs[which].out; i++)
        out[i] = x[i];
}

/* --- as netlists --- */

enum { G, P, N, T, S, O }; /* nodes */

static void capacitor(ns_circuit *c, const char *name, int p, int n, double farads, double ic) {
    must(ns_circuit_capacitor(c, name, p, n, farads, ic, NULL));
}

/* The first inductor is element 0: lit_netlist_out() reads its current. */
static void inductor(ns_circuit *c, const char *name, int p, int n, double henries) {
    must(ns_circuit_inductor(c, name, p, n, henries, 0, NULL));
}

static void resistor(ns_circuit *c, const char *name, int p, int n, double ohms) {
    must(ns_circuit_resistor(c, name, p, n, ohms, NULL));
}

static void diodes(ns_circuit *c, double vf) {
    const ns_diode d = {vf, 0, INFINITY, INFINITY, 0};
    must(ns_circuit_diode(c, "d1", P, T, &d, NULL));
    must(ns_circuit_diode(c, "d2", N, T, &d, NULL));
    must(ns_circuit_diode(c, "d3", G, N, &d, NULL));
    must(ns_circuit_diode(c, "d4", G, P, &d, NULL));
}

static void source(ns_circuit *c, int p, int n, const ns_signal *z) {
    must(ns_circuit_source(c, "v1", NS_VOLTAGE, p, n, z, NULL));
}

ns_circuit *lit_netlist(lit_rectifier which) {
    const ns_diode ideal = {0, 0, INFINITY, INFINITY, 0};
    const ns_signal cos1e4 = cosine(), square55k = square();
    ns_circuit *c;
    must(ns_circuit_create(&c));
    switch (which) {
    case LIT_RLCD:
        inductor(c, "l1", P, G, 10e-3);
        capacitor(c, "c1", P, G, 1e-6, 10);
        resistor(c, "r1", P, N, 1e3);
        must(ns_circuit_diode(c, "d1", N, G, &ideal, NULL));
        break;
    case LIT_BRIDGE:
    case LIT_FILTER:
        inductor(c, "l1", P, N, 10e-3);
        capacitor(c, "c1", P, N, 1e-6, 10);
        diodes(c, 0);
        resistor(c, "r1", T, G, 1e3);
        if (which == LIT_FILTER)
            capacitor(c, "c2", T, G, 0.3e-6, 0);
        break;
    case LIT_SUPPLY:
        source(c, P, N, &cos1e4);
        diodes(c, 0.21);
        resistor(c, "r1", T, G, 1e3);
        capacitor(c, "c2", T, G, 0.3e-6, 0);
        break;
    default:
        inductor(c, "l1", S, P, 150e-6);
        inductor(c, "l2", T, O, 0.4e-3);
        source(c, S, N, &square55k);
        capacitor(c, "c1", P, N, 68e-9, 0);
        diodes(c, 0);
        capacitor(c, "c2", O, G, 2.2e-6, 0);
        resistor(c, "r1", O, G, 33);
    }
    return c;
}

static double volts(const ns_circuit *c, const double *x, int p, int n) {
    return (p == G ? 0 : x[ns_circuit_node_unknown(c, p)]) - (n == G ? 0 : x[ns_circuit_node_unknown(c, n)]);
}

void lit_netlist_out(lit_rectifier which, const ns_circuit *c, const double *x, double *out) {
    if (which == LIT_SUPPLY) {
        out[0] = volts(c, x, T, G);
        return;
    }
    const double i1 = x[ns_circuit_current_unknown(c, 0)], v = volts(c, x, P, which == LIT_RLCD ? G : N);
    out[0] = which == LIT_RESONANT ? i1 : v;
    out[1] = which == LIT_RESONANT ? v : i1;
    if (which == LIT_FILTER)
        out[2] = volts(c, x, T, G);
    if (which == LIT_RESONANT) {
        out[2] = x[ns_circuit_current_unknown(c, 1)];
        out[3] = volts(c, x, O, G);
    }
}
