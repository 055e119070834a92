/* tests/rig/passive.c - random networks of R, L, C, ideal diodes and switches that open. */
#include "passive.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

static unsigned long state;
unsigned draw(unsigned below) { /* Knuth's MMIX generator, high bits */
    state = state * 6364136223846793005ul + 1442695040888963407ul;
    return (unsigned)(state >> 33) % below;
}

void random_network(element *e, unsigned long seed) {
    state = seed;
    for (int k = 0; k < ELEMENTS; k++) {
        const unsigned r = draw(10);
        e[k].kind = k == 0   ? CAP
                    : k == 1 ? IND
                    : r < 2  ? RES
                    : r < 4  ? CAP
                    : r < 5  ? IND
                    : r < 8  ? DIODE
                             : SWITCH;
        e[k].p = (int)draw(NODES);
        do
            e[k].n = (int)draw(NODES);
        while (e[k].n == e[k].p);
        const double size = pow(10, (double)draw(5) - 2); /* 0.01 .. 100 */
        e[k].value = e[k].kind == RES ? 100 * size : e[k].kind == CAP ? 1e-6 * size : 1e-3 * size;
        e[k].ic = e[k].kind == CAP   ? (double)draw(20) - 10
                  : e[k].kind == IND ? ((double)draw(20) - 10) / 10
                                     : 0;
        e[k].instant = 1e-6 * (1 + draw(60));
    }
}

/* 1 V up and down from 3.3 us on, by ramps of 10 ns. */
static int add_drive(run *r, int p, int n, int k) {
    const int inner = 200 + k;
    ns_signal s = {.kind = NS_PULSE};
    s.u.pulse.v1 = -1;
    s.u.pulse.v2 = 1;
    s.u.pulse.td = 3.3e-6;
    s.u.pulse.tr = s.u.pulse.tf = 1e-8;
    s.u.pulse.pw = 7e-6;
    s.u.pulse.per = 17e-6;
    const int status = ns_circuit_resistor(r->c, "rs", inner, n, 10, NULL);
    return status != NS_OK ? status : ns_circuit_source(r->c, "vs", NS_VOLTAGE, p, inner, &s, &r->id[k]);
}

static int add(run *r, const element *e, int k) {
    char name[16];
    const int p = r->node[e->p], n = r->node[e->n];
    const ns_diode d = {0, 0, r->roff, INFINITY, 0};
    const ns_switch sw = {0.5, 0, 0, r->roff};
    snprintf(name, sizeof name, "e%d", k);
    switch (e->kind) {
    case RES:
        return ns_circuit_resistor(r->c, name, p, n, e->value, &r->id[k]);
    case CAP:
        return ns_circuit_capacitor(r->c, name, p, n, e->value, e->ic, &r->id[k]);
    case IND:
        return ns_circuit_inductor(r->c, name, p, n, e->value, e->ic, &r->id[k]);
    case DIODE:
        return ns_circuit_diode(r->c, name, p, n, &d, &r->id[k]);
    case DRIVE:
        return add_drive(r, p, n, k);
    default: {
        /* closed first, then open (or the reverse), at its own instant; the gate drives nothing else */
        const double at = fabs(e->instant), t[2] = {at, at}, v[2] = {e->instant > 0, e->instant < 0};
        ns_signal s = {.kind = NS_PWL};
        s.u.pwl.n = 2;
        s.u.pwl.t = t;
        s.u.pwl.v = v;
        s.u.pwl.repeat = NAN;
        const int gate = 100 + k;
        const int status = ns_circuit_switch(r->c, name, p, n, gate, 0, &sw, &r->id[k]);
        snprintf(name, sizeof name, "v%d", k);
        return status != NS_OK ? status : ns_circuit_source(r->c, name, NS_VOLTAGE, gate, 0, &s, NULL);
    }
    }
}

/* 0 if the network is refused, with a reason that may be. */
static int accepted(const run *r, int status) {
    char line[256];
    if (status == NS_OK)
        return 1;
    ns_circuit_explain(r->c, ns_march_fault(r->m), line, sizeof line);
    print_message("refused: %s\n", line);
    assert_true(status == NS_E_SINGULAR || status == NS_E_INFEASIBLE || status == NS_E_RESIDUAL);
    return 0;
}

int begin(run *r, const element *e, const int *order, double h) {
    double w0[256];
    assert_int_equal(ns_circuit_create(&r->c), NS_OK);
    for (int k = 0; k < ELEMENTS; k++)
        assert_int_equal(add(r, &e[order[k]], order[k]), NS_OK);
    assert_int_equal(ns_circuit_system(r->c, &r->s), NS_OK);
    assert_true(r->s->n <= 256);
    const ns_march_options o = {.theta = r->theta, .gamma = r->theta, .h = h, .method = r->method};
    assert_int_equal(ns_march_create(r->s, &o, &r->m, NULL), NS_OK);
    assert_int_equal(ns_circuit_rest(r->c, w0), NS_OK);
    return accepted(r, ns_march_start(r->m, 0, w0));
}

void end(run *r) {
    ns_march_free(r->m);
    ns_system_free(r->s);
    ns_circuit_free(r->c);
}

int go(run *r, double t) {
    double reached;
    if (!accepted(r, ns_march_try(r->m, t, NS_TO_TIME, &reached)))
        return 0;
    assert_int_equal(ns_march_accept(r->m), NS_OK);
    return 1;
}

static double node_v(const run *r, const double *x, int node) {
    const int i = ns_circuit_node_unknown(r->c, r->node[node]);
    return i < 0 ? 0 : x[i];
}

double held(const run *r, const element *e, int k) {
    double x[256];
    assert_int_equal(ns_march_read(r->m, NULL, x, NULL, NULL), NS_OK);
    if (e[k].kind == CAP)
        return node_v(r, x, e[k].p) - node_v(r, x, e[k].n);
    return e[k].kind == IND ? x[ns_circuit_current_unknown(r->c, r->id[k])] : 0;
}

double energy(const run *r, const element *e) {
    double sum = 0;
    for (int k = 0; k < ELEMENTS; k++)
        if (e[k].kind == CAP || e[k].kind == IND)
            sum += e[k].value * held(r, e, k) * held(r, e, k) / 2;
    return sum;
}

const int straight[ELEMENTS] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10};

run plain(double roff, double theta) {
    run r = {.roff = roff, .theta = theta};
    for (int k = 0; k < NODES; k++)
        r.node[k] = k;
    return r;
}
