/* tests/rig/newton_bench.h - a model from a state on, and its jump there. */
#ifndef NEWTON_BENCH_H
#define NEWTON_BENCH_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"

static inline ns_newton *start_at(const ns_model *model, double t0, const double *x0) {
    const ns_newton_options o = {.theta = 0.5, .gamma = 0.5};
    ns_newton *s;
    assert_int_equal(ns_newton_create(model, &o, &s, NULL), NS_OK);
    assert_int_equal(ns_newton_start(s, t0, x0, NULL), NS_OK);
    return s;
}

static inline ns_newton *start(const ns_model *model, const double *x0) {
    return start_at(model, 0, x0);
}

static inline void jump(ns_newton *s, double *x, double *lambda, double *y) {
    double t0, t;
    assert_int_equal(ns_newton_read(s, &t0, NULL, NULL, NULL, NULL), NS_OK);
    assert_int_equal(ns_newton_jump(s), NS_OK);
    assert_int_equal(ns_newton_accept(s), NS_OK);
    assert_int_equal(ns_newton_read(s, &t, x, lambda, y, NULL), NS_OK);
    assert_true(t == t0);
}

#endif
