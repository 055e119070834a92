/* tests/unit/bridge/test_timepoints.c - where ngspice's timepoints should be. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "timepoints.h"

enum { BREAKS = 5 };

/* A run of 100 s in steps of 1 s, with breakpoints at 10, 10.4, 20, 40 and the end, and one input whose
 * corners are at 5, 6, 15.5 and 16. */
typedef struct rig {
    double breaks[BREAKS];
    ns_timepoints points;
    ns_system *system;
} rig;

static rig *set_up(rig *r) {
    const ns_signal pulse = {.kind = NS_PULSE,
                             .u.pulse = {.v2 = 1.0, .td = 5.0, .tr = 1.0, .tf = 0.5, .pw = 9.5, .per = 1e3}};
    const double breaks[BREAKS] = {10.0, 10.4, 20.0, 40.0, 100.0};
    *r = (rig){.points = {.step = 1.0,
                          .at_corners = 1,
                          .stop = 100.0,
                          .min_break = 5e-5,
                          .max_step = 1.0,
                          .nbreaks = BREAKS}};
    for (int k = 0; k < BREAKS; k++) {
        r->breaks[k] = breaks[k];
    }
    r->points.breaks = r->breaks;
    assert_int_equal(ns_system_create(1, 0, 1, 0, &r->system), NS_OK);
    assert_int_equal(ns_system_set_input(r->system, 0, &pulse), NS_OK);
    return r;
}

static void tear_down(rig *r) {
    ns_system_free(r->system);
}

/* The timepoint after t, which the marcher has accepted too. */
static double next_of(rig *r, double t) {
    r->points.t = t;
    return ns_bridge_timepoints_next(&r->points, r->system, t);
}

static void assert_near(double got, double wanted) {
    if (!(fabs(got - wanted) <= 1e-12 * fabs(wanted))) {
        fail_msg("%.17g, expected %.17g", got, wanted);
    }
}

static void the_grid_corners_and_breakpoints(void **state) {
    static const double from_to[][2] = {
        {0.0, 1.0},   {2.5, 3.0},   {3.9999, 5.0}, /* a sliver before the grid counts as there */
        {5.0, 6.0},   {9.0, 10.0},  {10.0, 10.4},  {10.4, 11.0}, {15.0, 15.5},
        {15.5, 16.0}, {16.0, 17.0}, {39.0, 40.0},  {99.5, 100.0}};
    rig r;
    (void)state;
    set_up(&r);
    for (size_t k = 0; k < sizeof from_to / sizeof from_to[0]; k++) {
        assert_near(next_of(&r, from_to[k][0]), from_to[k][1]);
        assert_near(r.points.max_step, 1.002);
    }
    tear_down(&r);
}

static void a_break_just_behind_the_grid_replaces_it(void **state) {
    rig r;
    (void)state;
    set_up(&r)->breaks[0] = 3.0009;
    assert_near(next_of(&r, 2.0), 3.0009);
    tear_down(&r);
    set_up(&r)->breaks[0] = 3.0011;
    assert_near(next_of(&r, 2.0), 3.0);
    tear_down(&r);
    set_up(&r)->points.step = 2.0; /* then closer than 2 ms */
    r.breaks[0] = 4.0015;
    assert_near(next_of(&r, 2.0), 4.0015);
    tear_down(&r);
}

static void breaks_that_are_reached_go(void **state) {
    rig r;
    (void)state;
    set_up(&r);
    next_of(&r, 9.9999);
    assert_int_equal(r.points.nbreaks, 5);
    next_of(&r, 9.99996); /* closer than the least distance of two */
    assert_int_equal(r.points.nbreaks, 4);
    assert_near(r.breaks[0], 10.4);
    next_of(&r, 20.0);
    assert_int_equal(r.points.nbreaks, 2);
    assert_true(r.breaks[0] == 40.0 && r.breaks[1] == 100.0);
    next_of(&r, 40.0); /* ngspice reads two */
    assert_int_equal(r.points.nbreaks, 2);
    assert_true(r.breaks[0] == 100.0 && r.breaks[1] == 100.0);
    tear_down(&r);
}

