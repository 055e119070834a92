/* tests/unit/events/test_ties.c - what happens in one instant, and how much of it. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "events/crowd.h"
#include "events/ties.h"

static double control[1] = {1};

static void which_commands_change_together(void **state) {
    const ns_command timed = {.on = 1, .off = 1}, sharp = {.gx = control, .on = 1, .off = 1},
                     lasting = {.gx = control, .on = 1, .off = 0.5};
    (void)state;
    assert_int_equal(ns_events_tie(&timed, NS_LOWER), NS_TIE_NONE);
    assert_int_equal(ns_events_tie(&sharp, NS_INSIDE), NS_TIE_SAME);
    assert_int_equal(ns_events_tie(&sharp, NS_SLIDES_UP), NS_TIE_NONE);
    assert_int_equal(ns_events_tie(&lasting, NS_LOWER), NS_TIE_MET);
    assert_true(ns_events_slides(&sharp, 1));
    assert_false(ns_events_slides(&sharp, 0)); /* it changes for the first time here */
    assert_false(ns_events_slides(&lasting, 1));
    assert_false(ns_events_slides(&timed, 1));
    assert_int_equal(ns_events_sliding_mode(2), NS_SLIDES_UP);
    assert_int_equal(ns_events_sliding_mode(-2), NS_SLIDES_DOWN);
}

/* 1 nV at 1 V/s takes 1 ns, of h = 1 us and of 1.1 us; a control that rises never arrives. */
static void a_threshold_beside_another(void **state) {
    (void)state;
    assert_true(fabs(ns_events_delay(1e-9, -1, 1.1e-6) - 1e-9) < 1e-24);
    assert_true(isinf(ns_events_delay(1e-9, -1, 1e-6))); /* 1 us / 1024 is less */
    assert_true(isinf(ns_events_delay(1e-9, 1, 1)));
}

/* Those within 1 s of the first one count. */
static void events_in_a_window(void **state) {
    ns_event_window w = {0};
    (void)state;
    assert_int_equal(ns_events_count(&w, 5, 1), 1);
    assert_int_equal(ns_events_count(&w, 5.75, 1), 2);
    assert_int_equal(ns_events_count(&w, 6, 1), 3);
    assert_int_equal(ns_events_count(&w, 6.5, 1), 1);
    assert_int_equal(ns_events_count(&w, 7.25, 1), 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(which_commands_change_together),
        cmocka_unit_test(a_threshold_beside_another),
        cmocka_unit_test(events_in_a_window),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
