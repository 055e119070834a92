/* tests/unit/bridge/test_diode_law.c - the voltage of ngspice's D at a current. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "diode_law.h"

static const double vt = 0.0258649; /* V, at 300 K */

/* v = n vt ln(1 + i/is). */
static void of_one_exponential(void **unused) {
    (void)unused;
    static const double is[] = {1e-14, 1e-9, 1e-3}, n[] = {1, 2, 1.05}, i[] = {1e-4, 0.1, 5};
    for (int k = 0; k < 3; k++) {
        const ns_diode_law law = {.bottom = {is[k], n[k] * vt}};
        const double expected = n[k] * vt * log1p(i[k] / is[k]);
        assert_true(fabs(ns_bridge_diode_law_voltage(&law, i[k]) - expected) < 1e-12);
        const double slope = n[k] * vt / (i[k] + is[k]); /* of n vt ln(1 + i/is) */
        assert_true(fabs(ns_bridge_diode_law_slope(&law, i[k]) / slope - 1) < 1e-5);
    }
}

/* High injection: i/(1 + sqrt(i/knee)) = knee/2 where i = knee, so v = vt ln(1 + knee/is). */
static void of_high_injection(void **unused) {
    (void)unused;
    const ns_diode_law law = {.bottom = {1e-12, vt}, .knee = 2};
    assert_true(fabs(ns_bridge_diode_law_voltage(&law, 1) - vt * log1p(2e12)) < 1e-12);
}

/* Two exponentials of the same voltage add up; recombination with vj so high that its factor is that at 0 V:
 * (1 + 0.005)^(m/2). */
static void of_sums(void **unused) {
    (void)unused;
    const ns_diode_law two = {.bottom = {1e-12, vt}, .side = {3e-12, vt}};
    const ns_diode_law recombines = {
        .bottom = {0, vt}, .recombination = {1e-9, 2 * vt}, .vj = 1e12, .m = 0.5};
    assert_true(fabs(ns_bridge_diode_law_voltage(&two, 1) - vt * log1p(1 / 4e-12)) < 1e-12);
    assert_true(fabs(ns_bridge_diode_law_voltage(&recombines, 1) -
                     2 * vt * log1p(1 / (1e-9 * pow(1.005, 0.25)))) < 1e-9);
}

/* At 1 A of one exponential the tangent has n vt/(i + is).  Up to 2 A it stays within a twentieth of the
 * curve; to 1000 A it does not, and the line ends there at 1.05 v(1000 A). */
static void line_of_what_it_carries(void **unused) {
    (void)unused;
    const ns_diode_law law = {.bottom = {1e-12, vt}};
    const double v1 = vt * log1p(1e12), v1000 = vt * log1p(1e15);
    assert_true(fabs(ns_bridge_diode_law_line(&law, 1, &(ns_line_ends){2, 2, 0}) / vt - 1) < 1e-5);
    assert_true(fabs(ns_bridge_diode_law_line(&law, 1, &(ns_line_ends){1, 1, 0}) / vt - 1) < 1e-5);
    assert_true(fabs(ns_bridge_diode_law_line(&law, 1, &(ns_line_ends){1000, 1000, 0}) -
                     (1.05 * v1000 - v1) / 999) < 1e-12);
}

/* In breakdown: 1 mA at 6 V, e times as much a thermal voltage higher; a line to 1000 times the current ends
 * a twentieth above the curve. */
static void breakdown(void **unused) {
    (void)unused;
    const ns_breakdown_law law = {6, 1e-3, vt};
    const double v1 = 6 + vt * log(1e3), v1000 = 6 + vt * log(1e6);
    assert_true(fabs(ns_bridge_breakdown_law_voltage(&law, 1e-3) - 6) < 1e-15);
    assert_true(fabs(ns_bridge_breakdown_law_voltage(&law, 1) - v1) < 1e-14);
    assert_true(fabs(ns_bridge_breakdown_law_line(&law, 1, &(ns_line_ends){2, 2, 0}) / vt - 1) < 1e-14);
    assert_true(fabs(ns_bridge_breakdown_law_line(&law, 1, &(ns_line_ends){1000, 1000, 0}) -
                     (1.05 * v1000 - v1) / 999) < 1e-12);
}

