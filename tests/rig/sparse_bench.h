/* tests/rig/sparse_bench.h - a circuit and the sparse engine below the marcher. */
#ifndef SPARSE_BENCH_H
#define SPARSE_BENCH_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "sparse/guards.h"

static const double h = 1e-6; /* s */

enum { BENCH_MOST = 32 }; /* unknowns */

typedef struct bench {
    ns_circuit *c;
    ns_system *s;
    ns_sparse *m;
} bench;

static inline bench open_bench(void) {
    bench b = {0};
    assert_int_equal(ns_circuit_create(&b.c), NS_OK);
    return b;
}

/* w (BENCH_MOST): x at rest; the status of the start there. */
static inline int try_bench(bench *b, double *w) {
    const ns_sparse_options o = {.h = h};
    ns_engine *e;
    assert_int_equal(ns_circuit_system(b->c, &b->s), NS_OK);
    assert_true(b->s->n <= BENCH_MOST);
    assert_int_equal(ns_sparse_create(b->s, &o, &e, NULL), NS_OK);
    b->m = ns_sparse_of(e);
    assert_int_equal(ns_circuit_rest(b->c, w), NS_OK);
    return ns_sparse_start(e, 0, w, NULL);
}

static inline void start_bench(bench *b) {
    double w[BENCH_MOST];
    assert_int_equal(try_bench(b, w), NS_OK);
}

static inline void close_bench(bench *b) {
    ns_sparse_free(&b->m->engine);
    ns_system_free(b->s);
    ns_circuit_free(b->c);
}

#endif
