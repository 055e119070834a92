/* tests/known/test_theta_guard_noise.c - a broken guard counts as met where entries of 2e16 stand beside 1:
 * found by the fuzzer, whose seeds tests/fuzz/seeds/ hold more of the kind. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth.h"

/* Any step that is accepted obeys (S4): y >= 0 where lambda = 0, up to rounding of the terms of y. */
static void an_accepted_step_obeys_the_law(void **state) {
    (void)state;
    const double B[] = {0.5, -2e16}, C[] = {2e16, 2e16}, D[] = {1e16, 1, 2e16, 0.5}, e[] = {-2e16, -7};
    const ns_theta_options o = {0.5, 0.001, 0};
    const double w0 = 0;
    for (int k = 0; k < 48; k++) {
        ns_system *s;
        ns_theta *t;
        double x, lambda[2], y[2];
        assert_int_equal(ns_system_create(1, 2, 0, 0, &s), NS_OK);
        s->M[0] = s->A[0] = 2e16;
        s->b[0] = -7;
        memcpy(s->B, B, sizeof B);
        memcpy(s->C, C, sizeof C);
        memcpy(s->D, D, sizeof D);
        memcpy(s->e, e, sizeof e);
        assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
        assert_int_equal(ns_theta_start(t, &w0, NULL), NS_OK);
        for (int step = 0; step < 6; step++) {
            if (ns_theta_try(t, ldexp(0.125, -(k % 12)), NULL, k / 12 % 2, k < 24 ? NS_RESOLVE : NS_HOLD) !=
                NS_OK)
                break;
            assert_int_equal(ns_theta_accept(t), NS_OK);
            assert_int_equal(ns_theta_read(t, &x, lambda, y), NS_OK);
            for (int j = 0; j < 2; j++) {
                const double terms =
                    fabs(C[j] * x) + fabs(D[j] * lambda[0]) + fabs(D[j + 2] * lambda[1]) + fabs(e[j]);
                if (ns_theta_mode(t)[j] == NS_LOWER && y[j] < -1e-9 * terms)
                    fail_msg("h = 0.125/2^%d, step %d: y%d = %g, of terms %g", k % 12, step, j, y[j], terms);
            }
        }
        ns_theta_free(t);
        ns_system_free(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(an_accepted_step_obeys_the_law)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
