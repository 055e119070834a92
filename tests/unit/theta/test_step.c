/* tests/unit/theta/test_step.c - the theta-gamma step against its own formula and against closed forms. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "formula.h"
#include "linalg/dense.h"
#include "systems.h"
#include "wrap_alloc.h"

static ns_theta *stepper(const ns_system *s, double theta, double gamma) {
    const ns_theta_options o = {theta, gamma, 0};
    ns_theta *t;
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
    return t;
}

static void advance(ns_theta *t, double h, const double *z, ns_policy policy) {
    assert_int_equal(ns_theta_try(t, h, z, 0, policy), NS_OK);
    assert_int_equal(ns_theta_accept(t), NS_OK);
}

/* x' = -x: the scheme multiplies by (1 - (1-theta) h) / (1 + theta h) a step.  For theta < 1 the start has no
 * slope yet (ns_theta_start), so one implicit step of negligible length finds it. */
static void growth_factor_is_that_of_the_scheme(void **state) {
    (void)state;
    const double thetas[] = {1, 0.75, 0.5, 0.3, 0}, h = 0.1, w0 = 1;
    for (int k = 0; k < 5; k++) {
        ns_system *s = system_decay();
        ns_theta *t = stepper(s, thetas[k], 1);
        assert_int_equal(ns_theta_start(t, &w0, NULL), NS_OK);
        assert_int_equal(ns_theta_try(t, 1e-18, NULL, 1, NS_HOLD), NS_OK);
        assert_int_equal(ns_theta_accept(t), NS_OK);
        for (int i = 0; i < 50; i++)
            advance(t, h, NULL, NS_HOLD);
        double x;
        assert_int_equal(ns_theta_read(t, &x, NULL, NULL), NS_OK);
        const double factor = (1 - (1 - thetas[k]) * h) / (1 + thetas[k] * h);
        assert_true(fabs(x / pow(factor, 50) - 1) < 1e-13); /* 50 steps of a few eps each */
        ns_theta_free(t);
        ns_system_free(s);
    }
}

/* --- (T1)(T6)(T7)(P1) literally, on a random system with regular M and one guard each way --- */

enum { N = FORMULA_N, P = FORMULA_P, Z = FORMULA_Z };

static void steps_follow_the_formula(void **state) {
    (void)state;
    const double values[] = {0.2, 0.5, 0.8, 1}, explicit_too[] = {0, 0.5, 0.8, 1};
    for (int run = 0; run < 64; run++) {
        dice d = dice_make(1234, (unsigned)run);
        ns_system *s = formula_system(&d);
        const double th = (run < 32 ? values : explicit_too)[run % 4], ga = values[run / 4 % 4], h = 0.1;
        ns_theta *t = stepper(s, th, ga);
        double w0[N], x[N], lambda[P];
        for (int i = 0; i < N; i++)
            w0[i] = dice_either(&d);
        const formula_scheme scheme = {h, th, ga, NS_RELATION_END};
        formula_inputs z = {.end = {dice_either(&d), dice_either(&d)}};
        formula_point p;
        assert_int_equal(ns_theta_start(t, w0, NULL), NS_OK);
        assert_int_equal(ns_theta_try(t, 1e-18, z.end, 1, NS_RESOLVE), NS_OK);
        assert_int_equal(ns_theta_accept(t), NS_OK);
        assert_int_equal(ns_theta_read(t, p.x, p.lambda, NULL), NS_OK);
        for (int step = 0; step < 20; step++) {
            memcpy(z.before, z.end, sizeof z.end);
            for (int i = 0; i < Z; i++)
                z.end[i] = z.relation[i] = dice_either(&d);
            formula_step(s, &scheme, &p, &z, &p, NULL);
            advance(t, h, z.end, NS_RESOLVE);
            assert_int_equal(ns_theta_read(t, x, lambda, NULL), NS_OK);
            for (int i = 0; i < N; i++)
                assert_true(fabs(x[i] - p.x[i]) < 1e-12 * (1 + fabs(p.x[i]))); /* 20 steps of some ten eps */
            for (int i = 0; i < P; i++)
                assert_true(fabs(lambda[i] - p.lambda[i]) < 1e-12 * (1 + fabs(p.lambda[i])));
        }
        ns_theta_free(t);
        ns_system_free(s);
    }
}

