/* tests/rig/exact_bench.h - a circuit that is flown from rest on. */
#ifndef EXACT_BENCH_H
#define EXACT_BENCH_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "signals.h"

enum { MOST = 40 };
static const double pi = 3.14159265358979323846;

typedef struct bench {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    double x[MOST], lambda[MOST];
} bench;

static inline bench open_bench(void) {
    bench b = {0};
    assert_int_equal(ns_circuit_create(&b.c), NS_OK);
    return b;
}

static inline void close_bench(bench *b) {
    ns_march_free(b->m);
    ns_system_free(b->s);
    ns_circuit_free(b->c);
}

static inline int source(bench *b, const char *name, int p, int n, ns_signal s) {
    int id;
    assert_int_equal(ns_circuit_source(b->c, name, NS_VOLTAGE, p, n, &s, &id), NS_OK);
    return id;
}

static inline void start(bench *b, double h) {
    double w0[MOST];
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = h, .method = NS_EXACT};
    assert_int_equal(ns_circuit_system(b->c, &b->s), NS_OK);
    assert_true(b->s->n <= MOST && b->s->m <= MOST);
    assert_int_equal(ns_march_create(b->s, &o, &b->m, NULL), NS_OK);
    assert_int_equal(ns_circuit_rest(b->c, w0), NS_OK);
    assert_int_equal(ns_march_start(b->m, 0, w0), NS_OK);
}

static inline double go(bench *b, double t, ns_until until) {
    double reached;
    assert_int_equal(ns_march_try(b->m, t, until, &reached), NS_OK);
    assert_int_equal(ns_march_accept(b->m), NS_OK);
    assert_int_equal(ns_march_read(b->m, NULL, b->x, b->lambda, NULL), NS_OK);
    return reached;
}

static inline double v_of(const bench *b, int node) {
    return b->x[ns_circuit_node_unknown(b->c, node)];
}

/* From rest to `end` in steps of h at most: v(node) there.  *retries: of the run.  The bench is closed. */
static inline double v_at_end(bench *b, double h, double end, ns_until until, int node, long *retries) {
    start(b, h);
    for (double t = 0; t < end;)
        t = go(b, end, until);
    const double v = v_of(b, node);
    *retries = ns_march_counts(b->m)->retries;
    close_bench(b);
    return v;
}

static inline double i_of(const bench *b, int id) {
    return b->x[ns_circuit_current_unknown(b->c, id)];
}

static inline void near(double got, double expected, double tol) {
    if (!(fabs(got - expected) <= tol))
        print_message("got %.17g, expected %.17g: %g apart, %g allowed\n", got, expected,
                      fabs(got - expected), tol);
    assert_true(fabs(got - expected) <= tol);
}

#endif
