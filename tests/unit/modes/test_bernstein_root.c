/* tests/unit/modes/test_bernstein_root.c - roots of guards over a step. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "modes/bernstein_root.h"

/* 1/4 - u over a step of 2 g, s = 2 u: L_1 = 1 - s, so that it is -1/4 + L_1/2.  Below -1/10 from 0.35 on. */
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

/* (u - 1/4)^2 + off over a step of g: u^2 = 2 L_2 - 4 L_1 + 2, u = 1 - L_1. */
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

/* -u: zero at the start, below at once; and 2 - u or (2 - u)/4, which are zero after the step. */
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

/* (u - 1/4)^2 from u = 1/2 on, of the rest of the step: (1/4 + v/2)^2. */
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

/* T_8(1 - 2 u) = cos(8 acos(1 - 2 u)): below -1/2 first where 8 times the angle is 2 pi/3, zero before that
 * where it is pi/2; its part up to `end` is the same curve of u/end.  Slope: 16 sin(8 a)/sin(a), a the angle.
 */
static void test_chebyshev(void **state) {
    (void)state;
    const double pi = acos(-1), zero = (1 - cos(pi / 16)) / 2, half = (1 - cos(pi / 12)) / 2;
    double last[9] = {1}, now[9] = {1, -2}; /* T_0, T_1 */
    for (int n = 2; n <= 8; n++) {          /* T_n = 2 (1 - 2 u) T_n-1 - T_n-2 */
        double next[9];
        for (int k = 0; k < 9; k++)
            next[k] = 2 * now[k] - (k > 0 ? 4 * now[k - 1] : 0) - last[k];
        for (int k = 0; k < 9; k++) {
            last[k] = now[k];
            now[k] = next[k];
        }
    }
    ns_curve c = {.terms = 9}, part;
    for (int k = 0; k < 9; k++)
        c.p[k] = now[k];
    assert_int_equal(c.terms, NS_SEARCH_TERMS);
    const double below = ns_modes_curve_below(&c, 0.5);
    assert_true(fabs(below - half) < 1e-14); /* coefficients of some 1e4, slope of 50 */
    assert_true(fabs(ns_modes_curve_root(&c, below) - zero) < 1e-14);
    assert_true(isnan(ns_modes_curve_below(&c, 1 + 1e-9)));
    ns_modes_curve_cut(&c, 0.5, &part);
    assert_int_equal(part.terms, 9);
    assert_true(fabs(ns_modes_curve_below(&part, 0.5) - 2 * half) < 1e-14);
    for (int k = 1; k < 15; k++) {
        const double a = 0.1 * k;
        const double slope = ns_modes_curve_slope(&c, (1 - cos(a)) / 2);
        assert_true(fabs(slope + 16 * sin(8 * a) / sin(a)) < 1e-9);
    }
}

/* (u - 1/4)^2 has the Bernstein coefficients 1/16, -3/16 and 9/16: the bound is 1/4 below the curve itself.
 */
static void test_bound(void **state) {
    (void)state;
    ns_curve c;
    near_miss(0, &c);
    assert_int_equal(ns_modes_curve_holds(&c, 3. / 16 - 1e-12), 0);
    assert_int_equal(ns_modes_curve_holds(&c, 3. / 16 + 1e-12), 1);
}

static long calls;

/* cos: zero at pi/2; steep: 1 - u^9, at 1. */
static double cosine(const void *data, double at) {
    (void)data;
    calls++;
    return cos(at);
}

static double steep(const void *data, double at) {
    calls++;
    return *(const double *)data - pow(at, 9);
}

/* The last point that is not below zero, within eps of it; more than twice as fast as halving, 52 steps. */
static void test_chords(void **state) {
    (void)state;
    const double eps = 2.3e-16, pi = acos(-1), one = 1;
    calls = 0;
    double at = ns_modes_chords(cosine, NULL, 1, 3, eps);
    assert_true(cos(at) >= 0 && fabs(at - pi / 2) <= 4 * eps * at && calls < 26);
    calls = 0;
    at = ns_modes_chords(steep, &one, 0.5, 4, eps);
    assert_true(1 - pow(at, 9) >= 0 && fabs(at - 1) <= 4 * eps && calls < 40);
    assert_true(ns_modes_chords(cosine, NULL, 2, 3, eps) == 2); /* below zero already */
    assert_true(fabs(ns_modes_chords(cosine, NULL, 1, 3, 1e-3) - pi / 2) <= 8e-3);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_line),   cmocka_unit_test(test_near_miss), cmocka_unit_test(test_ends),
        cmocka_unit_test(test_rest),   cmocka_unit_test(test_chebyshev), cmocka_unit_test(test_bound),
        cmocka_unit_test(test_chords),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
