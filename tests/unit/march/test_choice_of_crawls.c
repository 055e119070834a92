/* tests/unit/march/test_choice_of_crawls.c - an engine that begins to crawl after a long run: when the other
 * one is asked, over what, and how long it may go on.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "march/choice.h"

static const double first = 1000;

static ns_work work_of(double all, double events) {
    return (ns_work){.all = all, .events = events};
}

/* A choice that begins at 2 s with 300 of work done, and looks again after so much time and work. */
static ns_choice begun(void) {
    ns_choice c = {0};
    ns_march_choice_begin(&c, 2, work_of(300, 0), first);
    return c;
}

static ns_choice_answer look_after(ns_choice *c, double time, double spent, double events, double least) {
    return ns_march_choice_look(c, 2 + time, work_of(300 + spent, events),
                                (ns_choice_bounds){least, INFINITY, 0, 0});
}

/* 500 per second against the other one, which is asked at 4 s with 1300 done, over what costs 125. */
static ns_choice asked(void) {
    ns_choice c = begun();
    assert_int_equal(look_after(&c, 2, 1000, 0, 0), NS_CHOICE_CHANGE);
    ns_march_choice_changed(&c, 4, work_of(1300, 0));
    assert_true(c.asks == 1 && c.whole == 125);
    return c;
}

/* An inductor that rings with a capacitor through a diode, by less than what sparse resolves, has an event a
 * period by exact (short-pulses 98502000000 of the stress set: 1.4 s, 0.3 s by sparse).  From 0.5 to 1 s
 * events crowd for the first engine, and cost 10 each, at least 20 there; until 0.51 s the other one resolves
 * them, too. */
static void one_that_has_no_such_events_is_found(void **state) {
    enum { STEPS = 100000 };
    ns_choice c = {0};
    ns_work work = {0};
    int second = 0;
    (void)state;
    ns_march_choice_begin(&c, 0, work, first);
    for (int i = 0; i < STEPS; i++) {
        const double t = (double)i / STEPS,
                     cost = (second ? (t < 0.51 ? 2e7 : 2e4) : (t < 0.5 ? 1e4 : 1e7)) / STEPS;
        if (ns_march_choice_look(&c, t, work, (ns_choice_bounds){20, INFINITY, 0, 0}) == NS_CHOICE_CHANGE) {
            second = !second;
            ns_march_choice_changed(&c, t, work);
        }
        work.all += cost;
        work.events += second ? 0 : cost / 10;
    }
    assert_int_equal(second, 1);
    assert_true(work.all < 4e5); /* 5e6 by the first one alone */
}

/* 500 per second: one that needs 0.75 to 0.95 of that is not left where it would be; amid a transient it may
 * be through first. */
static void when_the_one_asked_goes_on(void **state) {
    ns_choice c = asked();
    (void)state;
    assert_int_equal(look_after(&c, 2.3, 1126, 0, 0), NS_CHOICE_STAY); /* 0.84: the next part, of 250 */
    assert_int_equal(c.asks, 1);
    assert_int_equal(look_after(&c, 2.81, 1377, 0, 0), NS_CHOICE_STAY); /* 0.98: of 500 */
    assert_int_equal(c.asks, 1);
    ns_choice other = c;
    assert_int_equal(look_after(&c, 4.81, 1500, 0, 0), NS_CHOICE_STAY); /* it is through */
    assert_int_equal(c.asks, 0);
    assert_int_equal(look_after(&other, 3.5, 1878, 0, 0), NS_CHOICE_CHANGE); /* 1.45 */
}

/* 50 per second for long: then 10000, which no mean of all shows so soon.  The answer is no: such a stretch
 * counts for the answer alone, and the next question of its kind comes after twice as much. */
static void when_one_crawls_after_long(void **state) {
    ns_choice c = begun();
    (void)state;
    assert_int_equal(look_after(&c, 20, 1000, 1000, 7), NS_CHOICE_STAY);
    assert_true(c.usual == 50);
    c.interval = 1e5; /* after a long run */
    for (int i = 1; i <= 9; i++)
        assert_int_equal(look_after(&c, 20 + 2 * i, 1000 + 100 * i, 1000, 7), NS_CHOICE_STAY);
    double spent = 1900, time = 38;
    while (look_after(&c, time, spent, 1000, 7) == NS_CHOICE_STAY) {
        assert_true(spent < 1900 + 2 * 500 + 100);
        spent += 100;
        time += 0.01;
    }
    assert_true(c.usual > 5e3);
    ns_march_choice_changed(&c, 2 + time, work_of(300 + spent, 0));
    assert_true(c.asks && c.whole > 500 && c.whole < 1500); /* not an eighth of the interval */
    assert_int_equal(look_after(&c, time + 0.01, spent + 1600, 0, 0), NS_CHOICE_CHANGE);
    ns_march_choice_changed(&c, 2 + time + 0.01, work_of(1900 + spent, 0));
    assert_true(!c.asks && c.usual == 50 && c.interval == 1e5 && c.patience == 1000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_that_has_no_such_events_is_found),
        cmocka_unit_test(when_the_one_asked_goes_on),
        cmocka_unit_test(when_one_crawls_after_long),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
