/* tests/rig/march_bench.h - a circuit with its marcher, the way a user of the library has them. */
#ifndef MARCH_BENCH_H
#define MARCH_BENCH_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth.h"

static const double pi = 3.14159265358979323846;

static inline ns_march *marcher(const ns_system *s, double theta, double gamma, double h) {
    const ns_march_options o = {.theta = theta, .gamma = gamma, .h = h, .method = NS_THETA};
    ns_march *m;
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    return m;
}

static inline void go(ns_march *m, double t) {
    double reached;
    assert_int_equal(ns_march_try(m, t, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_accept(m), NS_OK);
}

static inline double unknown(ns_march *m, int i) {
    double x[64];
    assert_int_equal(ns_march_read(m, NULL, x, NULL, NULL), NS_OK);
    return x[i];
}

/* --- a circuit with its marcher, the way a user of the library has them --- */

typedef struct bench {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
} bench;

static inline bench open_bench(void) {
    bench b = {0};
    assert_int_equal(ns_circuit_create(&b.c), NS_OK);
    return b;
}

static inline void build(bench *b, double h) {
    assert_int_equal(ns_circuit_system(b->c, &b->s), NS_OK);
    b->m = marcher(b->s, 1, 1, h);
}

static inline void start_at_rest(bench *b) {
    double w0[64];
    assert_true(b->s->n <= 64);
    assert_int_equal(ns_circuit_rest(b->c, w0), NS_OK);
    assert_int_equal(ns_march_start(b->m, 0, w0), NS_OK);
}

static inline void close_bench(bench *b) {
    ns_march_free(b->m);
    ns_system_free(b->s);
    ns_circuit_free(b->c);
}

static inline double v_of(bench *b, int node) {
    return unknown(b->m, ns_circuit_node_unknown(b->c, node));
}

static inline double i_of(bench *b, int id) {
    return unknown(b->m, ns_circuit_current_unknown(b->c, id));
}

static inline void add_step(bench *b, const char *name, int p, int n, double before, double after,
                            double at) {
    const double t[2] = {at, at}, v[2] = {before, after};
    ns_signal s = {.kind = NS_PWL};
    s.u.pwl.n = 2;
    s.u.pwl.t = t;
    s.u.pwl.v = v;
    s.u.pwl.repeat = NAN;
    assert_int_equal(ns_circuit_source(b->c, name, NS_VOLTAGE, p, n, &s, NULL), NS_OK);
}

static inline void add_dc(bench *b, const char *name, int p, int n, double v, int *id) {
    ns_signal s = {.kind = NS_DC};
    s.u.dc = v;
    assert_int_equal(ns_circuit_source(b->c, name, NS_VOLTAGE, p, n, &s, id), NS_OK);
}

static const ns_switch ideal_switch = {0.5, 0, 0, INFINITY};
static const ns_diode ideal_diode = {0, 0, INFINITY, INFINITY, 0};

#endif
