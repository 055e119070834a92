/* tests/unit/march/test_choice.c - which of two engines costs less, by simulated engines whose costs are
 * given: what all of it costs, beside the cheaper one alone.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "dice.h"
#include "march/choice.h"

enum { STEPS = 100000 };
static const double first = 1000;

/* An engine: work for a second of circuit time, until `until` and after it, and work done once. */
typedef struct simulated {
    double rate, until, rate_after, once, done_once;
    int fails;
} simulated;

typedef struct simulation {
    simulated engine[2];
    int at_work;
    int questions;
    ns_work work;
    ns_choice choice;
} simulation;

/* Matrices are made along with the first steps: each of these does as much of both. */
static void step(simulation *s, double t, double dt) {
    simulated *e = &s->engine[s->at_work];
    const double all = (t < e->until ? e->rate : e->rate_after) * dt;
    const double once = fmin(e->once - e->done_once, 10 * all);
    e->done_once += once;
    s->work.once += once;
    s->work.all += all + once;
}

static void look(simulation *s, double t, double least) {
    const int asked = s->choice.asks;
    if (ns_march_choice_look(&s->choice, t, s->work, least) == NS_CHOICE_STAY)
        return;
    s->at_work = !s->at_work;
    s->questions += !asked;
    if (!asked && s->engine[s->at_work].fails) {
        s->at_work = !s->at_work;
        ns_march_choice_failed(&s->choice, t, s->work);
    } else
        ns_march_choice_changed(&s->choice, t, s->work);
}

/* From 0 to 1 s, beginning with the first engine. */
static double simulate(simulation *s, double least) {
    ns_march_choice_begin(&s->choice, 0, s->work, first);
    for (int i = 0; i < STEPS; i++) {
        look(s, (double)i / STEPS, least);
        step(s, (double)i / STEPS, 1.0 / STEPS);
    }
    return s->work.all;
}

static simulation two(double a, double b) {
    return (simulation){.engine = {{.rate = a, .until = 2}, {.rate = b, .until = 2}}};
}

static void the_cheaper_one_stays(void **state) {
    simulation s = two(1e6, 3e6);
    (void)state;
    assert_true(simulate(&s, 0) < 1.1e6);
    assert_int_equal(s.at_work, 0);
    assert_in_range(s.questions, 5, 10); /* 1000, 2000, 4000, ... until 1e6 */
}

static void the_cheaper_one_is_found(void **state) {
    simulation s = two(20e6, 1e6);
    (void)state;
    assert_true(simulate(&s, 0) < 1.1e6);
    assert_int_equal(s.at_work, 1);
}

/* Half of an interval at most is lost in it. */
static void one_that_crawls_is_left(void **state) {
    simulation s = two(1e6, 1e9);
    (void)state;
    assert_true(simulate(&s, 0) < 1.2e6);
    assert_int_equal(s.at_work, 0);
}

/* What has to be made once pays in the end. */
static void matrices_that_pay_are_made(void **state) {
    simulation s = two(50e6, 1e6);
    s.engine[1].once = 1e6;
    (void)state;
    assert_true(simulate(&s, 0) < 6e6); /* 2e6 by the second one alone */
    assert_int_equal(s.at_work, 1);
}

/* The one at work is not left for what it does once. */
static void matrices_that_were_made_are_used(void **state) {
    simulation s = two(1e6, 5e6);
    s.engine[0].once = 3 * first;
    (void)state;
    assert_true(simulate(&s, 0) < 1.1e6);
    assert_int_equal(s.at_work, 0);
}

static void one_that_fails_is_asked_ever_less(void **state) {
    simulation s = two(1e6, 1e3);
    s.engine[1].fails = 1;
    (void)state;
    assert_true(simulate(&s, 0) < 1.01e6);
    assert_in_range(s.questions, 3, 4); /* 1e3, 8e3, 64e3, 512e3 */
}

static void one_that_begins_to_crawl_is_left(void **state) {
    simulation s = two(1e5, 3e5);
    s.engine[0].until = 0.3;
    s.engine[0].rate_after = 1e8;
    (void)state;
    assert_true(simulate(&s, 0) < 3e4 + 2.1e5 + 0.3e5 + 1e4); /* the two alone, half an interval, twice */
    assert_int_equal(s.at_work, 1);
}

/* One that cannot be cheaper is not asked: events cost 10 here, at least 20 there. */
static void one_that_cannot_be_cheaper_is_not_asked(void **state) {
    simulation s = two(1e6, 1e3);
    (void)state;
    ns_march_choice_begin(&s.choice, 0, s.work, first);
    for (int i = 0; i < STEPS; i++) {
        look(&s, (double)i / STEPS, 20);
        step(&s, (double)i / STEPS, 1.0 / STEPS);
        s.work.events += 1;
    }
    assert_int_equal(s.questions, 0);
}

/* Whatever they cost, what comes once included, less than three times the better one and some intervals. */
static void never_much_more_than_the_better_one(void **state) {
    dice d = dice_make(1, 7);
    (void)state;
    for (int k = 0; k < 200; k++) {
        simulation s = two(dice_decades(&d, 4, 8), dice_decades(&d, 4, 8));
        for (int e = 0; e < 2; e++)
            s.engine[e].once = dice_chance(&d, 0.5) ? 0 : s.engine[e].rate * dice_uniform(&d);
        const double a = s.engine[0].rate + s.engine[0].once, b = s.engine[1].rate + s.engine[1].once;
        assert_true(simulate(&s, 0) < 3 * fmin(a, b) + 10 * first);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_cheaper_one_stays),
                                       cmocka_unit_test(the_cheaper_one_is_found),
                                       cmocka_unit_test(one_that_crawls_is_left),
                                       cmocka_unit_test(matrices_that_pay_are_made),
                                       cmocka_unit_test(matrices_that_were_made_are_used),
                                       cmocka_unit_test(one_that_fails_is_asked_ever_less),
                                       cmocka_unit_test(one_that_begins_to_crawl_is_left),
                                       cmocka_unit_test(one_that_cannot_be_cheaper_is_not_asked),
                                       cmocka_unit_test(never_much_more_than_the_better_one)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
