/* tests/unit/system/test_signal.c - sources as functions of time, against closed forms. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth/signal.h"
#include "signals.h"

static const double eps = DBL_EPSILON;

static ns_signal pwl(int n, const double *t, const double *v, double repeat, double td) {
    ns_signal s = {.kind = NS_PWL};
    s.u.pwl.n = n;
    s.u.pwl.t = t;
    s.u.pwl.v = v;
    s.u.pwl.repeat = repeat;
    s.u.pwl.td = td;
    return s;
}

static void assert_near(double got, double want, double tolerance) {
    if (!(fabs(got - want) <= tolerance)) {
        fail_msg("%.17g, expected %.17g within %g", got, want, tolerance);
    }
}

static void assert_both(const ns_signal *s, double t, double left, double right) {
    assert_near(ns_signal_value(s, t, NS_LEFT), left, 8 * eps * (fabs(left) + fabs(right)));
    assert_near(ns_signal_value(s, t, NS_RIGHT), right, 8 * eps * (fabs(left) + fabs(right)));
}

static void dc_is_constant(void **state) {
    ns_signal s = {.kind = NS_DC, .u.dc = -3};
    (void)state;
    assert_both(&s, -1e9, -3, -3);
    assert_both(&s, 5, -3, -3);
    assert_true(isinf(ns_signal_next_corner(&s, 0)));
    assert_int_equal(ns_signal_is_linear(&s), 1);
}

/* Up from 1 to 5 in 2 s from t = 10, held 4 s, down in 1 s, period 20 s: straight lines between. */
static void pulse_follows_its_lines(void **state) {
    ns_signal s = pulse(1, 5, 10, 2, 1, 4, 20);
    (void)state;
    assert_both(&s, -5, 1, 1);
    assert_both(&s, 10, 1, 1);
    assert_both(&s, 10.5, 2, 2);
    assert_both(&s, 12, 5, 5);
    assert_both(&s, 15.9, 5, 5);
    assert_both(&s, 16.25, 4, 4);
    assert_both(&s, 17, 1, 1);
    assert_both(&s, 29, 1, 1);
    assert_both(&s, 10.5 + 20 * 1000, 2, 2);
}

static void pulse_corners_in_order(void **state) {
    ns_signal s = pulse(1, 5, 10, 2, 1, 4, 20);
    const double corner[] = {10, 12, 16, 17, 30, 32, 36, 37};
    double t = -100;
    (void)state;
    for (int i = 0; i < 8; i++) {
        t = ns_signal_next_corner(&s, t);
        assert_near(t, corner[i], 0); /* integers: exact */
    }
    assert_near(ns_signal_next_corner(&s, 16.5), 17, 0);
    assert_near(ns_signal_next_corner(&s, nextafter(17, 0)), 30, 0);
}

/* Ten million periods of 1e-6/3 s: corner k lies where k per + td says, to the rounding of that sum. */
static void pulse_does_not_drift(void **state) {
    double per = 1e-6 / 3, td = 1e-7, k = 1e7;
    ns_signal s = pulse(0, 1, td, 1e-9, 1e-9, 1e-7, per);
    double c = ns_signal_next_corner(&s, td + (k - 0.5) * per);
    (void)state;
    assert_near(c, td + k * per, 2 * eps * c);
    assert_near(ns_signal_next_corner(&s, c), td + k * per + 1e-9, 2 * eps * c);
    assert_both(&s, c, 0, 0);
}

/* The parts of this pulse add up to its period within rounding only, so that the last corner of a period is
 * the first of the next: three distinct corners a period, each met once, in 10000 periods. */
static void corners_are_met_once(void **state) {
    ns_signal s = pulse(0, 1, 0, 0.1e-3, 0.3e-3, 0.6e-3, 1e-3);
    double t = 0, end = 9.99995;
    int count = 0;
    (void)state;
    while ((t = ns_signal_next_corner(&s, t)) < end) {
        count++;
    }
    assert_int_equal(count, 3 * 10000 - 1 /* the start itself */);
}

