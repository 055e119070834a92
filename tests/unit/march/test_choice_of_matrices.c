/* tests/unit/march/test_choice_of_matrices.c - an engine that is asked makes matrices of modes: for how much
 * work, against what, and where starts are dear.
 *
 * A Cockcroft-Walton multiplier (cockcroft-walton 98001000000 of the stress set) went on by sparse for half
 * of its run, at 2.6 times the work of exact: each question was over before all 35 modes had matrices.  A
 * bridge of thyristors (six-pulse-thyristor 98501000000) asked sparse, and a new start of exact took as much
 * as all that exact had done.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "march/choice.h"

static const ns_choice_bounds nothing = {0, INFINITY, 0, 0};

/* From 2 s on, with 300 of work done: 500 a second, 1000 until the other one is asked at 4 s; 100 events, of
 * which so many ended new modes. */
static ns_choice asked(double modes) {
    ns_choice c = {0};
    ns_work work = {.all = 300};
    ns_march_choice_begin(&c, 2, work, 1000);
    work = (ns_work){.all = 1300, .events = 100, .modes = modes};
    assert_int_equal(ns_march_choice_look(&c, 4, work, nothing), NS_CHOICE_CHANGE);
    ns_march_choice_changed(&c, 4, work);
    assert_true(c.asks == 1 && c.usual == 500);
    return c;
}

static ns_choice_answer look(ns_choice *c, double after, double spent, double once) {
    const ns_work work = {.all = 1300 + spent, .once = once, .events = 100, .modes = 10};
    return ns_march_choice_look(c, 4 + after, work, nothing);
}

/* Half of an interval; where modes recur, as much as the other one took. */
static void as_much_as_the_other_one_took(void **state) {
    (void)state;
    ns_choice c = asked(50);
    assert_int_equal(look(&c, 0.02, 499, 495), NS_CHOICE_STAY);
    assert_int_equal(look(&c, 0.02, 501, 497), NS_CHOICE_CHANGE);
    c = asked(10);
    assert_true(ns_march_choice_limit(&c) == 1300 + 1000 + 500);
    assert_int_equal(look(&c, 0.02, 999, 995), NS_CHOICE_STAY);
    assert_int_equal(look(&c, 0.02, 1001, 997), NS_CHOICE_CHANGE);
}

/* What a question took is not there for the next one: 1000 and 2000, less 1001. */
static void less_what_was_spent_before(void **state) {
    (void)state;
    ns_choice c = asked(10);
    ns_work work = {.all = 2301, .once = 997, .events = 100, .modes = 10};
    assert_int_equal(ns_march_choice_look(&c, 4.02, work, nothing), NS_CHOICE_CHANGE);
    ns_march_choice_changed(&c, 4.02, work);
    work = (ns_work){.all = 4301, .once = 997, .events = 300, .modes = 12};
    assert_int_equal(ns_march_choice_look(&c, 8, work, nothing), NS_CHOICE_CHANGE);
    ns_march_choice_changed(&c, 8, work);
    assert_true(fabs(ns_march_choice_limit(&c) - (4301 + 1999 + 1000)) < 1e-9);
}

/* 600 for matrices where the other one takes 150; then 60 where it takes 300. */
static void what_was_made_does_not_count_later(void **state) {
    (void)state;
    ns_choice c = asked(10);
    assert_int_equal(look(&c, 0.3, 600, 590), NS_CHOICE_STAY);
    assert_int_equal(c.asks, 1);
    assert_int_equal(look(&c, 0.7, 640, 590), NS_CHOICE_STAY); /* the next part is twice as long */
    assert_int_equal(c.asks, 1);
    assert_int_equal(look(&c, 0.9, 660, 590), NS_CHOICE_STAY);
    assert_int_equal(c.asks, 0);
}

/* Of two that come back to one another each is asked half as often. */
static void those_that_alternate_are_asked_less(void **state) {
    (void)state;
    ns_choice c = asked(10);
    ns_work work = {.all = 1301, .events = 110, .modes = 10};
    assert_int_equal(ns_march_choice_look(&c, 5, work, nothing), NS_CHOICE_STAY);
    assert_true(c.asks == 0 && c.interval == 1000);
    work.all += 1000;
    work.events += 10;
    assert_int_equal(ns_march_choice_look(&c, 25, work, nothing),
                     NS_CHOICE_CHANGE); /* as it was: not slower */
    ns_march_choice_changed(&c, 25, work);
    work.all += 1;
    assert_int_equal(ns_march_choice_look(&c, 28, work, nothing), NS_CHOICE_STAY);
    assert_true(c.asks == 0 && c.interval == 2000);
}

/* The other one is not asked before four starts of the one at work. */
static void where_a_start_is_dear(void **state) {
    ns_choice c = {0};
    ns_work work = {.all = 300};
    (void)state;
    ns_march_choice_begin(&c, 2, work, 1000);
    ns_march_choice_began(&c, 500);
    work.all += 1999;
    assert_int_equal(ns_march_choice_look(&c, 4, work, nothing), NS_CHOICE_STAY);
    work.all += 1;
    assert_int_equal(ns_march_choice_look(&c, 4, work, nothing), NS_CHOICE_CHANGE);
}

/* 20 for each of 100 events in a second, which the other one cannot pass for less than 25; then as many in a
 * hundredth of that time, which it may not have: an exact engine that chattered (short-pulses 98502000000 of
 * the stress set) was never left. */
static void where_it_crawls_by_cheap_events(void **state) {
    static const ns_choice_bounds event = {25, INFINITY, 0, 0};
    ns_choice c = {0};
    ns_work work = {.all = 300};
    (void)state;
    ns_march_choice_begin(&c, 2, work, 1000);
    work = (ns_work){.all = 2300, .events = 100};
    assert_int_equal(ns_march_choice_look(&c, 3, work, event), NS_CHOICE_STAY);
    work = (ns_work){.all = 4300, .events = 200};
    assert_int_equal(ns_march_choice_look(&c, 4, work, event), NS_CHOICE_STAY);
    work = (ns_work){.all = 6300, .events = 300};
    assert_int_equal(ns_march_choice_look(&c, 4.01, work, event), NS_CHOICE_CHANGE);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(as_much_as_the_other_one_took),
        cmocka_unit_test(less_what_was_spent_before),
        cmocka_unit_test(what_was_made_does_not_count_later),
        cmocka_unit_test(those_that_alternate_are_asked_less),
        cmocka_unit_test(where_a_start_is_dear),
        cmocka_unit_test(where_it_crawls_by_cheap_events),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
