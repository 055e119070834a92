/* tests/unit/mlcp/test_contract.c - what the MLCP calls refuse, what memory they take, what their residual
 * means. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth/mlcp.h"
#include "wrap_alloc.h"

#define INF INFINITY

/* A few roundings of numbers of size 1. */
static void close_to(double got, double expected) {
    if (!(fabs(got - expected) <= 1e-15))
        fail_msg("%.17g is not %.17g", got, expected);
}

/* Residuals by hand.  y = 2 lambda - 3: at 1.5 it is 0; at 1, y = -1 of terms of size 2 + 3 = 5; lambda's
 * size is 5/2, so nothing hides the 1/5. */
static void residual_is_what_it_says(void **state) {
    (void)state;
    double W[1] = {2}, q[1] = {-3}, l[1] = {0}, u[1] = {INF}, x;
    ns_mlcp p = {.m = 1, .W = W, .q = q, .l = l, .u = u};
    int worst = -1;
    x = 1.5;
    assert_true(ns_mlcp_residual(&p, &x, &worst) == 0.0);
    x = 1.0;
    close_to(ns_mlcp_residual(&p, &x, &worst), 0.2);
    assert_int_equal(worst, 0);
    x = 2.0; /* y = 1 of 7, lambda = 2 of 7/2: the smaller counts */
    close_to(ns_mlcp_residual(&p, &x, NULL), 1.0 / 7.0);
    x = -1.0; /* outside, y = -5 of 5: |l - proj(l - y)| with l = -1/(5/2), l - y = 0.6 */
    close_to(ns_mlcp_residual(&p, &x, NULL), 1.0);
    x = NAN;
    assert_true(isnan(ns_mlcp_residual(&p, &x, NULL)));
    assert_true(isnan(ns_mlcp_residual(NULL, &x, NULL)));
    assert_true(isnan(ns_mlcp_residual(&p, NULL, NULL)));
}

/* Millivolts or kiloamperes: the residual of a wrong answer stays what it is (powers of two: exactly). */
static void residual_follows_the_units(void **state) {
    (void)state;
    const double base[4] = {2, 1, -1, 3}, b[2] = {-1, 0.5};
    double l[2] = {0, 0}, u[2] = {INF, INF}, ref = 0;
    for (int k = 0; k < 5; k++) {
        double r[2] = {ldexp(1, 10 * k), ldexp(1, -7 * k)}, c[2] = {ldexp(1, -9 * k), ldexp(1, 11 * k)}, W[4],
               q[2], x[2];
        for (int i = 0; i < 2; i++) {
            q[i] = b[i] * r[i];
            x[i] = (0.3 + i) / c[i];
            for (int j = 0; j < 2; j++)
                W[i + 2 * j] = base[i + 2 * j] * r[i] * c[j];
        }
        ns_mlcp p = {.m = 2, .W = W, .q = q, .l = l, .u = u};
        double v = ns_mlcp_residual(&p, x, NULL);
        assert_true(v > 0.01);
        if (k == 0)
            ref = v;
        assert_true(v == ref);
    }
}

/* A capacitor's voltage that went on decaying has lost its digits: 127 lambda = 1.6e-314 has no answer to
 * 1e-10 of its terms, and none was found for the other pair.  Such numbers are zero. */
static void subnormal_numbers_are_zero(void **state) {
    (void)state;
    double W[4] = {127.288, 0, 0, 2}, q[2] = {-1.6e-314, -3}, l[2] = {0, 0}, u[2] = {INF, INF}, x[2], y[2];
    ns_mode mode[2] = {NS_LOWER, NS_LOWER};
    ns_mlcp p = {.m = 2, .W = W, .q = q, .l = l, .u = u};
    ns_mlcp_info info;
    ns_mlcp_solver *s;
    assert_int_equal(ns_mlcp_create(2, &s), NS_OK);
    assert_int_equal(ns_mlcp_solve(s, &p, mode, x, y, &info), NS_OK);
    assert_true(x[0] == 0 && y[0] == 0);
    close_to(x[1], 1.5);
    assert_true(q[0] < 0); /* the caller's */
    ns_mlcp_free(s);
}

