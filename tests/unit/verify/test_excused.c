/* tests/unit/verify/test_excused.c - a wrong sign that lasts no longer than the rounding of the time: of one
 * pair, at one time. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "verify/verify_internal.h"

enum { PAIRS = 2 };
static const double none = 0;

/* Two pairs, y = lambda, both 0 or more and one of them 0. */
static ns_system *diodes(ns_verify **v) {
    const ns_verify_options o = {.reltol = 1e-9, .instant = 1e-11};
    ns_system *s;
    assert_int_equal(ns_system_create(1, PAIRS, 0, 0, &s), NS_OK);
    s->A[0] = -1;
    for (int j = 0; j < PAIRS; j++) {
        s->D[j + PAIRS * j] = 1;
        s->u[j] = INFINITY;
    }
    assert_int_equal(ns_verify_create(s, &o, v), NS_OK);
    return s;
}

/* Of a pair with that lambda, the other one 0, at t. */
static int is_right(ns_verify *v, double t, int pair, double current) {
    double lambda[PAIRS] = {0};
    ns_verify_finding f;
    lambda[pair] = current;
    const ns_verify_state at = {t, NS_RIGHT, &none, lambda, NULL, 0};
    return ns_verify_point(v, &at, &f);
}

static void one_pair_at_one_time(void **state) {
    ns_verify *v;
    ns_system *s = diodes(&v);
    (void)state;
    assert_false(is_right(v, 1, 0, -1));
    ns_verify_excuse(v, 1, 0);
    assert_true(is_right(v, 1, 0, -1));
    assert_false(is_right(v, 1, 1, -1));
    assert_false(is_right(v, 2, 0, -1));
    ns_verify_excuse(v, 2, 1);
    assert_true(is_right(v, 2, 1, -1));
    assert_false(is_right(v, 2, 0, -1));
    assert_false(is_right(v, 1, 0, -1));
    ns_verify_free(v);
    ns_system_free(s);
}

/* From -1 to 3: at the second point a twentieth and nearly half of that is gone; more; it goes the other way.
 */
static void what_does_not_jump(void **state) {
    static const double line[][3] = {{-1, -0.8, 3}, {-1, 0.9, 3}, {-1, 1.1, 3}, {-1, -1.1, 3}};
    (void)state;
    for (int k = 0; k < 4; k++) {
        double at[3][PAIRS] = {{0}};
        ns_verify *v;
        ns_system *s = diodes(&v);
        for (int i = 0; i < 3; i++)
            at[i][1] = line[k][i];
        const ns_verify_state way[] = {{1, NS_RIGHT, &none, at[0], NULL, 0},
                                       {2, NS_RIGHT, &none, at[1], NULL, 0},
                                       {3, NS_RIGHT, &none, at[2], NULL, 0}};
        assert_int_equal(ns_verify_is_gradual(v, 1, way), k < 2);
        assert_true(ns_verify_is_gradual(v, 0, way));
        ns_verify_free(v);
        ns_system_free(s);
    }
}

/* x' = lambda_0, x = 5 C: at 2 A backward 1e-5 of that, 50 uC, take 25 us; 64 times what an event may take is
 * the longest.  What lambda_1 flows into no charge tells. */
static void how_long_a_current_counts_for_nothing(void **state) {
    static const double instant[] = {1, 1e-9};
    (void)state;
    for (int k = 0; k < 2; k++) {
        const ns_verify_options o = {.reltol = 0, .instant = instant[k]};
        const double x = 5, lambda[PAIRS] = {-2, -2};
        const ns_verify_state at = {1, NS_RIGHT, &x, lambda, NULL, 0};
        ns_system *s;
        ns_verify *v;
        assert_int_equal(ns_system_create(1, PAIRS, 0, 0, &s), NS_OK);
        s->M[0] = s->B[0] = 1;
        assert_int_equal(ns_verify_create(s, &o, &v), NS_OK);
        const double longest = ns_verify_excusable(v, 0, &at), right = k == 0 ? 25e-6 : 64e-9;
        assert_true(fabs(longest - right) <= 1e-3 * right);
        assert_true(ns_verify_excusable(v, 1, &at) == 0);
        ns_verify_free(v);
        ns_system_free(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(one_pair_at_one_time),
                                       cmocka_unit_test(what_does_not_jump),
                                       cmocka_unit_test(how_long_a_current_counts_for_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