/* At a jump the two sides differ, also for the doubles next to the corner that a caller may compute. */
static void jumps_have_two_sides(void **state) {
    ns_signal s = pulse(-1, 2, 1e-4, 0, 0, 3e-4, 1e-3);
    (void)state;
    for (int k = 0; k < 2000; k++) {
        double up = 1e-4 + k * 1e-3, down = 4e-4 + k * 1e-3;
        assert_both(&s, up, -1, 2);
        assert_both(&s, nextafter(up, 0), -1, 2);
        assert_both(&s, nextafter(up, 1e9), -1, 2);
        assert_both(&s, down, 2, -1);
        assert_near(ns_signal_next_corner(&s, nextafter(up, 0)), down, 4 * eps * down);
        assert_near(ns_signal_next_corner(&s, nextafter(down, 1e9)), up + 1e-3, 4 * eps * (up + 1e-3));
    }
}

static void value_at_a_corner_is_that_of_the_point(void **state) {
    ns_signal s = pulse(0.1, 0.7, 1e-5, 1e-6, 3e-6, 7e-6, 23e-6);
    double t = 0;
    (void)state;
    for (int i = 0; i < 400; i++) {
        double want = i % 4 == 1 || i % 4 == 2 ? 0.7 : 0.1;
        t = ns_signal_next_corner(&s, t);
        /* one slope is 0.6 V in 1e-6 s; t is known to eps t */
        assert_near(ns_signal_value(&s, t, NS_LEFT), want, 0.6e6 * 8 * eps * t);
        assert_near(ns_signal_value(&s, t, NS_RIGHT), want, 0.6e6 * 8 * eps * t);
    }
}

static void pulse_once_and_counted(void **state) {
    ns_signal once = pulse(0, 1, 1, 1, 1, 1, INFINITY), step = pulse(0, 1, 1, 0, 0, INFINITY, INFINITY);
    ns_signal twice = pulse(0, 1, 1, 1, 1, 1, 5);
    (void)state;
    assert_near(ns_signal_next_corner(&once, 3.5), 4, 0);
    assert_true(isinf(ns_signal_next_corner(&once, 4)));
    assert_both(&once, 1e9, 0, 0);
    assert_both(&step, 1, 0, 1);
    assert_both(&step, 1e9, 1, 1);
    assert_true(isinf(ns_signal_next_corner(&step, 1)));
    twice.u.pulse.cycles = 2;
    assert_both(&twice, 7.5, 1, 1);
    assert_both(&twice, 12.5, 0, 0);
    assert_near(ns_signal_next_corner(&twice, 8.5), 9, 0);
    assert_true(isinf(ns_signal_next_corner(&twice, 9)));
}

/* 1 s up, 2 s held, 2 s down, but a period of 4 s: cut off halfway down, at 3 + (5-3)/2 = 4, back to 3. */
static void pulse_longer_than_its_period(void **state) {
    ns_signal s = pulse(3, 5, 0, 1, 2, 2, 4);
    (void)state;
    assert_both(&s, 4, 4, 3);
    assert_both(&s, 8, 4, 3);
    assert_both(&s, 4.5, 4, 4);
    assert_near(ns_signal_next_corner(&s, 3), 4, 0);
    s.u.pulse.cycles = 1;
    assert_both(&s, 4, 4, 3);
    assert_both(&s, 9, 3, 3);
    assert_true(isinf(ns_signal_next_corner(&s, 4)));
    s = pulse(3, 5, 0, 1, 2, INFINITY, 4);
    assert_both(&s, 4, 5, 3);
}

/* A period of 3 s cuts a rise of 4 s from 3 to 5 off at 3 + 2 * 3/4. */
static void pulse_cut_while_it_rises(void **state) {
    ns_signal s = pulse(3, 5, 0, 4, 1, 1, 3);
    (void)state;
    assert_both(&s, 1, 3.5, 3.5);
    assert_both(&s, 3, 4.5, 3);
    assert_both(&s, 31, 3.5, 3.5);
}

