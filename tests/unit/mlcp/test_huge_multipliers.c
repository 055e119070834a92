/* tests/unit/mlcp/test_huge_multipliers.c - large lambda: answers of which no digit is left are none, others
 * are. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth/mlcp.h"
#include "nonsmooth/status.h"

#define INF INFINITY

enum { MAX = 5 };
static ns_mlcp_solver *solver;
static double lambda[MAX], y[MAX];

/* W row by row, from all lower. */
static int solve(ns_mlcp_method method, int m, const double *rows, const double *q, const double *l,
                 const double *u, ns_mlcp_info *info) {
    double W[MAX * MAX];
    ns_mode mode[MAX] = {0};
    for (int i = 0; i < m; i++) {
        mode[i] = NS_LOWER;
        for (int j = 0; j < m; j++)
            W[i + j * m] = rows[i * m + j];
    }
    const ns_mlcp p = {.m = m, .W = W, .q = q, .l = l, .u = u};
    assert_int_equal(ns_mlcp_use(solver, method), NS_OK);
    return ns_mlcp_solve(solver, &p, mode, lambda, y, info);
}

/* Of the step of a network, called solved with lambda = -6.7e16 and y_2 = 0.93.  With a, b = lambda_0,1 >= 0:
 * lambda_4 > 0 asks y_4 = 0, so a = 0.078 + 0.18 b and y_2 > 0, which must not be; without it, y_0 = 0 asks
 * lambda_3 < 0, so y_3 = 0, so b > 0 (y_2 <= 0), so lambda_2 < 0 (y_1 = 0), which makes lambda_3 = 141. */
static void a_row_is_broken_behind_large_lambda(void **state) {
    (void)state;
    static const double W[5][5] = {
        {1.111973016316, 0, -2.0715572069759998, 1.7602128366559999, -1.4374620796320001},
        {0, 1.3985122427079999, 2.2428775331599997, -3.0133337425079998, -0.46835937635600006},
        {-0.071557206975999765, 0.24287753315999994, 0, 0, 0},
        {-0.23978716334400008, 0.98666625749200021, 0, 0, 0},
        {2.5625379203679999, -0.46835937635600006, 0, 0, 0}};
    static const double q[] = {1.3265920000000002, -0.58833200000000008, 0.94002799999999986,
                               -1.2569079999999999, -0.20074399999999981};
    static const double l[] = {0, 0, -INF, -INF, 0}, u[] = {INF, INF, 0, 0, INF};
    ns_mlcp_info info;
    assert_int_equal(solve(NS_MLCP_LEMKE, 5, W[0], q, l, u, NULL), NS_E_LIMIT);
    assert_int_equal(solve(NS_MLCP_AUTO, 5, W[0], q, l, u, &info), NS_E_INFEASIBLE);
    assert_false(info.certified); /* by enumeration */
}

static const double zero[MAX], infinite[] = {INF, INF, INF, INF, INF};

/* In decimals row 2 is 0.2 times row 0 less 0.3 times row 1, so y_2 = 0.2 y_0 - 0.3 y_1 - 0.4 and y_0 >= 2,
 * lambda_0 = 0: then b = lambda_1 > 0, so y_1 = 0 and y_0 = 1/3 - c/15 < 2.  No answer; in doubles one of
 * 2e16, with y_0 = y_1 = y_2 = 0, as W is not quite singular. */
static void no_digit_is_left(void **state) {
    (void)state;
    static const double W[] = {-0.52, 0.72, -0.68, -0.88, 1.08, -0.92, 0.16, -0.18, 0.14}, q[] = {-1, -2, 0};
    for (int method = 0; method < NS_MLCP_METHODS; method++)
        assert_int_not_equal(solve((ns_mlcp_method)method, 3, W, q, zero, infinite, NULL), NS_OK);
    assert_int_equal(solve(NS_MLCP_LEMKE, 3, W, q, zero, infinite, NULL), NS_E_LIMIT);
}

