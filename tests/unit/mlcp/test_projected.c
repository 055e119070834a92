/* tests/unit/mlcp/test_projected.c - projected Gauss-Seidel. */
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
    trial_closed_forms(NS_MLCP_PROJECTED);
}

static void agrees_with_the_oracle(void **state) {
    (void)state;
    trial_agrees_with_the_oracle(NS_MLCP_PROJECTED, CLASS_P, 200);
    trial_agrees_with_the_oracle(NS_MLCP_PROJECTED, CLASS_BOXES, 100);
}

/* What has no solution ends within the bounds, unsolved. */
static void no_solution(void **state) {
    (void)state;
    trial_infeasible(NS_MLCP_PROJECTED, 0);
}

/* M-matrices and dominant diagonals; of the class M those with a zero diagonal are refused (floating parts of
 * one node). */
static void matrices_that_it_is_made_for(void **state) {
    (void)state;
    assert_true(trial_class(NS_MLCP_PROJECTED, CLASS_P, 200, 30) >= 195); /* not all of them are dominant */
    assert_true(trial_class(NS_MLCP_PROJECTED, CLASS_M, 200, 30) >= 194);
}

/* Half of the networks have rows without a diagonal. */
static void other_classes(void **state) {
    (void)state;
    for (int class = 0; class < CLASSES; class ++)
        assert_true(trial_class(NS_MLCP_PROJECTED, class, 100, 30) >= 30);
}

/* The discrete Laplacian of n points between walls, pushed by q = -1: W = tridiag(-1, 2, -1), lambda_i =
 * i (n+1-i) / 2 > 0.  Gauss-Seidel's rate is cos^2(pi/(n+1)), 0.98: hundreds of sweeps without crossover. */
static void obstacle(void **state) {
    (void)state;
    trial t = {.m = 19};
    for (int i = 0; i < t.m; i++) {
        t.q[i] = -1;
        t.rows[i * t.m + i] = 2;
        if (i > 0)
            t.rows[i * t.m + i - 1] = t.rows[(i - 1) * t.m + i] = -1;
    }
    trial_complementary(&t);
    assert_int_equal(trial_run(&t, NS_MLCP_PROJECTED), NS_OK);
    for (int i = 0; i < t.m; i++) /* 50: the largest; condition 160 */
        assert_true(fabs(t.lambda[i] - (i + 1) * (t.m - i) / 2.0) <= 50 * 160 * 1e-15);
    assert_true(t.info.iterations <= 64);
}

/* y = (l1 + l2 - 1, 2 - l1): an ideal device has no diagonal, solved by l = (1,0).  With y2 = 2 - l2 the
 * second pair's has the wrong sign.  Both are refused; 1 on the diagonal is not. */
static void no_diagonal(void **state) {
    (void)state;
    trial t = {.m = 2, .rows = {1, 1, -1, 0}, .q = {-1, 2}};
    trial_complementary(&t);
    assert_int_equal(trial_run(&t, NS_MLCP_PROJECTED), NS_E_SINGULAR);
    t.rows[2] = 0;
    t.rows[3] = -1;
    assert_int_equal(trial_run(&t, NS_MLCP_PROJECTED), NS_E_SINGULAR);
    t.rows[3] = 1;
    assert_int_equal(trial_run(&t, NS_MLCP_PROJECTED), NS_OK);
}

/* y = (l1 - 10 l2 - 1, -10 l1 + l2 - 1): every sweep makes both a hundred times larger.  (Nor is there an
 * answer: y1 + y2 = -9 (l1 + l2) - 2.) */
static void divergence_is_noticed(void **state) {
    (void)state;
    trial t = {.m = 2, .rows = {1, -10, -10, 1}, .q = {-1, -1}};
    trial_complementary(&t);
    assert_int_not_equal(trial_run(&t, NS_MLCP_PROJECTED), NS_OK);
    assert_true(t.info.iterations <= 64);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_forms),  cmocka_unit_test(agrees_with_the_oracle),
        cmocka_unit_test(no_solution),   cmocka_unit_test(matrices_that_it_is_made_for),
        cmocka_unit_test(other_classes), cmocka_unit_test(obstacle),
        cmocka_unit_test(no_diagonal),   cmocka_unit_test(divergence_is_noticed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
