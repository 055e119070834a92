/* tests/unit/newton/test_hard.c - Newton's loop where it is not easy: exponentials, kinks, domains, bounds
 * met, bad input. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "callbacks.h"
#include "nonsmooth.h"

static const double one[1] = {1};

/* What a callback may be told to do. */
typedef struct mischief {
    double drive; /* of the function */
    int nan_f, nan_A, refuse;
    long calls;
} mischief;

/* 0 = (V - v)/R - Is (exp(v/Vt) - 1): a diode of SPICE's kind behind a resistor; algebraic, M = 0. */
static const double R = 1e3, Is = 1e-14, Vt = 0.02585;

static int junction_f(const ns_point *at, void *data, double *out) {
    mischief *p = data;
    p->calls++;
    out[0] = (p->drive * at->t - at->x[0]) / R - Is * (exp(at->x[0] / Vt) - 1);
    return 0;
}

static int junction_A(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = -1 / R - Is / Vt * exp(at->x[0] / Vt);
    return 0;
}

/* From 0 V to a drive of 1 kV in one step: the first correction lands at 1 kV, where exp is infinite. */
static void an_exponential_is_damped(void **state) {
    (void)state;
    mischief p = {.drive = 1e3};
    const ns_model model = {.n = 1, .M = all_0, .data = &p, .f = junction_f, .A = junction_A};
    const ns_newton_options o = {.theta = 1, .gamma = 1, .halvings = 20};
    ns_newton *s;
    double v = 0, low = 0, high = 1;
    assert_int_equal(ns_newton_create(&model, &o, &s, NULL), NS_OK);
    assert_int_equal(ns_newton_start(s, 0, &v, NULL), NS_OK);
    assert_int_equal(ns_newton_try(s, 1), NS_OK);
    assert_int_equal(ns_newton_accept(s), NS_OK);
    assert_int_equal(ns_newton_read(s, NULL, &v, NULL, NULL, NULL), NS_OK);
    for (int k = 0; k < 200; k++) { /* the root by bisection */
        const double mid = (low + high) / 2;
        *((1e3 - mid) / R > Is * (exp(mid / Vt) - 1) ? &low : &high) = mid;
    }
    const ns_newton_counts *c = ns_newton_counts_of(s);
    print_message("%ld iterations, %ld halvings, %ld calls\n", c->iterations, c->halvings, c->calls);
    assert_true(fabs(v - low) < 1e-12);
    assert_true(c->halvings > 0 && c->iterations <= 50);
    assert_int_equal(c->calls, p.calls);
    ns_newton_free(s);
}

/* x' = -|x|^(1/2) is no number below 0 and refused: log-like domains.  x = (1 - t/2)^2 until t = 2. */
static int root_f(const ns_point *at, void *data, double *out) {
    (void)data;
    if (!(at->x[0] >= 0))
        return 1;
    out[0] = -sqrt(at->x[0]);
    return 0;
}

static int root_A(const ns_point *at, void *data, double *out) {
    (void)data;
    if (!(at->x[0] > 0))
        return 1;
    out[0] = -0.5 / sqrt(at->x[0]);
    return 0;
}

/* One step from 1 to x + h sqrt(x) = 1: with s = sqrt(x), s = (sqrt(h^2 + 4) - h) / 2.  Newton's first x for
 * h = 3 is 1 - h / (1 + h/2) < 0, outside. */
static void a_refused_point_is_not_entered(void **state) {
    (void)state;
    const ns_model model = {.n = 1, .M = one, .f = root_f, .A = root_A};
    const ns_newton_options o = {.theta = 1, .gamma = 1};
    const double x0 = 1, outside = -1, h = 3;
    double x;
    ns_newton *s;
    assert_int_equal(ns_newton_create(&model, &o, &s, NULL), NS_OK);
    assert_int_equal(ns_newton_start(s, 0, &outside, NULL), NS_E_RANGE);
    assert_int_equal(ns_newton_try(s, h), NS_E_STATE);
    assert_int_equal(ns_newton_start(s, 0, &x0, NULL), NS_OK);
    assert_int_equal(ns_newton_try(s, h), NS_OK);
    assert_int_equal(ns_newton_accept(s), NS_OK);
    assert_int_equal(ns_newton_read(s, NULL, &x, NULL, NULL, NULL), NS_OK);
    assert_true(fabs(x - pow((sqrt(h * h + 4) - h) / 2, 2)) < 1e-12);
    assert_true(ns_newton_counts_of(s)->halvings > 0);
    ns_newton_free(s);
}