/* Whether the solver's proof is v, but for its length. */
static void proof_is(int m, const double *v) {
    const double *proof = ns_mlcp_certificate(solver);
    for (int i = 0; i < m; i++)
        assert_true(proof[i] * v[0] == v[i] * proof[0]);
    assert_true(proof[0] * v[0] > 0);
}

/* y_0 + y_1 = -2^-26 for every lambda, as v = (1, 1) shows; beside lambda of 1e9 that is rounding. */
static void rounding_of_lambda_hides_what_q_lacks(void **state) {
    (void)state;
    static const double W[] = {1, -1, -1, 1}, q[] = {10, -10 - 0x1p-26}, v[] = {1, 1};
    ns_mlcp_info info;
    for (int method = 0; method < NS_MLCP_METHODS; method++)
        assert_int_not_equal(solve((ns_mlcp_method)method, 2, W, q, zero, infinite, NULL), NS_OK);
    assert_int_equal(solve(NS_MLCP_AUTO, 2, W, q, zero, infinite, &info), NS_E_INFEASIBLE);
    assert_true(info.certified);
    proof_is(2, v);
}

/* y_0 + 2 y_1 - y_2 - y_3 = 24 + 30 + 6 - 60 - 2^-20 < 0 for every lambda: of the terms of a small one
 * more than a residual may be (2^-23 is not: some BLAS let Newton end there), of 1e5 it is hidden. */
static void lambda_of_1e5_hides_it_too(void **state) {
    (void)state;
    static const double W[4][4] = {{9, -3, 0, 3}, {-3, 27, 3, 48}, {0, 3, 9, -3}, {3, 48, -3, 102}};
    static const double q[] = {24, 15, -6, 60 + 0x1p-20}, v[] = {1, 2, -1, -1};
    static const double l[] = {0, 0, -INF, -INF}, u[] = {INF, INF, 2, 2};
    ns_mlcp_info info;
    for (int method = 0; method < NS_MLCP_METHODS; method++)
        assert_int_not_equal(solve((ns_mlcp_method)method, 4, W[0], q, l, u, NULL), NS_OK);
    assert_int_equal(solve(NS_MLCP_AUTO, 4, W[0], q, l, u, &info), NS_E_INFEASIBLE);
    assert_true(info.certified);
    proof_is(4, v);
}

/* y_0 + y_1 = 2^-46 b - 2^-26 = 0: b = 2^20, a = b - 10.  In a sum of rounded terms v = (1, 1) seems a proof,
 * as 2^-46 is 1e-14 of its terms; the answer takes it at its word. */
static void what_remains_of_a_sum_times_lambda_makes_up_for_it(void **state) {
    (void)state;
    static const double W[] = {1, -1, -1, 1 + 0x1p-46}, q[] = {10, -10 - 0x1p-26};
    assert_int_equal(solve(NS_MLCP_LEMKE, 2, W, q, zero, infinite, NULL), NS_OK);
    assert_true(fabs(lambda[0] - 1048566) <= 1 && fabs(lambda[1] - lambda[0] - 10) <= 1e-7);
    assert_int_equal(solve(NS_MLCP_AUTO, 2, W, q, zero, infinite, NULL), NS_OK);
    assert_true(fabs(lambda[1] - lambda[0] - 10) <= 1e-7);
}

/* lambda = 1 / 1e-15; then with 1e-15 where each row has terms of 1 besides: a = (2 + b) / 1e-15, c = 1. */
static void all_digits_are_left(void **state) {
    (void)state;
    static const double one[] = {1e-15}, by[] = {-1};
    assert_int_equal(solve(NS_MLCP_AUTO, 1, one, by, zero, infinite, NULL), NS_OK);
    assert_true(fabs(lambda[0] * 1e-15 - 1) <= 1e-14);
    static const double W[] = {1e-15, -1, 0, 0, 1, 0, 0, 0, 1}, q[] = {-2, -3, -1};
    assert_int_equal(solve(NS_MLCP_AUTO, 3, W, q, zero, infinite, NULL), NS_OK);
    assert_true(fabs(lambda[0] * 1e-15 - 5) <= 1e-14);
}