/* --- observed order on the LC bridge while the first mode stands (v > 0 until a quarter period, 157 us) ---
 */

static double error_at_100us(double theta, double gamma, int steps) {
    ns_system *s = system_lc_bridge();
    ns_theta *t = stepper(s, theta, gamma);
    const double w0[2] = {1e-6 * 10, 0}, end = 100e-6;
    double x[2];
    assert_int_equal(ns_theta_start(t, w0, NULL), NS_OK);
    assert_int_equal(ns_theta_try(t, 1e-18, NULL, 1, NS_RESOLVE), NS_OK);
    assert_int_equal(ns_theta_accept(t), NS_OK);
    for (int i = 0; i < steps; i++)
        advance(t, end / steps, NULL, NS_HOLD);
    assert_int_equal(ns_theta_read(t, x, NULL, NULL), NS_OK);
    ns_theta_free(t);
    ns_system_free(s);
    return fabs(x[0] - lc_bridge_v(10, end));
}

static void order_in_a_mode(void **state) {
    (void)state;
    const struct { double theta, gamma, order; } cases[] = {{1, 1, 1}, {0.5, 0.5, 2}, {0.75, 0.75, 1}};
    for (int k = 0; k < 3; k++) {
        const double e1 = error_at_100us(cases[k].theta, cases[k].gamma, 200);
        const double e2 = error_at_100us(cases[k].theta, cases[k].gamma, 400);
        const double order = log2(e1 / e2);
        print_message("theta %.2f gamma %.2f: error %.2e V, order %.3f\n", cases[k].theta, cases[k].gamma, e2,
                      order);
        assert_true(fabs(order - cases[k].order) <
                    0.05); /* next term of the error: O(h) = 1/200 of it, times a few */
    }
}

static void nothing_is_factored_while_the_mode_stands(void **state) {
    (void)state;
    ns_system *s = system_lc_bridge();
    ns_theta *t = stepper(s, 1, 1);
    const double w0[2] = {1e-6 * 10, 0};
    assert_int_equal(ns_theta_start(t, w0, NULL), NS_OK);
    advance(t, 1e-6, NULL, NS_RESOLVE);
    advance(t, 1e-6, NULL, NS_HOLD);
    const ns_counts before = *ns_theta_counts(t);
    for (int i = 0; i < 100; i++)
        advance(t, 1e-6, NULL, NS_HOLD);
    const ns_counts *after = ns_theta_counts(t);
    assert_int_equal(after->steps - before.steps, 100);
    assert_int_equal(after->factors, before.factors);
    assert_int_equal(after->maps, before.maps);
    assert_int_equal(after->pivots, before.pivots);
    assert_int_equal(after->problems, before.problems);
    ns_theta_free(t);
    ns_system_free(s);
}

static void a_broken_guard_is_told_and_the_past_left_alone(void **state) {
    (void)state;
    ns_system *s = system_lc_bridge();
    ns_theta *t = stepper(s, 0.5, 0.5);
    const double w0[2] = {1e-6 * 10, 0};
    double before[2], after[2];
    assert_int_equal(ns_theta_start(t, w0, NULL), NS_OK);
    assert_int_equal(ns_theta_accept(t), NS_E_STATE);
    assert_int_equal(ns_theta_read(t, before, NULL, NULL), NS_E_STATE);
    advance(t, 1e-6, NULL, NS_RESOLVE);
    assert_int_equal(ns_theta_read(t, before, NULL, NULL), NS_OK);
    assert_int_equal(ns_theta_try(t, 300e-6, NULL, 0, NS_HOLD), NS_GUARD); /* v < 0 there */
    assert_int_equal(ns_theta_accept(t), NS_E_STATE);
    assert_int_equal(ns_theta_try(t, -1, NULL, 0, NS_HOLD), NS_E_RANGE);
    assert_int_equal(ns_theta_try(t, NAN, NULL, 0, NS_HOLD), NS_E_RANGE);
    assert_int_equal(ns_theta_read(t, after, NULL, NULL), NS_OK);
    assert_memory_equal(before, after, sizeof before);
    assert_int_equal(ns_theta_try(t, 300e-6, NULL, 0, NS_RESOLVE), NS_OK);
    assert_int_equal(ns_theta_accept(t), NS_OK);
    assert_int_equal(ns_theta_read(t, after, NULL, NULL), NS_OK);
    assert_true(after[0] < 0);
    ns_theta_free(t);
    ns_system_free(s);
}

