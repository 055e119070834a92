/* tests/unit/mlcp/test_narrow_boxes.c - boxes narrower than rounding of lambda: y and mode must still be
 * those of lambda.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth/mlcp.h"
#include "nonsmooth/status.h"

enum { MAX = 7 };
static ns_mlcp_solver *solver;
static double W[MAX * MAX], lambda[MAX], y[MAX];
static ns_mode mode[MAX];

/* W row by row; the start: digits of k to base 3. */
static int solve(ns_mlcp_method method, const ns_mlcp *p, const double *rows, int k) {
    ns_mlcp q = *p;
    q.W = W;
    for (int i = 0; i < p->m; i++, k /= 3) {
        mode[i] = (ns_mode)(k % 3 - 1);
        for (int j = 0; j < p->m; j++)
            W[i + j * p->m] = rows[i * p->m + j];
    }
    assert_int_equal(ns_mlcp_use(solver, method), NS_OK);
    return ns_mlcp_solve(solver, &q, mode, lambda, y, NULL);
}

/* With lambda_0 = -3 + (0 or w), lambda_1 = (0 or w), w = 2^-37: y_0 = -61 < 0 and y_1 = 7 > 0 but for 18 w
 * at most.  So lambda_0 = -3 + w, lambda_1 = 0, y_0 = -61 + 18 w, y_1 = 7 - 3 w. */
static void y_of_two_boxes(void **state) {
    (void)state;
    static const double rows[] = {18, -3, -3, 13}, q[] = {-7, -2};
    static const double w = 0x1p-37, l[] = {-3, 0}, u[] = {-3 + 0x1p-37, 0x1p-37};
    const ns_mlcp p = {.m = 2, .q = q, .l = l, .u = u};
    for (int method = 0; method < NS_MLCP_METHODS; method++)
        for (int k = 0; k < 9; k++) {
            assert_int_equal(solve((ns_mlcp_method)method, &p, rows, k), NS_OK);
            assert_true(lambda[0] == u[0] && lambda[1] == 0.0);
            assert_int_equal(mode[0], NS_UPPER);
            assert_int_equal(mode[1], NS_LOWER);
            assert_true(fabs(y[0] - (-61 + 18 * w)) <= 1e-13); /* a sum of terms of 54: 1e-14 */
            assert_true(fabs(y[1] - (7 - 3 * w)) <= 1e-13);
        }
}

/* W = -W'.  At lambda = l, y = (0, 6, -8, 0, -3, 7, -6) but for 1e-11 in q, and lambda in its boxes of 1e-12
 * changes that by 1e-11 at most. */
static void y_of_seven_boxes(void **state) {
    (void)state;
    static const double rows[7][7] = {
        {0, 0, -1, 0, 0, -1, 6}, {0, 0, 0, -5, -5, 0, 0}, {1, 0, 0, 0, -4, 0, 2}, {0, 5, 0, 0, 0, 0, 0},
        {0, 5, 4, 0, 0, -9, 0},  {1, 0, 0, 0, 9, 0, -2},  {-6, 0, -2, 0, 0, 2, 0}};
    static const double q[] = {-1.0000000000045475, 21.000000000008527, -7.999999999998295, 20.0,
                               -18.000000000003638, 6.99999999999352,   4.000000000002501};
    static const double l[] = {0, -4, 2, 3, 0, -3, 0};
    static const double near[] = {0, 6, -8, 0, -3, 7, -6};
    double u[MAX];
    for (int i = 0; i < MAX; i++)
        u[i] = l[i] + 0x1p-40;
    const ns_mlcp p = {.m = 7, .q = q, .l = l, .u = u};
    for (int k = 0; k < 2187; k++) {
        assert_int_equal(solve(NS_MLCP_AUTO, &p, rows[0], k), NS_OK);
        for (int i = 0; i < MAX; i++) {
            assert_true(fabs(y[i] - near[i]) <= 3e-11);
            assert_true(near[i] == 0.0 || mode[i] == (near[i] > 0 ? NS_LOWER : NS_UPPER));
            assert_true(near[i] == 0.0 || lambda[i] == (near[i] > 0 ? l[i] : u[i]));
        }
    }
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
        cmocka_unit_test_setup_teardown(y_of_two_boxes, setup, teardown),
        cmocka_unit_test_setup_teardown(y_of_seven_boxes, setup, teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