/* a = 1e14 beside b + c = 1 twice over, which leaves their difference open. */
static void redundant_equations_beside_large_lambda(void **state) {
    (void)state;
    static const double W[] = {1e-14, 0, 0, 0, 1, 1, 0, 1, 1}, q[] = {-1, -1, -1};
    static const double l[] = {0, -INF, -INF};
    assert_int_equal(solve(NS_MLCP_AUTO, 3, W, q, l, infinite, NULL), NS_OK);
    assert_true(fabs(lambda[0] * 1e-14 - 1) <= 1e-14);
    assert_true(fabs(lambda[1] + lambda[2] - 1) <= 1e-14);
}

/* From above: 2 a = 14 (y_3 = 0), 2 b = a + 1, 2 c = 5 b; then y_2 = 0.  With d, which is open and enters y_4
 * alone, at 1.6e10 the interior point had a, b, c wrong by 1e-8 of the terms of their rows. */
static void a_large_lambda_of_another_row_hides_nothing(void **state) {
    (void)state;
    static const double W[5][5] = {
        {1, -2, 0, 0, 0}, {0, 5, -2, 0, 0}, {-10, 0, 7, 0, 0}, {-2, 0, 0, 0, 0}, {-3, 0, 3, -10, 0}};
    static const double q[] = {1, 0, 0, 14, 21}, l[] = {0, 0, 0, -INF, 0}, u[] = {INF, INF, INF, INF, 1};
    assert_int_equal(solve(NS_MLCP_AUTO, 5, W[0], q, l, u, NULL), NS_OK);
    assert_true(fabs(lambda[0] - 7) <= 1e-13 && fabs(lambda[1] - 4) <= 1e-13);
    assert_true(fabs(lambda[2] - 10) <= 1e-13);
}

/* With a < u_0, y_3 = a / 2^23 - q_3 < 0 asks d = u_3, so y_0 <= 1.14 u_0 - 1.90 u_3 - 37480 < -7000 asks
 * a = u_0.  That it is, where y_3 = 0; found was a < u_0 with y_0 = -12000, behind lambda_1 = 2.7e18, whose
 * column has one entry. */
static void nor_do_large_bounds(void **state) {
    (void)state;
    static const double W[4][4] = {
        {1.143768310546875, 0, -16, -1.901123046875}, {0, 0, 0, 0}, {0, 0.5, -0.0625, 0}, {0x1p-23, 0, 0, 0}};
    static const double q[] = {-37480.5, 0, -27.5205078125, -60.83984375};
    static const double u[] = {510361600, INF, INF, 307032064};
    assert_int_equal(solve(NS_MLCP_AUTO, 4, W[0], q, zero, u, NULL), NS_OK);
    assert_true(lambda[0] == u[0]);
    assert_true(y[0] <= 0);
    const double y0 = W[0][0] * lambda[0] + W[0][2] * lambda[2] + W[0][3] * lambda[3] + q[0];
    assert_true(fabs(y[0] - y0) <= 1e-5); /* terms of 6e8 */
}

static int setup(void **state) {
    (void)state;
    return ns_mlcp_create(MAX, &solver);
}

static int teardown(void **state) {
    (void)state;
    ns_mlcp_free(solver);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_row_is_broken_behind_large_lambda, setup, teardown),
        cmocka_unit_test_setup_teardown(no_digit_is_left, setup, teardown),
        cmocka_unit_test_setup_teardown(rounding_of_lambda_hides_what_q_lacks, setup, teardown),
        cmocka_unit_test_setup_teardown(lambda_of_1e5_hides_it_too, setup, teardown),
        cmocka_unit_test_setup_teardown(what_remains_of_a_sum_times_lambda_makes_up_for_it, setup, teardown),
        cmocka_unit_test_setup_teardown(all_digits_are_left, setup, teardown),
        cmocka_unit_test_setup_teardown(redundant_equations_beside_large_lambda, setup, teardown),
        cmocka_unit_test_setup_teardown(a_large_lambda_of_another_row_hides_nothing, setup, teardown),
        cmocka_unit_test_setup_teardown(nor_do_large_bounds, setup, teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
