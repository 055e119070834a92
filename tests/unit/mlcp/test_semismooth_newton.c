/* tests/unit/mlcp/test_semismooth_newton.c - semismooth Newton on the Fischer-Burmeister function. */
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
    trial_closed_forms(NS_MLCP_NEWTON);
}

static void agrees_with_the_oracle(void **state) {
    (void)state;
    trial_agrees_with_the_oracle(NS_MLCP_NEWTON, CLASS_P, 200);
    trial_agrees_with_the_oracle(NS_MLCP_NEWTON, CLASS_BOXES, 100);
}

/* What has no solution ends within the bounds, unsolved. */
static void no_solution(void **state) {
    (void)state;
    trial_infeasible(NS_MLCP_NEWTON, 0);
}

/* P-matrices: every stationary point of the merit function is the answer (De Luca, Facchinei, Kanzow). */
static void matrices_that_it_is_made_for(void **state) {
    (void)state;
    assert_int_equal(trial_class(NS_MLCP_NEWTON, CLASS_P, 200, 30), 200);
    assert_int_equal(trial_class(NS_MLCP_NEWTON, CLASS_M, 200, 30), 200);
    assert_int_equal(trial_class(NS_MLCP_NEWTON, CLASS_P, 10, 150), 10);
}

/* Elsewhere it may end in a stationary point that is no answer: at least nine of ten, as measured. */
static void other_classes(void **state) {
    (void)state;
    for (int class = 0; class < CLASSES; class ++)
        assert_true(trial_class(NS_MLCP_NEWTON, class, 100, 30) >= 90);
}

/* Both a and b are 0 at the start and at the answer: W = I, q = 0 beside one pair with q = -1. */
static void a_start_at_the_kink(void **state) {
    (void)state;
    trial t = {.m = 3, .rows = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .q = {0, 0, -1}};
    trial_complementary(&t);
    t.u[1] = 1;
    assert_int_equal(trial_run(&t, NS_MLCP_NEWTON), NS_OK);
    assert_true(t.lambda[0] == 0 && t.lambda[1] == 0 && t.lambda[2] == 1);
}

/* y = (l2 - 1, -l1 + 1): H is singular where l1 = y1 ... ; solutions l = (1,1) only: l2 = 0 makes y1 = -1. */
static void a_skew_matrix(void **state) {
    (void)state;
    trial t = {.m = 2, .rows = {0, 1, -1, 0}, .q = {-1, 1}};
    trial_complementary(&t);
    assert_int_equal(trial_run(&t, NS_MLCP_NEWTON), NS_OK);
    assert_true(fabs(t.lambda[0] - 1) < 1e-14 && fabs(t.lambda[1] - 1) < 1e-14);
}

/* y = 0 lambda - 1 moves nowhere: the bound on the work is met and said. */
static void ends_within_its_bounds(void **state) {
    (void)state;
    trial t = {.m = 1, .rows = {0}, .q = {-1}, .l = {0}, .u = {INF}};
    assert_int_not_equal(trial_run(&t, NS_MLCP_NEWTON), NS_OK);
    assert_true(t.info.iterations <= 3 * 60);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_forms),  cmocka_unit_test(agrees_with_the_oracle),
        cmocka_unit_test(no_solution),   cmocka_unit_test(matrices_that_it_is_made_for),
        cmocka_unit_test(other_classes), cmocka_unit_test(a_start_at_the_kink),
        cmocka_unit_test(a_skew_matrix), cmocka_unit_test(ends_within_its_bounds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
