/* tests/unit/ladder/test_ladder.c - the ladder's steps from inside: lengths, location, bounds, captured
 * events. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "ladder/ladder_internal.h"
#include "systems.h"

/* The LC bridge (systems.h) at 10 V on the capacitor; no command, no input. */
typedef struct bench {
    ns_system *s;
    ns_theta *step;
    ns_dense_point point;
    unsigned char flip[1];
    ns_ladder *l;
} bench;

static const double h = 1e-5;

static void make(bench *b) {
    const ns_theta_options o = {1, 1, 0};
    const double w0[2] = {1e-6 * 10, 0};
    *b = (bench){.s = system_lc_bridge()};
    b->point.flip = b->flip;
    assert_int_equal(ns_theta_create(b->s, &o, &b->step, NULL), NS_OK);
    assert_int_equal(ns_ladder_create(b->step, &b->point, h, &b->l), NS_OK);
    assert_int_equal(ns_ladder_start(b->l, 0, w0, NULL), NS_OK);
    assert_int_equal(ns_ladder_find_consistent(b->l), NS_OK);
    assert_int_equal(ns_ladder_end_start(b->l), 1);
    ns_ladder_begin_trial(b->l, 5e-3);
}

static void unmake(bench *b) {
    ns_ladder_free(b->l);
    ns_theta_free(b->step);
    ns_system_free(b->s);
}

static double volts(bench *b) {
    double x[2];
    assert_int_equal(ns_theta_read(b->step, x, NULL, NULL), NS_OK);
    return x[0];
}

/* h/2^20, or the first h 2^-k that moves t by 16 eps or more: at t = 2^17 s that is 2^-31 s. */
static void steps_at_events_are_visible_in_t(void **state) {
    (void)state;
    bench b;
    make(&b);
    b.point.now.t = 0;
    assert_true(ns_ladder_short_step(b.l) == ldexp(h, -20));
    b.point.now.t = 0x1p17;
    const double late = ns_ladder_short_step(b.l);
    assert_true(late >= 0x1p-31 && late < 0x1p-30);
    b.point.now.t = 1e12; /* nothing up to h is visible: h */
    assert_true(ns_ladder_short_step(b.l) >= h && ns_ladder_short_step(b.l) < 2 * h);
    unmake(&b);
}

/* v falls through 0 at some 1e5 V/s: located to h/2^20 = 9.5e-12 s, before which v is at most two such steps
 * above 0. */
static void an_event_is_located_from_the_left(void **state) {
    (void)state;
    bench b;
    make(&b);
    const long before = b.l->events;
    assert_int_equal(ns_ladder_walk(b.l, 5e-3), NS_OK);
    assert_int_equal(b.point.at_event, 1);
    assert_int_equal(b.point.input_jumps, 0);
    assert_true(b.point.now.t > 1e-4 &&
                b.point.now.t < 2e-4); /* a quarter of 2 pi 100 us: 157 us, and damping */
    const double v = volts(&b);
    assert_true(v >= 0 && v < 2.5e-6);
    b.l->limit = 5e-3;
    assert_int_equal(ns_ladder_event_resolve(b.l), NS_OK);
    assert_int_equal(b.point.at_event, 0);
    assert_int_equal(b.l->events, before + 1);
    assert_true(volts(&b) < v);
    unmake(&b);
}

/* The last step ends at the stop itself, and what t lost in rounding stays below a step of the ladder. */
static void a_stop_is_hit(void **state) {
    (void)state;
    bench b;
    make(&b);
    const double stop = 7.3 * h;
    assert_int_equal(ns_ladder_walk(b.l, stop), NS_OK);
    assert_true(b.point.now.t == stop);
    assert_int_equal(b.point.at_event, 0);
    assert_true(fabs(b.point.now.lost) < ldexp(h, -30));
    unmake(&b);
}

static void steps_are_bounded(void **state) {
    (void)state;
    bench b;
    make(&b);
    assert_true(b.l->budget >= 4000);
    b.l->budget = 3;
    assert_int_equal(ns_ladder_walk(b.l, 50 * h), NS_E_LIMIT);
    assert_true(b.point.now.t <= 4 * h); /* three steps, and what the start took */
    unmake(&b);
}