static void without_corners_the_grid_alone(void **state) {
    rig r;
    (void)state;
    set_up(&r)->points.at_corners = 0;
    assert_near(next_of(&r, 5.0), 6.0);
    assert_near(next_of(&r, 10.0), 11.0);
    assert_near(next_of(&r, 15.0), 16.0);
    assert_near(next_of(&r, 99.5), 100.0);
    assert_int_equal(r.points.nbreaks, 2);
    assert_true(r.breaks[0] == 100.0 && r.breaks[1] == 100.0);
    assert_int_equal(ns_bridge_timepoints_at_events(&r.points), 0);
    tear_down(&r);
}

static void before_tstart_long_steps_that_meet_it(void **state) {
    rig r;
    double t = 0.0;
    int steps = 0;
    (void)state;
    set_up(&r)->points.start = 9.1;
    while (t < 9.1) {
        const double next = next_of(&r, t);
        assert_int_equal(ns_bridge_timepoints_at_events(&r.points), 0);
        assert_near(r.points.max_step, 2.0); /* a fiftieth of the run */
        assert_true(next - t <= 2.0 && next - t > 0.5);
        t = next;
        steps++;
    }
    assert_near(t, 9.1);
    assert_int_equal(steps, 5);
    r.points.t = t;
    assert_int_equal(ns_bridge_timepoints_at_events(&r.points), 1);
    tear_down(&r);
}

static void the_last_two_steps_before_tstart_are_equal(void **state) {
    rig r;
    (void)state;
    set_up(&r)->points.start = 50.0; /* steps of 2 s */
    assert_near(next_of(&r, 46.9), 48.9);
    assert_near(next_of(&r, 47.1), 48.55);
    assert_near(next_of(&r, 47.9), 48.95);
    assert_near(next_of(&r, 48.1), 50.0);
    tear_down(&r);
}

static void the_start_of_uic_is_shown_just_after_0(void **state) {
    rig r;
    (void)state;
    set_up(&r)->points.skips_start = 1;
    assert_near(next_of(&r, 0.0), 1.0 / 1048576.0 > 5e-5 ? 1.0 / 1048576.0 : 5e-5);
    r.points.min_break = 1e-12;
    assert_near(next_of(&r, 0.0), 1.0 / 1048576.0);
    tear_down(&r);
}

static void always_ahead_of_what_was_accepted(void **state) {
    rig r;
    (void)state;
    set_up(&r)->points.t = 2.9;
    assert_near(ns_bridge_timepoints_next(&r.points, r.system, 3.5), 3.5 + 5e-5);
    tear_down(&r);
}

static void closeness_and_equality(void **state) {
    rig r;
    const double t = 0.1 + 0.2;
    (void)state;
    set_up(&r);
    assert_near(ns_bridge_timepoints_closeness(&r.points), 5e-5);
    r.points.min_break = 0.0;
    assert_near(ns_bridge_timepoints_closeness(&r.points), 200.0 * 2.3e-16 * 100.0);
    assert_int_equal(ns_bridge_timepoints_same(t, 0.3), 1);
    assert_int_equal(ns_bridge_timepoints_same(0.3, t), 1);
    assert_int_equal(ns_bridge_timepoints_same(0.0, 0.0), 1);
    assert_int_equal(ns_bridge_timepoints_same(1.0, 1.0 + 1e-15), 0);
    assert_int_equal(ns_bridge_timepoints_same(0.0, 1e-300), 0);
    tear_down(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_grid_corners_and_breakpoints),
        cmocka_unit_test(a_break_just_behind_the_grid_replaces_it),
        cmocka_unit_test(breaks_that_are_reached_go),
        cmocka_unit_test(without_corners_the_grid_alone),
        cmocka_unit_test(before_tstart_long_steps_that_meet_it),
        cmocka_unit_test(the_last_two_steps_before_tstart_are_equal),
        cmocka_unit_test(the_start_of_uic_is_shown_just_after_0),
        cmocka_unit_test(always_ahead_of_what_was_accepted),
        cmocka_unit_test(closeness_and_equality),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