/* An inrush of 1000 A where the current is 2 A at most: where 5 V are blocked, the line ends a fiftieth of
 * that above the curve, where 1 V is blocked, a twentieth of the curve, which is more. */
static void line_of_a_rush(void **unused) {
    (void)unused;
    const ns_diode_law law = {.bottom = {1e-12, vt}};
    const double v1 = vt * log1p(1e12), v1000 = vt * log1p(1e15);
    const ns_line_ends five = {2, 1000, 5}, one = {2, 1000, 1}, thousands = {2, 1000, 2000};
    assert_true(fabs(ns_bridge_diode_law_line(&law, 1, &five) - (0.1 + v1000 - v1) / 999) < 1e-12);
    assert_true(fabs(ns_bridge_diode_law_line(&law, 1, &one) - (1.05 * v1000 - v1) / 999) < 1e-12);
    assert_true(fabs(ns_bridge_diode_law_line(&law, 1, &thousands) / vt - 1) < 1e-5);
}

/* At 1 A, an inrush of 40 A where the current is 1 A or 3 A at most: one line for both would be flatter than
 * the tangent; so there is the tangent, up to 2.5 A or 3 A, and a second line from there to the curve at 40
 * A. One line is left where there is no inrush, or where the tangent at 40 A is above the curve by less than
 * a fiftieth of 100 V. */
static void two_lines_of_a_rush(void **unused) {
    (void)unused;
    const ns_diode_law law = {.bottom = {1e-12, vt}};
    const double v1 = vt * log1p(1e12), v40 = vt * log1p(4e13);
    const ns_diode_lines one = ns_bridge_diode_law_lines(&law, 1, &(ns_line_ends){1, 40, 1}),
                         three = ns_bridge_diode_law_lines(&law, 1, &(ns_line_ends){3, 40, 1});
    assert_true(fabs(one.slope / vt - 1) < 1e-5 && one.knee == 2.5);
    assert_true(fabs(one.beyond - (v40 - v1 - 1.5 * vt) / 37.5) < 1e-7);
    assert_true(fabs(three.slope / vt - 1) < 1e-5 && three.knee == 3);
    assert_true(fabs(three.beyond - (v40 - v1 - 2 * vt) / 37) < 1e-7);
    assert_true(ns_bridge_diode_law_lines(&law, 1, &(ns_line_ends){1, 1, 1}).knee == 0);
    assert_true(ns_bridge_diode_law_lines(&law, 1, &(ns_line_ends){1, 40, 100}).knee == 0);
}

/* No second line where the first one is above the curve at the inrush: it ends a twentieth (37 mV) above the
 * curve at 4 A, which rises by 6 mV up to 5 A; and none where the inrush, of 2.4 A, comes before the knee. */
static void one_line_of_a_near_rush(void **unused) {
    (void)unused;
    const ns_diode_law law = {.bottom = {1e-12, vt}}, low = {.bottom = {0.1, vt}};
    const ns_line_ends five = {4, 5, 0}, near = {1, 2.4, 0};
    const ns_diode_lines a = ns_bridge_diode_law_lines(&law, 1, &five),
                         b = ns_bridge_diode_law_lines(&low, 1, &near);
    assert_true(a.knee == 0 && a.slope == ns_bridge_diode_law_line(&law, 1, &five));
    assert_true(b.knee == 0 && b.slope == ns_bridge_diode_law_line(&low, 1, &near));
    assert_true(b.slope < 0.99 * ns_bridge_diode_law_slope(&low, 1));
}

static void none(void **unused) {
    (void)unused;
    const ns_diode_law nothing = {.bottom = {0, vt}}, slow = {.bottom = {1e-14, 100}};
    assert_true(isnan(ns_bridge_diode_law_voltage(&nothing, 0.1)));
    assert_true(isnan(ns_bridge_diode_law_voltage(&slow, 0.1)));
    assert_true(ns_bridge_diode_law_current(&nothing, 1) == 0);
}

