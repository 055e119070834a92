/* tests/unit/modes/test_bernstein_root.c - roots of guards over a leg. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "modes/bernstein_root.h"

/* 1/4 - u over a leg of 2 g, s = 2 u: L_1 = 1 - s, so that it is -1/4 + L_1/2.  Below -1/10 from 0.35 on. */
static void test_line(void **state) {
    (void)state;
    const double G[] = {-0.25, -0.5};
    ns_curve c;
    ns_modes_curve_of(2, G, 2, &c);
    assert_true(fabs(ns_modes_curve_below(&c, 0.1) - 0.35) < 1e-15);
    assert_true(fabs(ns_modes_curve_root(&c, 0.35) - 0.25) < 1e-15);
    assert_true(fabs(ns_modes_curve_root(&c, 0.1) - 0.25) < 1e-15);
    assert_true(isnan(ns_modes_curve_below(&c, 0.76))); /* -3/4 at its end */
}

/* (u - 1/4)^2 + off over a leg of g: u^2 = 2 L_2 - 4 L_1 + 2, u = 1 - L_1. */
static void near_miss(double off, ns_curve *c) {
    const double G[] = {2 - 0.5 + 0.0625 + off, 4 - 0.5, 2};
    ns_modes_curve_of(3, G, 1, c);
}

/* Above zero by 1e-6 it never breaks, nor below it by less than it may; else between 1/4 -+ 1e-3, and the
 * root before is found. */
static void test_near_miss(void **state) {
    (void)state;
    ns_curve c;
    near_miss(1e-6, &c);
    assert_true(isnan(ns_modes_curve_below(&c, 0)));
    near_miss(-1e-6, &c);
    assert_true(isnan(ns_modes_curve_below(&c, 1.1e-6)));
    const double at = ns_modes_curve_below(&c, 0.75e-6); /* 5e-4 before the middle, of slope 1e-3 */
    assert_true(fabs(at - (0.25 - 5e-4)) < 1e-11);
    assert_true(fabs(ns_modes_curve_root(&c, at) - (0.25 - 1e-3)) < 1e-11);
}

/* -u: zero at the start, below at once; and 2 - u or (2 - u)/4, which are zero after the leg. */
static void test_ends(void **state) {
    (void)state;
    const double falls[] = {-1, -1}, stays[] = {1, -1}, little[] = {0.25, -0.25};
    ns_curve c;
    ns_modes_curve_of(2, falls, 1, &c);
    assert_true(ns_modes_curve_root(&c, ns_modes_curve_below(&c, 1e-3)) < 1e-15);
    ns_modes_curve_of(2, stays, 1, &c);
    assert_true(isnan(ns_modes_curve_below(&c, 0)));
    assert_true(ns_modes_curve_root(&c, 0.5) == INFINITY);
    ns_modes_curve_of(2, little, 1, &c);
    assert_true(ns_modes_curve_root(&c, 0.5) == INFINITY);
}

/* (u - 1/4)^2 from u = 1/2 on, of the rest of the leg: (1/4 + v/2)^2. */
static void test_rest(void **state) {
    (void)state;
    ns_curve c, rest;
    near_miss(0, &c);
    ns_modes_curve_rest(&c, 0.5, &rest);
    assert_int_equal(rest.terms, 3);
    assert_true(fabs(rest.p[0] - 1. / 16) < 1e-15);
    assert_true(fabs(rest.p[1] - 0.25) < 1e-15);
    assert_true(fabs(rest.p[2] - 0.25) < 1e-15);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_line),
        cmocka_unit_test(test_near_miss),
        cmocka_unit_test(test_ends),
        cmocka_unit_test(test_rest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