static void bad_input_is_refused(void **state) {
    (void)state;
    double W[4] = {1, 0, 0, 1}, q[2] = {0, 0}, l[2] = {0, 0}, u[2] = {INF, INF}, x[2], y[2];
    ns_mode mode[2] = {0, 0};
    ns_mlcp_info info;
    ns_mlcp_solver *s;
    assert_int_equal(ns_mlcp_create(2, &s), NS_OK);
    ns_mlcp p = {.m = 2, .W = W, .q = q, .l = l, .u = u}, bad;
    assert_int_equal(ns_mlcp_solve(NULL, &p, mode, x, y, &info), NS_E_NULL);
    assert_int_equal(ns_mlcp_solve(s, NULL, mode, x, y, &info), NS_E_NULL);
    assert_int_equal(ns_mlcp_solve(s, &p, NULL, x, y, &info), NS_E_NULL);
    assert_int_equal(ns_mlcp_solve(s, &p, mode, NULL, y, &info), NS_E_NULL);
    assert_int_equal(ns_mlcp_solve(s, &p, mode, x, NULL, &info), NS_E_NULL);
    assert_int_equal(info.fault.status, NS_E_NULL);
    const double **arrays[] = {&bad.W, &bad.q, &bad.l, &bad.u};
    for (int k = 0; k < 4; k++) {
        bad = p;
        *arrays[k] = NULL;
        assert_int_equal(ns_mlcp_solve(s, &bad, mode, x, y, NULL), NS_E_NULL);
    }
    bad = p;
    bad.m = 3;
    assert_int_equal(ns_mlcp_solve(s, &bad, mode, x, y, NULL), NS_E_SIZE);
    bad.m = -1;
    assert_int_equal(ns_mlcp_solve(s, &bad, mode, x, y, NULL), NS_E_SIZE);
    const double odd[] = {NAN, INF, -INF};
    for (int k = 0; k < 3; k++) {
        W[3] = odd[k];
        assert_int_equal(ns_mlcp_solve(s, &p, mode, x, y, NULL), NS_E_NUMBER);
        W[3] = 1;
        q[1] = odd[k];
        assert_int_equal(ns_mlcp_solve(s, &p, mode, x, y, NULL), NS_E_NUMBER);
        q[1] = 0;
    }
    l[1] = NAN;
    assert_int_equal(ns_mlcp_solve(s, &p, mode, x, y, NULL), NS_E_NUMBER);
    l[1] = 1;
    u[1] = 0.5;
    assert_int_equal(ns_mlcp_solve(s, &p, mode, x, y, &info), NS_E_BOUNDS);
    assert_int_equal(info.fault.status, NS_E_BOUNDS);
    l[1] = u[1] = INF;
    assert_int_equal(ns_mlcp_solve(s, &p, mode, x, y, NULL), NS_E_BOUNDS);
    l[1] = 0;
    mode[0] = 100; /* any content is allowed */
    mode[1] = -100;
    assert_int_equal(ns_mlcp_solve(s, &p, mode, x, y, NULL), NS_OK);
    ns_mlcp_free(s);
    ns_mlcp_free(NULL);
    assert_int_equal(ns_mlcp_create(-1, &s), NS_E_SIZE);
    assert_null(s);
    assert_int_equal(ns_mlcp_create(1, NULL), NS_E_NULL);
}

static void every_allocation_may_fail(void **state) {
    (void)state;
    long k = 1;
    for (;; k++) {
        ns_mlcp_solver *s = (ns_mlcp_solver *)&k;
        fail_alloc_at(k);
        int status = ns_mlcp_create(5, &s);
        long made = allocs_made();
        fail_alloc_off();
        if (made < k) {
            assert_int_equal(status, NS_OK);
            ns_mlcp_free(s);
            break;
        }
        assert_int_equal(status, NS_E_MEMORY);
        assert_null(s);
    }
    assert_true(k > 4); /* struct, three blocks, the factors */
}

static void solving_takes_no_memory(void **state) {
    (void)state;
    double W[4] = {2, 1, 1, 2}, q[2] = {-5, -6}, l[2] = {0, 0}, u[2] = {INF, INF}, x[2], y[2];
    ns_mode mode[2] = {NS_LOWER, NS_LOWER};
    ns_mlcp p = {.m = 2, .W = W, .q = q, .l = l, .u = u};
    ns_mlcp_solver *s;
    assert_int_equal(ns_mlcp_create(2, &s), NS_OK);
    fail_alloc_at(1);
    int status = ns_mlcp_solve(s, &p, mode, x, y, NULL);
    long made = allocs_made();
    fail_alloc_off();
    assert_int_equal(status, NS_OK);
    assert_int_equal(made, 0);
    ns_mlcp_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(residual_is_what_it_says),  cmocka_unit_test(residual_follows_the_units),
        cmocka_unit_test(bad_input_is_refused),      cmocka_unit_test(subnormal_numbers_are_zero),
        cmocka_unit_test(every_allocation_may_fail), cmocka_unit_test(solving_takes_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
