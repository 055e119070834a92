/* tests/unit/mlcp/test_limit.c - branch and bound within the work that the caller allows. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth/mlcp.h"

enum { M = 12 };

/* y = W lambda - 1 with W_ij = 1 above the diagonal and on it, else 2: all lambda but the first are 0 in the
 * solution lambda_0 = 1, as y_i = 2 - 1 > 0 there.  Without complementarity it has many others. */
static void problem(double *W, double *q, double *l, double *u) {
    for (int i = 0; i < M; i++) {
        for (int j = 0; j < M; j++)
            W[i + j * M] = i <= j ? 1 : 2;
        q[i] = -1;
        l[i] = 0;
        u[i] = INFINITY;
    }
}

static void work_is_counted_and_bound(void **state) {
    double W[M * M], q[M], l[M], u[M], lambda[M], y[M], searched;
    ns_mode mode[M] = {0};
    ns_mlcp_solver *s;
    ns_mlcp_info info;
    (void)state;
    problem(W, q, l, u);
    const ns_mlcp p = {.m = M, .W = W, .q = q, .l = l, .u = u};
    assert_int_equal(ns_mlcp_create(M, &s), NS_OK);
    assert_int_equal(ns_mlcp_limit(NULL, 1), NS_E_NULL);
    assert_int_equal(ns_mlcp_limit(s, NAN), NS_E_RANGE);
    assert_int_equal(ns_mlcp_use(s, NS_MLCP_ENUMERATE), NS_OK);
    assert_int_equal(ns_mlcp_solve(s, &p, mode, lambda, y, &info), NS_OK);
    assert_true(info.searched > 0 && !info.cut_off);
    searched = info.searched;
    assert_int_equal(ns_mlcp_limit(s, searched), NS_OK);
    assert_int_equal(ns_mlcp_solve(s, &p, mode, lambda, y, &info), NS_OK);
    assert_true(info.searched == searched && !info.cut_off); /* the same on every call */
    assert_int_equal(ns_mlcp_limit(s, 0), NS_OK);
    assert_int_equal(ns_mlcp_solve(s, &p, mode, lambda, y, &info), NS_E_LIMIT);
    assert_true(info.cut_off);
    assert_int_equal(ns_mlcp_limit(s, INFINITY), NS_OK);
    assert_int_equal(ns_mlcp_solve(s, &p, mode, lambda, y, &info), NS_OK);
    assert_true(info.searched == searched);
    ns_mlcp_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(work_is_counted_and_bound)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
