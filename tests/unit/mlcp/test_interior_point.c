/* tests/unit/mlcp/test_interior_point.c - the interior point method. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "trials.h"

#define INF INFINITY

static void closed_forms(void **state) {
    (void)state;
    trial_closed_forms(NS_MLCP_INTERIOR);
}

static void agrees_with_the_oracle(void **state) {
    (void)state;
    trial_agrees_with_the_oracle(NS_MLCP_INTERIOR, CLASS_P, 200);
    trial_agrees_with_the_oracle(NS_MLCP_INTERIOR, CLASS_BOXES, 100);
}

/* What has no solution ends within the bounds, unsolved. */
static void no_solution(void **state) {
    (void)state;
    trial_infeasible(NS_MLCP_INTERIOR, 0);
}

/* Monotone problems are what it is made for.  P-matrices need not be monotone; these are solved all the same.
 */
static void matrices_that_it_is_made_for(void **state) {
    (void)state;
    assert_int_equal(trial_class(NS_MLCP_INTERIOR, CLASS_P, 200, 30), 200);
    assert_int_equal(trial_class(NS_MLCP_INTERIOR, CLASS_M, 200, 30), 200);
    assert_int_equal(trial_class(NS_MLCP_INTERIOR, CLASS_DEGENERATE, 200, 30), 200);
    assert_int_equal(trial_class(NS_MLCP_INTERIOR, CLASS_BOXES, 200, 30), 200);
    assert_int_equal(trial_class(NS_MLCP_INTERIOR, CLASS_BOXES, 10, 150), 10);
}

/* Copositive-plus is not monotone; networks over thirty decades lose what the answer rests on. */
static void other_classes(void **state) {
    (void)state;
    for (int class = 0; class < CLASSES; class ++)
        assert_true(trial_class(NS_MLCP_INTERIOR, class, 100, 30) >= 97);
}

/* Every pair with lambda = y = 0: slacks and multipliers go to 0 together, and the crossover must end it. */
static void all_tie(void **state) {
    (void)state;
    trial t = {.m = 12};
    for (int i = 0; i < t.m; i++)
        for (int j = 0; j < t.m; j++)
            t.rows[i * t.m + j] = 1;
    trial_complementary(&t);
    assert_int_equal(trial_run(&t, NS_MLCP_INTERIOR), NS_OK);
    for (int i = 0; i < t.m; i++)
        assert_true(t.lambda[i] == 0 && t.y[i] == 0);
}

/* Two closed ideal switches in parallel carry 1 A: v = 0 twice, i1 + i2 = 1. */
static void redundant_equalities(void **state) {
    (void)state;
    trial t = {.m = 3,
               .rows = {0, 1, 1, -1, 0, 0, -1, 0, 0},
               .q = {-1, 0, 0},
               .l = {-INF, -INF, -INF},
               .u = {INF, INF, INF}};
    assert_int_equal(trial_run(&t, NS_MLCP_INTERIOR), NS_OK);
    assert_true(fabs(t.lambda[1] + t.lambda[2] - 1) < 1e-10); /* the residual that is accepted */
    assert_true(fabs(t.lambda[0]) < 1e-10);
}

/* y = 0 lambda - 1: multipliers grow without end, which is noticed. */
static void divergence_is_noticed(void **state) {
    (void)state;
    trial t = {.m = 1, .rows = {0}, .q = {-1}, .l = {0}, .u = {INF}};
    assert_int_not_equal(trial_run(&t, NS_MLCP_INTERIOR), NS_OK);
    assert_true(t.info.iterations <= 100);
}

/* W = tridiag(-1, 2.1, -1) + skew part, so x'Wx >= 0.1 x'x: monotone, one answer, of which q is made; a third
 * of the pairs conducts, a third blocks, a third does neither nor (both 0).  Condition below 50, 300 terms of
 * size 1. */
static void three_hundred_pairs(void **state) {
    enum { M = 300 };
    static double W[M * M], q[M], l[M], u[M], lambda[M], y[M];
    static ns_mode mode[M];
    ns_mlcp p = {.m = M, .W = W, .q = q, .l = l, .u = u};
    ns_mlcp_info info;
    ns_mlcp_solver *s;
    (void)state;
    for (int i = 0; i < M; i++) {
        W[i + i * M] = 2.1;
        if (i > 0)
            W[i + (i - 1) * M] = W[i - 1 + i * M] = -1;
        if (i >= 7) {
            W[i + (i - 7) * M] = 0.5;
            W[i - 7 + i * M] = -0.5;
        }
        u[i] = INF;
        q[i] = i % 3 == 1 ? 1 : 0;
    }
    for (int j = 0; j < M; j += 3)
        for (int i = 0; i < M; i++)
            q[i] -= W[i + j * M];
    assert_int_equal(ns_mlcp_create(M, &s), NS_OK);
    assert_int_equal(ns_mlcp_use(s, NS_MLCP_INTERIOR), NS_OK);
    assert_int_equal(ns_mlcp_solve(s, &p, mode, lambda, y, &info), NS_OK);
    assert_true(info.iterations <= 30);
    for (int i = 0; i < M; i++)
        assert_true(fabs(lambda[i] - (i % 3 == 0)) <= 1e-12);
    ns_mlcp_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_forms),         cmocka_unit_test(agrees_with_the_oracle),
        cmocka_unit_test(no_solution),          cmocka_unit_test(matrices_that_it_is_made_for),
        cmocka_unit_test(other_classes),        cmocka_unit_test(all_tie),
        cmocka_unit_test(redundant_equalities), cmocka_unit_test(divergence_is_noticed),
        cmocka_unit_test(three_hundred_pairs),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