/* 1 A for 4 s and 4 A for 1 s carry 4 C each: 2 A; 1 A for 16 s more: (4 ln 4)/(4 + 20) is the logarithm of
 * 4^(1/6) A; what is below 1 nA, and no time, do not count. */
static void mean_of_logarithms(void **unused) {
    (void)unused;
    ns_log_mean mean = {0, 0, 0};
    assert_true(ns_bridge_log_mean_read(&mean) == 0);
    ns_bridge_log_mean_add(&mean, 1, 4, 1e-9);
    ns_bridge_log_mean_add(&mean, 4, 1, 1e-9);
    ns_bridge_log_mean_add(&mean, 1e-10, 5, 1e-9);
    ns_bridge_log_mean_add(&mean, 1, 0, 1e-9);
    ns_bridge_log_mean_add(&mean, INFINITY, 1, 1e-9);
    assert_true(fabs(ns_bridge_log_mean_read(&mean) - 2) < 1e-15);
    assert_true(mean.most == 4);
    ns_bridge_log_mean_add(&mean, 1, 16, 1e-9);
    assert_true(fabs(ns_bridge_log_mean_read(&mean) - pow(4, 1.0 / 6)) < 1e-15);
}

/* 100 A for 1 s at 0 s, then from 9 s on, every 9 s, 1 A for 1 s and 3 A for 1 s: 2 A in the mean.  The first
 * one counts by the root of 1 s * 9 s, ten others by that of 2 s * 9 s: (3 ln 100 + 10 4.2426 ln 2)/(3
 * + 42.426).  Over the charge it would be 33 A.  What is not over yet counts with its logarithm over the
 * charge; leaks beside it do not. */
static void pulses(void **unused) {
    (void)unused;
    ns_pulse_mean mean = {.is_over = 0};
    ns_bridge_pulse_mean_end(&mean, 0);
    assert_true(ns_bridge_pulse_mean_read(&mean) == 0);
    ns_bridge_pulse_mean_add(&mean, 1, 100, 0, 1);
    ns_bridge_pulse_mean_add(&mean, 0, 100, 1, 9);
    for (int k = 1; k <= 10; k++) {
        ns_bridge_pulse_mean_add(&mean, 1, 1, 9 * k, 9 * k + 1);
        ns_bridge_pulse_mean_add(&mean, 1, 3, 9 * k + 1, 9 * k + 2);
        ns_bridge_pulse_mean_add(&mean, 1, 0, 9 * k + 2, 9 * k + 9);
    }
    ns_bridge_pulse_mean_end(&mean, 99);
    const double each = sqrt(18), expected = (3 * log(100) + 10 * each * log(2)) / (3 + 10 * each);
    assert_true(fabs(log(ns_bridge_pulse_mean_read(&mean)) - expected) < 1e-13);
    assert_true(mean.most == 100);
    ns_bridge_pulse_mean_add(&mean, 1, 1e-12, 99, 1e6);
    ns_bridge_pulse_mean_end(&mean, 1e6);
    assert_true(fabs(log(ns_bridge_pulse_mean_read(&mean)) - expected) < 1e-8);
    ns_pulse_mean goes_on = {.is_over = 0};
    ns_bridge_pulse_mean_add(&goes_on, 1, 1, 0, 4);
    ns_bridge_pulse_mean_add(&goes_on, 1, 4, 4, 5);
    ns_bridge_pulse_mean_end(&goes_on, 5);
    assert_true(fabs(ns_bridge_pulse_mean_read(&goes_on) - 2) < 1e-15);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(of_one_exponential),
                                       cmocka_unit_test(of_high_injection),
                                       cmocka_unit_test(of_sums),
                                       cmocka_unit_test(line_of_what_it_carries),
                                       cmocka_unit_test(line_of_a_rush),
                                       cmocka_unit_test(two_lines_of_a_rush),
                                       cmocka_unit_test(one_line_of_a_near_rush),
                                       cmocka_unit_test(breakdown),
                                       cmocka_unit_test(pulses),
                                       cmocka_unit_test(none),
                                       cmocka_unit_test(mean_of_logarithms)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