/* More than 16 events within h: none is located until h has passed, (P1) at the ends of steps of h/4. */
static void many_events_are_captured(void **state) {
    (void)state;
    bench b;
    make(&b);
    assert_int_equal(ns_ladder_walk(b.l, 5e-3), NS_OK); /* to the left side of an event */
    const double t = b.point.now.t;
    const long trials = ns_theta_counts(b.step)->trials, problems = ns_theta_counts(b.step)->problems;
    b.l->window = (ns_event_window){t, 17};
    assert_int_equal(ns_ladder_walk(b.l, t + 0.75 * h), NS_OK);
    assert_int_equal(b.point.at_event, 0);
    assert_int_equal(ns_theta_counts(b.step)->trials, trials + 3);
    assert_true(ns_theta_counts(b.step)->problems > problems);
    assert_true(volts(&b) < 0); /* beyond the event */
    assert_int_equal(b.l->window.events, 17);
    assert_int_equal(ns_ladder_walk(b.l, t + 1.5 * h), NS_OK);
    assert_int_equal(b.l->window.events, 0);
    b.l->window = (ns_event_window){b.point.now.t, 16}; /* these are not too many */
    assert_int_equal(ns_ladder_walk(b.l, 5e-3), NS_OK);
    assert_int_equal(b.point.at_event, 1);
    unmake(&b);
}

static void counts_of_events_follow_the_trial(void **state) {
    (void)state;
    bench b;
    make(&b);
    b.l->window = (ns_event_window){1, 5};
    ns_ladder_accept(b.l);
    b.l->window.events = 9;
    b.l->corner = 3;
    ns_ladder_drop(b.l);
    assert_int_equal(b.l->window.events, 5);
    assert_true(b.l->corner == -INFINITY); /* looked for anew */
    unmake(&b);
}

/* Controls beyond 0.5 V by 1e-4 V, beside an unknown of 1e9: a rounding of it by 1e-12, 1e-3, would hide that
 * only from a control that has a gain of 1, not from one of 1e-3. */
static void rounding_of_a_control_at_a_start(void **state) {
    (void)state;
    for (int small = 0; small < 2; small++) {
        const ns_theta_options o = {1, 1, 0};
        const double gain = small ? 1e-3 : 1, w0[2] = {0.5001 / gain, 1e9};
        unsigned char flip[1], at_event[1];
        ns_dense_point point = {.flip = at_event};
        ns_system *s;
        ns_theta *step;
        ns_ladder *l;
        assert_int_equal(ns_system_create(2, 1, 0, 1, &s), NS_OK);
        s->M[0] = s->M[3] = s->D[0] = 1;
        s->l[0] = -INFINITY;
        s->u[0] = INFINITY;
        s->command[0] = (ns_command){.pair = 0, .on = 0.5, .off = 0.5, .gx = calloc(2, sizeof(double))};
        assert_non_null(s->command[0].gx);
        s->command[0].gx[0] = gain;
        assert_int_equal(ns_theta_create(s, &o, &step, NULL), NS_OK);
        assert_int_equal(ns_ladder_create(step, &point, h, &l), NS_OK);
        assert_int_equal(ns_ladder_start(l, 0, w0, NULL), NS_OK);
        assert_int_equal(ns_ladder_find_consistent(l), NS_OK);
        const double x[2] = {w0[0], w0[1]};
        flip[0] = 9;
        assert_int_equal(ns_ladder_switch_at_start(l, x, NULL, flip), small);
        assert_int_equal(flip[0], small);
        ns_ladder_free(l);
        ns_theta_free(step);
        ns_system_free(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(steps_at_events_are_visible_in_t),
                                       cmocka_unit_test(an_event_is_located_from_the_left),
                                       cmocka_unit_test(a_stop_is_hit),
                                       cmocka_unit_test(steps_are_bounded),
                                       cmocka_unit_test(many_events_are_captured),
                                       cmocka_unit_test(counts_of_events_follow_the_trial),
                                       cmocka_unit_test(rounding_of_a_control_at_a_start)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