static void saved_points_come_back_bit_by_bit(void **state) {
    (void)state;
    ns_system *s = system_lc_bridge();
    ns_theta *t = stepper(s, 0.5, 0.75);
    const double w0[2] = {1e-6 * 10, 1e-5};
    assert_int_equal(ns_theta_start(t, w0, NULL), NS_OK);
    for (int i = 0; i < 40; i++)
        advance(t, 5e-6, NULL, NS_RESOLVE);
    double *past = malloc(sizeof(double) * ns_theta_past_size(t)), x1[2], x2[2], l1[4], l2[4], y1[4], y2[4];
    assert_non_null(past);
    ns_theta_save(t, past);
    for (int i = 0; i < 200; i++)
        advance(t, 5e-6, NULL, NS_RESOLVE);
    assert_int_equal(ns_theta_read(t, x1, l1, y1), NS_OK);
    ns_theta_restore(t, past);
    for (int i = 0; i < 200; i++)
        advance(t, 5e-6, NULL, NS_RESOLVE);
    assert_int_equal(ns_theta_read(t, x2, l2, y2), NS_OK);
    assert_memory_equal(x1, x2, sizeof x1);
    assert_memory_equal(l1, l2, sizeof l1);
    assert_memory_equal(y1, y2, sizeof y1);
    free(past);
    ns_theta_free(t);
    ns_system_free(s);
}

/* The bound on kept maps costs time, never an answer. */
static void few_kept_maps_give_the_same_answer(void **state) {
    (void)state;
    double x[2][2];
    for (int small = 0; small < 2; small++) {
        ns_system *s = system_lc_bridge();
        const ns_theta_options o = {1, 1, small ? 1 : 0};
        ns_theta *t;
        const double w0[2] = {1e-6 * 10, 0};
        assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
        assert_int_equal(ns_theta_start(t, w0, NULL), NS_OK);
        for (int i = 0; i < 300; i++)
            advance(t, i % 3 ? 5e-6 : 2e-6, NULL, NS_RESOLVE);
        assert_int_equal(ns_theta_read(t, x[small], NULL, NULL), NS_OK);
        assert_int_equal(ns_theta_counts(t)->evicted > 100, small);
        ns_theta_free(t);
        ns_system_free(s);
    }
    assert_memory_equal(x[0], x[1], sizeof x[0]);
}

static void bad_input_is_refused(void **state) {
    (void)state;
    ns_system *s = system_decay();
    ns_theta *t = (ns_theta *)s;
    const double bad[] = {-1, 1.5, NAN, INFINITY, 0}, inf = INFINITY;
    for (int k = 0; k < 5; k++) { /* theta may be 0, gamma not */
        const ns_theta_options th = {k < 4 ? bad[k] : 1.1, 1, 0}, ga = {1, bad[k], 0};
        assert_int_equal(ns_theta_create(s, &th, &t, NULL), NS_E_RANGE);
        assert_null(t);
        assert_int_equal(ns_theta_create(s, &ga, &t, NULL), NS_E_RANGE);
    }
    const ns_theta_options o = {1, 1, 0};
    assert_int_equal(ns_theta_create(NULL, &o, &t, NULL), NS_E_NULL);
    assert_int_equal(ns_theta_create(s, NULL, &t, NULL), NS_E_NULL);
    assert_int_equal(ns_theta_create(s, &o, NULL, NULL), NS_E_NULL);
    s->A[0] = NAN;
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_E_NUMBER);
    s->A[0] = -1;
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
    assert_int_equal(ns_theta_start(t, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_theta_start(t, &inf, NULL), NS_E_NUMBER);
    assert_int_equal(ns_theta_try(NULL, 1, NULL, 0, NS_HOLD), NS_E_NULL);
    ns_theta_free(t);
    ns_theta_free(NULL);
    ns_system_free(s);
}