/* Wherever t lies among the doubles around a jump at the end of a period: the value to its right is that of
 * the line which the next corner ends. */
static void value_and_corner_agree(void **state) {
    double per = 1e-5 / 3, cut = per / 2;
    ns_signal s = pulse(0, 1, 1e-6, cut, 0, per, per); /* 0 -> 1, held, back at once with the period */
    (void)state;
    for (int k = 1; k < 5000; k += 7) {
        double jump = 1e-6 + k * per, ulp = nextafter(jump, 1) - jump;
        for (int steps = -40; steps <= 40; steps++) {
            double t = jump + steps * ulp, c = ns_signal_next_corner(&s, t);
            double v = ns_signal_value(&s, t, NS_RIGHT);
            assert_true(c > t && (fabs(c - jump) < 4 * ulp || fabs(c - jump - cut) < 4 * ulp));
            assert_near(v, fabs(c - jump) < 4 * ulp, 100 * ulp / cut);
            v = ns_signal_value(&s, t, NS_LEFT);
            assert_true(v > 1 - 100 * ulp / cut || (v < 100 * ulp / cut && steps > 0));
        }
    }
}

/* vo + va exp(-theta (t-td)) sin(2 pi f (t-td) + phase): quarter periods have closed values. */
static void sine(void **state) {
    ns_signal s = {.kind = NS_SIN};
    s.u.sin.vo = 1;
    s.u.sin.va = 2;
    s.u.sin.freq = 50;
    s.u.sin.td = 0.01;
    s.u.sin.theta = 100;
    s.u.sin.phase = 30;
    (void)state;
    assert_near(ns_signal_value(&s, 0, NS_RIGHT), 2, 8 * eps);
    assert_near(ns_signal_value(&s, 0.01, NS_LEFT), 2, 8 * eps);
    assert_near(ns_signal_value(&s, 0.015, NS_RIGHT), 1 + 2 * exp(-0.5) * sqrt(0.75), 16 * eps);
    assert_near(ns_signal_value(&s, 0.02, NS_RIGHT), 1 - exp(-1), 16 * eps);
    assert_near(ns_signal_next_corner(&s, 0), 0.01, 0);
    assert_true(isinf(ns_signal_next_corner(&s, 0.01)));
    assert_int_equal(ns_signal_is_linear(&s), 0);
    s.u.sin.theta = s.u.sin.phase = s.u.sin.td = 0;
    /* a million whole turns: the phase is lost only to the rounding of f t, 1e6 eps turns */
    assert_near(ns_signal_value(&s, 20000.005, NS_RIGHT), 3, 1e-9);
    assert_near(ns_signal_value(&s, 20000, NS_RIGHT), 1, 2 * 6.3 * 1e6 * eps);
}

static void exponential(void **state) {
    ns_signal s = {.kind = NS_EXP};
    s.u.exp.v1 = 1;
    s.u.exp.v2 = 5;
    s.u.exp.td1 = 2;
    s.u.exp.tau1 = 0.5;
    s.u.exp.td2 = 4;
    s.u.exp.tau2 = 3;
    (void)state;
    assert_both(&s, 2, 1, 1);
    assert_near(ns_signal_value(&s, 3, NS_LEFT), 5 - 4 * exp(-2), 16 * eps);
    assert_near(ns_signal_value(&s, 7, NS_LEFT), 5 - 4 * exp(-10) - 4 * (1 - exp(-1)), 16 * eps);
    assert_near(ns_signal_next_corner(&s, 1), 2, 0);
    assert_near(ns_signal_next_corner(&s, 2), 4, 0);
    assert_true(isinf(ns_signal_next_corner(&s, 4)));
    s.u.exp.td2 = 0; /* SPICE: nothing happens before td1, then both terms at once */
    assert_near(ns_signal_value(&s, 1, NS_RIGHT), 1, 0);
    assert_both(&s, 2, 1, 1 - 4 * (1 - exp(-2. / 3)));
}