/* x' = x^2 from 1: x + h x^2 ... the implicit step x - h x^2 = 1 has no real root for h > 1/4. */
static int square_f(const ns_point *at, void *data, double *out) {
    const mischief *p = data;
    out[0] = p->nan_f ? NAN : at->x[0] * at->x[0];
    return p->refuse;
}

static int square_A(const ns_point *at, void *data, double *out) {
    const mischief *p = data;
    out[0] = p->nan_A ? NAN : 2 * at->x[0];
    return 0;
}

static void same_past(const ns_newton *s, double t0, double x0) {
    double t, x;
    assert_int_equal(ns_newton_read(s, &t, &x, NULL, NULL, NULL), NS_OK);
    assert_true(t == t0 && x == x0);
}

static void a_failed_step_leaves_the_past(void **state) {
    (void)state;
    mischief p = {0};
    const ns_model model = {.n = 1, .M = one, .data = &p, .f = square_f, .A = square_A};
    const double x0 = 1, h = 0.24, root = (1 - sqrt(1 - 4 * h)) / (2 * h);
    double x;
    for (int relation = 0; relation < 2; relation++) {
        const ns_newton_options o = {.theta = 1, .gamma = 1, .relation = (ns_relation)relation};
        ns_newton *s;
        assert_int_equal(ns_newton_create(&model, &o, &s, NULL), NS_OK);
        assert_int_equal(ns_newton_accept(s), NS_E_STATE);
        assert_int_equal(ns_newton_start(s, 0, &x0, NULL), NS_OK);
        assert_int_equal(ns_newton_try(s, 1), NS_DIVERGED);
        assert_int_equal(ns_newton_fault(s)->status, NS_DIVERGED);
        assert_true(ns_newton_fault(s)->t == 1);
        assert_int_equal(ns_newton_accept(s), NS_E_STATE);
        same_past(s, 0, x0);
        p.nan_A = 1;
        assert_int_equal(ns_newton_try(s, h), NS_DIVERGED);
        p = (mischief){.nan_f = 1};
        assert_int_equal(ns_newton_try(s, h), NS_DIVERGED);
        p = (mischief){.refuse = 1};
        assert_int_equal(ns_newton_try(s, h), NS_DIVERGED);
        same_past(s, 0, x0);
        p = (mischief){0};
        assert_int_equal(ns_newton_try(s, h), NS_OK);
        same_past(s, 0, x0);
        p.refuse = 1; /* a start that fails: the trial is no longer there */
        assert_int_equal(ns_newton_start(s, 7, &root, NULL), NS_E_RANGE);
        assert_int_equal(ns_newton_accept(s), NS_E_STATE);
        same_past(s, 0, x0);
        p.refuse = 0;
        assert_int_equal(ns_newton_try(s, h), NS_OK);
        assert_int_equal(ns_newton_accept(s), NS_OK);
        assert_int_equal(ns_newton_read(s, NULL, &x, NULL, NULL, NULL), NS_OK);
        assert_true(fabs(x - root) <
                    2e-11); /* 1e-12 of its terms, 3.3 in all, over the slope 1 - 2 h x = 0.2 */
        ns_newton_free(s);
    }
}

/* advance: x = 1/(1-t) to t = 1/2, where h = 1/2 does not converge: it is halved, and the answer is the
 * scheme's at steps that do.  Beyond the pole at 1 no step helps. */
static void advance_halves(void **state) {
    (void)state;
    mischief p = {0};
    const ns_model model = {.n = 1, .M = one, .data = &p, .f = square_f, .A = square_A};
    const ns_newton_options o = {.theta = 0.5, .gamma = 1};
    const double x0 = 1;
    double t, x;
    ns_newton *s;
    assert_int_equal(ns_newton_create(&model, &o, &s, NULL), NS_OK);
    assert_int_equal(ns_newton_advance(s, 1, 1), NS_E_STATE);
    assert_int_equal(ns_newton_start(s, 0, &x0, NULL), NS_OK);
    assert_int_equal(ns_newton_try(s, 0.5), NS_DIVERGED);
    assert_int_equal(ns_newton_advance(s, 0.5, 0.5), NS_OK);
    assert_int_equal(ns_newton_read(s, &t, &x, NULL, NULL, NULL), NS_OK);
    assert_true(t == 0.5 && fabs(x - 2) < 0.2); /* two or three steps of second order */
    assert_true(ns_newton_counts_of(s)->steps >= 2 && ns_newton_counts_of(s)->steps < 20);
    assert_int_equal(ns_newton_advance(s, 0.5, 0.1), NS_OK); /* there already */
    p.refuse = 1;
    assert_int_equal(ns_newton_advance(s, 0.6, 0.1), NS_DIVERGED);
    assert_int_equal(ns_newton_read(s, &t, NULL, NULL, NULL, NULL), NS_OK);
    assert_true(t == 0.5);
    const double bad[][2] = {{0.4, 0.1}, {NAN, 0.1}, {INFINITY, 0.1}, {1, 0},
                             {1, -1},    {1, NAN},   {1, INFINITY}};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
        assert_int_equal(ns_newton_advance(s, bad[k][0], bad[k][1]), NS_E_RANGE);
    assert_int_equal(ns_newton_advance(NULL, 1, 1), NS_E_NULL);
    ns_newton_free(s);
}

