/* tests/unit/reinit/test_impulse.c - the impulse problem of one unknown: modes, inputs, what is refused. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "reinit/order_expansion.h"

/* x' = lambda >= 0, 0 <= y = x - z_0 + 2 z_1: with z = (5, 1) x jumps from 0 to 3 by an impulse of 3, with z
 * = (5, 4) y is 3 and nothing jumps. */
static void inputs_of_a_law(void **state) {
    const ns_theta_options o = {1, 1, 0};
    ns_system *s;
    ns_theta *t;
    const double w0 = 0;
    (void)state;
    assert_int_equal(ns_system_create(1, 1, 2, 0, &s), NS_OK);
    s->M[0] = s->B[0] = s->C[0] = 1;
    s->F[0] = -1;
    s->F[1] = 2;
    s->u[0] = INFINITY;
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
    for (int jumps = 0; jumps < 2; jumps++) {
        const double z[] = {5, jumps ? 1 : 4};
        double w, x, lambda, y, X, Lambda, Y, h;
        ns_mode mode;
        const ns_impulse out = {.w = &w,
                                .x = &x,
                                .lambda = &lambda,
                                .y = &y,
                                .X = &X,
                                .Lambda = &Lambda,
                                .Y = &Y,
                                .mode = &mode,
                                .h = &h};
        assert_int_equal(ns_theta_start(t, &w0, NULL), NS_OK);
        assert_int_equal(ns_theta_impulse(t, z, NULL, &out), NS_OK);
        assert_true(fabs(x - (jumps ? 3 : 0)) < 1e-14 && fabs(Lambda - (jumps ? 3 : 0)) < 1e-14);
        assert_true(fabs(y - (jumps ? 0 : 3)) < 1e-14);
        assert_int_equal(mode, jumps ? NS_INSIDE : NS_LOWER);
    }
    ns_theta_free(t);
    ns_system_free(s);
}

/* y1 = lambda1 - 2 and y2 = 3 + x + 5 lambda1 + lambda2 with x = 7: lambda = (2, 0), y = (0, 20).  An input,
 * or its slope, that is no number is refused. */
static void laws_of_other_pairs(void **state) {
    const ns_theta_options o = {1, 1, 0};
    const double w0 = 7, z = 0, none = NAN;
    double w, x, lambda[2], y[2], X, Lambda[2], Y[2], h;
    ns_mode mode[2];
    const ns_impulse out = {&w, &x, lambda, y, &X, Lambda, Y, mode, &h};
    ns_theta *t;
    ns_system *s;
    (void)state;
    assert_int_equal(ns_system_create(1, 2, 1, 0, &s), NS_OK);
    s->M[0] = 1;
    s->D[0] = s->D[3] = 1, s->D[1] = 5;
    s->C[1] = 1;
    s->e[0] = -2, s->e[1] = 3;
    s->u[0] = s->u[1] = INFINITY;
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
    assert_int_equal(ns_theta_start(t, &w0, NULL), NS_OK);
    assert_int_equal(ns_theta_impulse(t, &z, NULL, &out), NS_OK);
    assert_true(x == 7 && fabs(lambda[0] - 2) < 1e-14 && lambda[1] == 0);
    assert_true(fabs(y[0]) < 1e-14 && fabs(y[1] - 20) < 1e-13);
    assert_int_equal(mode[0], NS_INSIDE);
    assert_int_equal(mode[1], NS_LOWER);
    assert_int_equal(ns_theta_impulse(t, &none, NULL, &out), NS_E_NUMBER);
    assert_int_equal(ns_theta_impulse(t, &none, &z, &out), NS_E_NUMBER);
    assert_int_equal(ns_theta_impulse(t, &z, &none, &out), NS_E_NUMBER);
    ns_theta_free(t);
    ns_system_free(s);
}

/* x' = -1 - lambda, y = x, both at least 0: from x = 2 in the mode y = 0 an impulse of 2 takes x to 0, where
 * no mode goes on: lambda = -1 keeps x there, lambda = 0 lets it fall.  So the mode and values of the jump
 * stay. */
static void no_mode_after_a_jump(void **state) {
    const ns_theta_options o = {1, 1, 0};
    const double w0 = 2;
    const ns_mode inside = NS_INSIDE;
    double w, x, lambda, y, X, Lambda, Y, h;
    ns_mode mode;
    const ns_impulse out = {&w, &x, &lambda, &y, &X, &Lambda, &Y, &mode, &h};
    ns_theta *t;
    ns_system *s;
    (void)state;
    assert_int_equal(ns_system_create(1, 1, 0, 0, &s), NS_OK);
    s->M[0] = s->C[0] = 1;
    s->B[0] = s->b[0] = -1;
    s->u[0] = INFINITY;
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
    assert_int_equal(ns_theta_start(t, &w0, NULL), NS_OK);
    ns_theta_set_mode(t, &inside);
    assert_int_equal(ns_theta_impulse(t, NULL, NULL, &out), NS_OK);
    assert_true(fabs(x) < 1e-15 && fabs(w) < 1e-15 && fabs(Lambda - 2) < 1e-15);
    assert_true(fabs(lambda + 1) < 1e-15);
    assert_int_equal(mode, NS_INSIDE);
    ns_theta_free(t);
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(inputs_of_a_law),
                                       cmocka_unit_test(laws_of_other_pairs),
                                       cmocka_unit_test(no_mode_after_a_jump)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
