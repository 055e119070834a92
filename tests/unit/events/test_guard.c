/* tests/unit/events/test_guard.c - what a guard is about to do, by its value, rate and second rate. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "events/guard.h"

/* As with digits: the first number that is beyond what it may be off by decides, however small beside it what
 * follows; a number that is none breaks. */
static void the_first_number_decides(void **state) {
    const double off[] = {1, 1, 1}, falls[] = {0.5, -2, 1e9}, rises[] = {-1, 1, 1.5}, zero[] = {1, -1, 0.9},
                 none[] = {0, NAN, 7};
    (void)state;
    assert_int_equal(ns_events_sign(3, falls, off), -1);
    assert_int_equal(ns_events_sign(3, rises, off), 1);
    assert_int_equal(ns_events_sign(2, rises, off), 0); /* a rate is not asked for */
    assert_int_equal(ns_events_sign(3, zero, off), 0);
    assert_int_equal(ns_events_sign(3, none, off), -1);
}

/* 1 nA of rounding; -3 A/us, of which a time known to 1 ps makes 3 uA: the value counts beyond their sum. */
static void the_instant_is_known_no_better(void **state) {
    const double below = -3.002e-6, within = -3e-6;
    ns_guard of = {below, -3e6, 0, 1e-9};
    (void)state;
    assert_int_equal(ns_events_value_sign(&of, 1e-12), NS_SIGN_BREAKS);
    of.value = within;
    assert_int_equal(ns_events_value_sign(&of, 1e-12), NS_UNDECIDED);
    of.value = -below;
    assert_int_equal(ns_events_value_sign(&of, 1e-12), NS_SIGN_HOLDS);
}

/* A value of zero: rates over 1 us beside 1 nA of rounding.  A rate of 10 mA/s makes 10 nA, above 8; one of
 * 5 mA/s makes 5 nA, so that 100 kA/s^2, 100 nA, decides, and 50 kA/s^2 does not. */
static void rates_follow(void **state) {
    const double g = 1e-6;
    ns_guard of = {0, -10e-3, 100e3, 1e-9};
    (void)state;
    assert_int_equal(ns_events_value_sign(&of, 0), NS_UNDECIDED);
    assert_int_equal(ns_events_rate_sign(&of, 0, g), NS_SIGN_BREAKS);
    of.rate = 10e-3;
    assert_int_equal(ns_events_rate_sign(&of, 0, g), NS_SIGN_HOLDS);
    of.rate = -5e-3;
    assert_int_equal(ns_events_rate_sign(&of, 0, g), NS_SIGN_HOLDS);
    of.second_rate = 50e3;
    assert_int_equal(ns_events_rate_sign(&of, 0, g), NS_UNDECIDED);
    of.second_rate = -100e3;
    assert_int_equal(ns_events_rate_sign(&of, 0, g), NS_SIGN_BREAKS);
}

/* The rate at an instant that may be 50 ns off: 100 kA/s^2 make 5 mA/s of it, twice that counts. */
static void rates_at_an_instant_that_is_off(void **state) {
    ns_guard of = {0, 15e-3, -100e3, 1e-9};
    (void)state;
    assert_int_equal(ns_events_rate_sign(&of, 0, 1e-6), NS_SIGN_HOLDS);
    assert_int_equal(ns_events_rate_sign(&of, 50e-9, 1e-6), NS_SIGN_BREAKS);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_first_number_decides),
        cmocka_unit_test(the_instant_is_known_no_better),
        cmocka_unit_test(rates_follow),
        cmocka_unit_test(rates_at_an_instant_that_is_off),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