static void pwl_holds_jumps_and_shifts(void **state) {
    const double t[] = {1, 2, 2, 4}, v[] = {10, 20, -20, 0};
    ns_signal s = pwl(4, t, v, NAN, 0.5);
    const double corner[] = {1.5, 2.5, 4.5};
    double c = -1;
    (void)state;
    assert_both(&s, 0, 10, 10);
    assert_both(&s, 2, 15, 15);
    assert_both(&s, 2.5, 20, -20);
    assert_both(&s, 3.5, -10, -10);
    assert_both(&s, 100, 0, 0);
    for (int i = 0; i < 3; i++) {
        c = ns_signal_next_corner(&s, c);
        assert_near(c, corner[i], 0);
    }
    assert_true(isinf(ns_signal_next_corner(&s, c)));
    s = pwl(1, t, v, NAN, 0);
    assert_both(&s, 1, 10, 10);
}

/* Points at 1, 2, 4 s, repeated from 2 s on: the part of 2 s between 2 and 4 recurs after 4, with a jump from
 * 8 back to 6 at 4, 6, 8, ... s. */
static void pwl_repeats(void **state) {
    const double t[] = {1, 2, 4}, v[] = {0, 6, 8};
    ns_signal s = pwl(3, t, v, 2, 0);
    double c = 3;
    (void)state;
    assert_both(&s, 1.5, 3, 3);
    assert_both(&s, 4, 8, 6);
    assert_both(&s, 5, 7, 7);
    assert_both(&s, 1e6, 8, 6);
    for (int i = 0; i < 1000; i++) {
        c = ns_signal_next_corner(&s, c);
        assert_near(c, 4 + 2 * i, 0);
    }
}

/* A period far below the resolution of t: the walk still moves on and values stay within bounds. */
static void periods_too_short_to_tell(void **state) {
    ns_signal s = pulse(0, 1, 0, 1e-12, 1e-12, 1e-12, 4e-12);
    double t = 1e6, v = ns_signal_value(&s, t, NS_RIGHT);
    (void)state;
    assert_true(ns_signal_next_corner(&s, t) > t);
    assert_true(v >= 0 && v <= 1);
}