/* y = lambda - x^2 + 1, 0 <= y _|_ lambda >= 0 and x' = -lambda - 2 (x - 3 t): a kink on the way of every
 * step that crosses x = 1.  Checked by its own equations. */
static int kink_f(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = -2 * (at->x[0] - 3 * at->t);
    return 0;
}

static int kink_A(const ns_point *at, void *data, double *out) {
    (void)at;
    (void)data;
    out[0] = -2;
    return 0;
}

static int kink_h(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = at->lambda[0] - at->x[0] * at->x[0] + 1;
    return 0;
}

static int kink_C(const ns_point *at, void *data, double *out) {
    (void)data;
    out[0] = -2 * at->x[0];
    return 0;
}

static void kinks_are_passed(void **state) {
    (void)state;
    const ns_model model = {.n = 1,
                            .m = 1,
                            .M = one,
                            .l = all_0,
                            .u = all_infinite,
                            .f = kink_f,
                            .A = kink_A,
                            .g = give_minus_lambda,
                            .B = give_minus_1,
                            .h = kink_h,
                            .C = kink_C,
                            .D = give_1};
    const ns_newton_options o = {.theta = 1, .gamma = 1};
    const double starts[] = {-3, 0, 0.99, 1, 2}, steps[] = {1e-3, 0.1, 1, 100};
    for (int k = 0; k < 20; k++) {
        ns_newton *s;
        double x, lambda, y, r, t;
        const double x0 = starts[k % 5], h = steps[k / 5];
        assert_int_equal(ns_newton_create(&model, &o, &s, NULL), NS_OK);
        assert_int_equal(ns_newton_start(s, 0, &x0, NULL), NS_OK);
        assert_int_equal(ns_newton_try(s, h), NS_OK);
        assert_int_equal(ns_newton_accept(s), NS_OK);
        assert_int_equal(ns_newton_read(s, &t, &x, &lambda, &y, &r), NS_OK);
        const double size = fabs(x) + fabs(x0) + h * (2 * fabs(x) + 6 * h + lambda);
        assert_true(fabs(x - x0 - h * (-2 * (x - 3 * h) - lambda)) < 2e-12 * size);
        assert_true(fabs(y - (lambda - x * x + 1)) < 4e-12 * (1 + lambda + x * x));
        assert_true(y >= 0 && lambda >= 0 && y * lambda == 0 && r == -lambda && t == h);
        ns_newton_free(s);
    }
}

/* A diode straight across a source: y = -1 whatever lambda does.  No answer, at once, with its pair. */
static void no_answer_is_told(void **state) {
    (void)state;
    const ns_model model = {.n = 1,
                            .m = 1,
                            .M = one,
                            .l = all_0,
                            .u = all_infinite,
                            .f = give_0,
                            .A = give_0,
                            .g = give_0,
                            .B = give_0,
                            .h = give_minus_1,
                            .C = give_0};
    const ns_newton_options o = {.theta = 1, .gamma = 1};
    ns_newton *s;
    assert_int_equal(ns_newton_create(&model, &o, &s, NULL), NS_OK);
    assert_int_equal(ns_newton_start(s, 0, all_0, NULL), NS_OK);
    assert_int_equal(ns_newton_try(s, 1), NS_E_INFEASIBLE);
    assert_int_equal(ns_newton_fault(s)->npairs, 1);
    assert_int_equal(ns_newton_fault(s)->pair[0], 0);
    assert_true(ns_newton_counts_of(s)->problems < 40);
    same_past(s, 0, 0);
    ns_newton_free(s);
}

