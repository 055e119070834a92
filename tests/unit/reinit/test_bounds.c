/* tests/unit/reinit/test_bounds.c - by how much rounding may put the orders of a mode off, by hand. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "reinit/order_expansion.h"

/* 2 x1' = -3 x1 + 1 at x1 = 5, 4 x2' = -5 x2 + 2 at x2 = 2: rates of -7 and -2.  Each row may be off by 16
 * eps of its terms: 10 + 10 and 8 + 8 for x; 1 + 15 + 14 and 2 + 10 + 8 for the rates, and what x is off by
 * there. */
static void bounds_of_rounding(void **state) {
    (void)state;
    const ns_theta_options o = {1, 1, 0};
    const double w0[2] = {10, 8}, eps = 16 * DBL_EPSILON;
    const double of_x[] = {eps * 20 / 2, eps * 16 / 4},
                 of_rate[] = {(3 * of_x[0] + eps * 30) / 2, (5 * of_x[1] + eps * 20) / 4};
    ns_order_expansion e;
    ns_theta *t;
    ns_system *s;
    assert_int_equal(ns_system_create(2, 0, 0, 0, &s), NS_OK);
    s->M[0] = 2, s->A[0] = -3, s->b[0] = 1;
    s->M[3] = 4, s->A[3] = -5, s->b[1] = 2;
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
    assert_int_equal(ns_theta_start(t, w0, NULL), NS_OK);
    assert_int_equal(ns_reinit_orders_create(t, t->past.w, &e), NS_OK);
    assert_int_equal(ns_reinit_orders_expand(&e, NULL, NULL), NS_OK);
    for (int i = 0; i < 2; i++) {
        assert_true(e.Z0[i] == (i ? 2 : 5) && e.Z2[i] == (i ? -2 : -7));
        assert_true(fabs(e.E0[i] - of_x[i]) < 1e-12 * of_x[i]);
        assert_true(fabs(e.E2[i] - of_rate[i]) < 1e-12 * of_rate[i]);
    }
    ns_reinit_orders_free(&e);
    ns_theta_free(t);
    ns_system_free(s);
}

/* 2 x1' + x2' = -3 x1 + 6 x2 + 3, 4 x2' = -5 x2 + 2 at x = (5, 2), w = (12, 8): rates of 1 and -2.  As above,
 * with the terms of all columns: 12 + 12 and 8 + 8 for x; 3 + 27 + 4 and 2 + 10 + 8 for the rates.  M^-1 =
 * (1/2, -1/8; 0, 1/4). */
static void bounds_of_coupled_rows(void **state) {
    (void)state;
    const ns_theta_options o = {1, 1, 0};
    const double w0[2] = {12, 8}, eps = 16 * DBL_EPSILON;
    const double of_x[] = {eps * (24.0 / 2 + 16.0 / 8), eps * 16 / 4},
                 row[] = {3 * of_x[0] + 6 * of_x[1] + eps * 34, 5 * of_x[1] + eps * 20},
                 of_rate[] = {row[0] / 2 + row[1] / 8, row[1] / 4};
    ns_order_expansion e;
    ns_theta *t;
    ns_system *s;
    assert_int_equal(ns_system_create(2, 0, 0, 0, &s), NS_OK);
    s->M[0] = 2, s->M[2] = 1, s->M[3] = 4;
    s->A[0] = -3, s->A[2] = 6, s->A[3] = -5;
    s->b[0] = 3, s->b[1] = 2;
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
    assert_int_equal(ns_theta_start(t, w0, NULL), NS_OK);
    assert_int_equal(ns_reinit_orders_create(t, t->past.w, &e), NS_OK);
    for (int again = 0; again < 2; again++) /* nothing is left of what was there */
        assert_int_equal(ns_reinit_orders_expand(&e, NULL, NULL), NS_OK);
    for (int i = 0; i < 2; i++) {
        assert_true(e.Z0[i] == (i ? 2 : 5) && e.Z2[i] == (i ? -2 : 1));
        assert_true(fabs(e.E0[i] - of_x[i]) < 1e-12 * of_x[i]);
        assert_true(fabs(e.E2[i] - of_rate[i]) < 1e-12 * of_rate[i]);
    }
    ns_reinit_orders_free(&e);
    ns_theta_free(t);
    ns_system_free(s);
}

/* 2 x' = -3 x + 4 lambda and y = x - 2 = 0 from x = 5: an impulse of -1.5, then lambda = 1.5.  The row of x
 * may be off by 16 eps of 10 + 6 + 4, its rate by 6 + 6, that of y by 2 + 2.  Solved by hand, 1 in the row of
 * x makes an impulse of -1/4; 1 in that of y makes x = 1, an impulse of 1/2 and lambda = 3/4; 1 in the rate,
 * -1/4 of lambda. */
static void bounds_of_an_impulse(void **state) {
    (void)state;
    const ns_theta_options o = {1, 1, 0};
    const double w0 = 10, eps = 16 * DBL_EPSILON;
    const double of_impulse[] = {0, eps * (20.0 / 4 + 4.0 / 2)},
                 of_value[] = {eps * 4, eps * (4 * 3.0 / 4 + 12.0 / 4)};
    ns_order_expansion e;
    ns_theta *t;
    ns_system *s;
    assert_int_equal(ns_system_create(1, 1, 0, 0, &s), NS_OK);
    s->M[0] = 2, s->A[0] = -3, s->B[0] = 4;
    s->C[0] = 1, s->e[0] = -2;
    s->l[0] = -INFINITY, s->u[0] = INFINITY;
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
    assert_int_equal(ns_theta_start(t, &w0, NULL), NS_OK);
    assert_int_equal(ns_reinit_orders_create(t, t->past.w, &e), NS_OK);
    e.mode[0] = NS_INSIDE;
    for (int again = 0; again < 2; again++)
        assert_int_equal(ns_reinit_orders_expand(&e, NULL, NULL), NS_OK);
    assert_true(fabs(e.Z1[1] + 1.5) < 1e-15 && fabs(e.Z0[0] - 2) < 1e-15 && fabs(e.Z0[1] - 1.5) < 1e-15);
    for (int i = 0; i < 2; i++) {
        assert_true(fabs(e.E1[i] - of_impulse[i]) <= 1e-3 * of_impulse[i]);
        assert_true(fabs(e.E0[i] - of_value[i]) <= 1e-3 * of_value[i]);
        assert_true(e.at[0][i] == e.Z1[i] && e.at[1][i] == e.Z0[i] && e.at[2][i] == e.Z2[i]);
        assert_true(e.error[0][i] == e.E1[i] && e.error[1][i] == e.E0[i] && e.error[2][i] == e.E2[i]);
    }
    ns_reinit_orders_free(&e);
    ns_theta_free(t);
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(bounds_of_rounding),
                                       cmocka_unit_test(bounds_of_coupled_rows),
                                       cmocka_unit_test(bounds_of_an_impulse)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