/* x' = x with a step of theta h = 1: W is singular, no number comes out. */
static void a_singular_step_is_told(void **state) {
    (void)state;
    ns_system *s = system_decay();
    const double w0 = 1;
    s->A[0] = 1;
    ns_theta *t = stepper(s, 1, 1);
    assert_int_equal(ns_theta_start(t, &w0, NULL), NS_OK);
    const int status = ns_theta_try(t, 1, NULL, 0, NS_RESOLVE);
    assert_true(status == NS_E_SINGULAR || status == NS_E_INFEASIBLE);
    assert_int_equal(ns_theta_fault(t)->status, status);
    ns_theta_free(t);
    ns_system_free(s);
}

static void growth_beyond_double_is_told(void **state) {
    (void)state;
    ns_system *s = system_decay();
    const double w0 = 1;
    s->A[0] = 1;
    ns_theta *t = stepper(s, 1, 1);
    assert_int_equal(ns_theta_start(t, &w0, NULL), NS_OK);
    int status = NS_OK;
    for (int i = 0; i < 2000 && status == NS_OK; i++) { /* a factor of 2 a step: beyond 2^1024 */
        status = ns_theta_try(t, 0.5, NULL, 0, NS_HOLD);
        if (status == NS_OK)
            ns_theta_accept(t);
    }
    assert_int_equal(status, NS_E_OVERFLOW);
    ns_theta_free(t);
    ns_system_free(s);
}

static void every_allocation_may_fail(void **state) {
    (void)state;
    ns_system *s = system_lc_bridge();
    const ns_theta_options o = {1, 1, 0};
    const double w0[2] = {1e-6 * 10, 0};
    for (long k = 1;; k++) {
        ns_theta *t;
        fail_alloc_at(k);
        int status = ns_theta_create(s, &o, &t, NULL);
        if (status == NS_OK) {
            status = ns_theta_start(t, w0, NULL);
            for (int i = 0; i < 3 && status == NS_OK; i++) {
                status = ns_theta_try(t, 1e-6, NULL, 0, NS_RESOLVE);
                if (status == NS_OK)
                    status = ns_theta_accept(t);
            }
        }
        const long made = allocs_made();
        fail_alloc_off();
        ns_theta_free(t);
        if (made < k)
            break;
        assert_int_equal(status, NS_E_MEMORY);
        assert_true(k < 1000);
    }
    ns_system_free(s);
}

/* x = 1e200 V is a number, y = 1e200 x is none: its pair is named, if y is asked for. */
static void y_beyond_double_is_told(void **state) {
    const double w0 = 1e200;
    ns_system *s;
    double x, lambda, y;
    (void)state;
    assert_int_equal(ns_system_create(1, 1, 0, 0, &s), NS_OK);
    s->M[0] = 1;
    s->C[0] = 1e200;
    ns_theta *t = stepper(s, 1, 1);
    assert_int_equal(ns_theta_start(t, &w0, NULL), NS_OK);
    advance(t, 1, NULL, NS_HOLD);
    assert_int_equal(ns_theta_read(t, &x, &lambda, NULL), NS_OK);
    assert_true(x == 1e200 && lambda == 0);
    assert_int_equal(ns_theta_read(t, &x, &lambda, &y), NS_E_OVERFLOW);
    assert_int_equal(ns_theta_fault(t)->npairs, 1);
    assert_int_equal(ns_theta_fault(t)->pair[0], 0);
    assert_int_equal(ns_theta_fault(t)->nunknowns, 0);
    ns_theta_free(t);
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(growth_factor_is_that_of_the_scheme),
        cmocka_unit_test(steps_follow_the_formula),
        cmocka_unit_test(order_in_a_mode),
        cmocka_unit_test(nothing_is_factored_while_the_mode_stands),
        cmocka_unit_test(a_broken_guard_is_told_and_the_past_left_alone),
        cmocka_unit_test(saved_points_come_back_bit_by_bit),
        cmocka_unit_test(few_kept_maps_give_the_same_answer),
        cmocka_unit_test(bad_input_is_refused),
        cmocka_unit_test(a_singular_step_is_told),
        cmocka_unit_test(growth_beyond_double_is_told),
        cmocka_unit_test(y_beyond_double_is_told),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