static void bad_input_is_refused(void **state) {
    (void)state;
    mischief p = {0};
    ns_model model = {.n = 1, .M = one, .data = &p, .f = square_f, .A = square_A};
    const ns_newton_options good = {.theta = 1, .gamma = 1};
    const double x = 1, bad = NAN;
    ns_newton *s = (ns_newton *)&p;
    ns_fault fault;
    const ns_newton_options wrong[] = {{.theta = 1.1, .gamma = 1},
                                       {.theta = -0.1, .gamma = 1},
                                       {.theta = NAN, .gamma = 1},
                                       {.theta = 1, .gamma = 0},
                                       {.theta = 1, .gamma = 1.1},
                                       {.theta = 1, .gamma = NAN},
                                       {.theta = 1, .gamma = 1, .relation = (ns_relation)7},
                                       {.theta = 1, .gamma = 1, .tolerance = -1},
                                       {.theta = 1, .gamma = 1, .tolerance = NAN},
                                       {.theta = 1, .gamma = 1, .tolerance = 1},
                                       {.theta = 1, .gamma = 1, .iterations = -1},
                                       {.theta = 1, .gamma = 1, .halvings = -1}};
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        assert_int_equal(ns_newton_create(&model, &wrong[k], &s, NULL), NS_E_RANGE);
        assert_null(s);
    }
    assert_int_equal(ns_newton_create(NULL, &good, &s, NULL), NS_E_NULL);
    assert_int_equal(ns_newton_create(&model, NULL, &s, NULL), NS_E_NULL);
    assert_int_equal(ns_newton_create(&model, &good, NULL, NULL), NS_E_NULL);
    model.A = NULL;
    assert_int_equal(ns_newton_create(&model, &good, &s, &fault), NS_E_NULL);
    assert_int_equal(fault.status, NS_E_NULL);
    model.A = square_A;
    assert_int_equal(ns_newton_create(&model, &good, &s, NULL), NS_OK);
    assert_int_equal(ns_newton_start(NULL, 0, &x, NULL), NS_E_NULL);
    assert_int_equal(ns_newton_start(s, 0, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_newton_start(s, NAN, &x, NULL), NS_E_NUMBER);
    assert_int_equal(ns_newton_start(s, 0, &bad, NULL), NS_E_NUMBER);
    p.nan_f = 1;
    assert_int_equal(ns_newton_start(s, 0, &x, NULL), NS_E_NUMBER);
    p = (mischief){.nan_A = 1};
    assert_int_equal(ns_newton_start(s, 0, &x, NULL), NS_E_NUMBER);
    p = (mischief){0};
    assert_int_equal(ns_newton_read(s, NULL, NULL, NULL, NULL, NULL), NS_E_STATE);
    assert_int_equal(ns_newton_jump(s), NS_E_STATE);
    assert_int_equal(ns_newton_start(s, 0, &x, NULL), NS_OK);
    const double lengths[] = {0, -1, NAN, INFINITY};
    for (int k = 0; k < 4; k++)
        assert_int_equal(ns_newton_try(s, lengths[k]), NS_E_RANGE);
    assert_int_equal(ns_newton_try(NULL, 1), NS_E_NULL);
    assert_int_equal(ns_newton_jump(NULL), NS_E_NULL);
    assert_int_equal(ns_newton_accept(NULL), NS_E_NULL);
    assert_int_equal(ns_newton_read(NULL, NULL, NULL, NULL, NULL, NULL), NS_E_NULL);
    ns_newton_free(s);
    ns_newton_free(NULL);
}

/* The same with hardly any damping: the whole step diverges, and shorter ones one after another do not. */
static void a_step_is_halved_until_it_converges(void **state) {
    (void)state;
    mischief p = {.drive = 1e3};
    const ns_model model = {.n = 1, .M = all_0, .data = &p, .f = junction_f, .A = junction_A};
    const ns_newton_options o = {.theta = 1, .gamma = 1, .halvings = 1};
    ns_newton *s;
    double v = 0, t, low = 0, high = 1;
    assert_int_equal(ns_newton_create(&model, &o, &s, NULL), NS_OK);
    assert_int_equal(ns_newton_start(s, 0, &v, NULL), NS_OK);
    assert_int_equal(ns_newton_try(s, 1), NS_DIVERGED);
    assert_int_equal(ns_newton_advance(s, 1, 1), NS_OK);
    assert_int_equal(ns_newton_read(s, &t, &v, NULL, NULL, NULL), NS_OK);
    for (int k = 0; k < 200; k++) {
        const double mid = (low + high) / 2;
        *((1e3 - mid) / R > Is * (exp(mid / Vt) - 1) ? &low : &high) = mid;
    }
    assert_true(t == 1 && fabs(v - low) < 1e-12);
    ns_newton_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_step_is_halved_until_it_converges),
        cmocka_unit_test(an_exponential_is_damped),
        cmocka_unit_test(a_refused_point_is_not_entered),
        cmocka_unit_test(a_failed_step_leaves_the_past),
        cmocka_unit_test(advance_halves),
        cmocka_unit_test(kinks_are_passed),
        cmocka_unit_test(no_answer_is_told),
        cmocka_unit_test(bad_input_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