static void bad_parameters_are_refused(void **state) {
    const double t[] = {0, 1, 0.5}, v[] = {0, 1, 2}, nan_v[] = {0, NAN};
    ns_signal s = {.kind = NS_DC, .u.dc = INFINITY};
    (void)state;
    assert_int_equal(ns_signal_check(NULL), NS_E_NULL);
    assert_int_equal(ns_signal_check(&s), NS_E_NUMBER);
    s.kind = (ns_signal_kind)17;
    assert_int_equal(ns_signal_check(&s), NS_E_RANGE);
    assert_true(isnan(ns_signal_value(&s, 0, NS_LEFT)));
    assert_true(isnan(ns_signal_value(NULL, 0, NS_LEFT)));
    assert_true(isinf(ns_signal_next_corner(NULL, 0)));
    s = pulse(0, 1, 1, 1, 1, 1, 5);
    assert_true(isinf(ns_signal_next_corner(&s, NAN)));
    s = pulse(0, 1, NAN, 1, 1, 1, 5);
    assert_int_equal(ns_signal_check(&s), NS_E_NUMBER);
    s = pulse(0, 1, 0, -1, 1, 1, 5);
    assert_int_equal(ns_signal_check(&s), NS_E_RANGE);
    s = pulse(0, 1, 0, 1, 1, -1, 5);
    assert_int_equal(ns_signal_check(&s), NS_E_RANGE);
    s = pulse(0, 1, 0, 1, 1, 1, 0);
    assert_int_equal(ns_signal_check(&s), NS_E_RANGE);
    s = pulse(0, 1, 0, 1, 1, 1, NAN);
    assert_int_equal(ns_signal_check(&s), NS_E_NUMBER);
    s = pulse(0, 1, 0, 0, 0, INFINITY, INFINITY);
    assert_int_equal(ns_signal_check(&s), NS_OK);
    s = (ns_signal){.kind = NS_SIN};
    s.u.sin.phase = NAN;
    assert_int_equal(ns_signal_check(&s), NS_E_NUMBER);
    s = (ns_signal){.kind = NS_EXP};
    s.u.exp.tau1 = 1;
    assert_int_equal(ns_signal_check(&s), NS_E_RANGE); /* tau2 = 0 */
    s = pwl(0, t, v, NAN, 0);
    assert_int_equal(ns_signal_check(&s), NS_E_SIZE);
    s = pwl(2, NULL, v, NAN, 0);
    assert_int_equal(ns_signal_check(&s), NS_E_NULL);
    s = pwl(3, t, v, NAN, 0);
    assert_int_equal(ns_signal_check(&s), NS_E_RANGE);
    s = pwl(2, t, nan_v, NAN, 0);
    assert_int_equal(ns_signal_check(&s), NS_E_NUMBER);
    s = pwl(2, t, v, 0.5, 0);
    assert_int_equal(ns_signal_check(&s), NS_E_RANGE);
    s = pwl(2, t, v, 1, 0);
    assert_int_equal(ns_signal_check(&s), NS_E_RANGE); /* nothing behind the last point to repeat */
    s = pwl(2, t, v, 0, 0);
    assert_int_equal(ns_signal_check(&s), NS_OK);
}

/* Values inside its pieces are found another way where a pulse repeats for ever: to the last bit the same. */
static void for_ever_is_as_many_times(void **state) {
    (void)state;
    uint32_t random = 7;
    for (int k = 0; k < 200000; k++) {
        double part[6];
        for (int i = 0; i < 6; i++)
            part[i] = (random = random * 1664525u + 1013904223u) / 4294967296.0;
        const double per = 1e-5, tr = k % 3 ? part[0] * per / 3 : 0, tf = k % 2 ? part[1] * per / 3 : 1e-9;
        ns_signal s = {.kind = NS_PULSE,
                       .u.pulse = {-1, 2, part[2] * per, tr, tf, part[3] * per / 4, per, 0}};
        const double turns = floor(part[4] * pow(10, k % 9)), at = part[5] * per;
        const double t = s.u.pulse.td + turns * per + (k % 5 ? at : k % 7 ? tr : tr + s.u.pulse.pw);
        const ns_side side = k % 11 < 5 ? NS_LEFT : NS_RIGHT;
        const double for_ever = ns_signal_value(&s, t, side);
        s.u.pulse.cycles = 2000000000;
        assert_true(for_ever == ns_signal_value(&s, t, side));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dc_is_constant),
        cmocka_unit_test(pulse_follows_its_lines),
        cmocka_unit_test(pulse_corners_in_order),
        cmocka_unit_test(pulse_does_not_drift),
        cmocka_unit_test(corners_are_met_once),
        cmocka_unit_test(jumps_have_two_sides),
        cmocka_unit_test(value_at_a_corner_is_that_of_the_point),
        cmocka_unit_test(pulse_once_and_counted),
        cmocka_unit_test(pulse_longer_than_its_period),
        cmocka_unit_test(pulse_cut_while_it_rises),
        cmocka_unit_test(value_and_corner_agree),
        cmocka_unit_test(for_ever_is_as_many_times),
        cmocka_unit_test(sine),
        cmocka_unit_test(exponential),
        cmocka_unit_test(pwl_holds_jumps_and_shifts),
        cmocka_unit_test(pwl_repeats),
        cmocka_unit_test(periods_too_short_to_tell),
        cmocka_unit_test(bad_parameters_are_refused),
    };
    return cmocka_run_group_tests_name("signal", tests, NULL, NULL);
}
