/* tests/unit/bridge/test_timepoints.c - where ngspice's timepoints should be. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "timepoints.h"

enum { BREAKS = 5 };

/* A run of 100 s in steps of 1 s, with breakpoints of ngspice at 10, 10.4, 20, 40 and the end, and one input
 * whose corners are at 5, 6, 15.5 and 16. */
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

static void the_grid_and_corners_but_no_breakpoints(void **state) {
    static const double from_to[][2] = {
        {0.0, 1.0},   {2.5, 3.0},   {3.9999, 5.0}, /* a sliver before the grid counts as there */
        {5.0, 6.0},   {9.0, 10.0},  {10.0, 11.0},  {10.4, 11.0}, {15.0, 15.5},
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

/* The first corner of the input at td. */
static rig *set_up_corner(rig *r, double td) {
    const ns_signal pulse = {.kind = NS_PULSE,
                             .u.pulse = {.v2 = 1.0, .td = td, .tr = 1.0, .tf = 0.5, .pw = 9.5, .per = 1e3}};
    assert_int_equal(ns_system_set_input(set_up(r)->system, 0, &pulse), NS_OK);
    return r;
}

static void a_corner_just_behind_the_grid_replaces_it(void **state) {
    rig r;
    (void)state;
    assert_near(next_of(set_up_corner(&r, 3.0009), 2.0), 3.0009);
    tear_down(&r);
    assert_near(next_of(set_up_corner(&r, 3.0011), 2.0), 3.0);
    tear_down(&r);
    set_up_corner(&r, 4.0015)->points.step = 2.0; /* then closer than 2 ms */
    assert_near(next_of(&r, 2.0), 4.0015);
    tear_down(&r);
}

/* ngspice reads two. */
static void only_the_end_of_the_step_and_of_the_run_are_breaks(void **state) {
    rig r;
    (void)state;
    set_up(&r);
    const double t = next_of(&r, 9.0);
    assert_int_equal(r.points.nbreaks, 2);
    assert_true(r.breaks[0] == 100.0 && r.breaks[1] == 100.0);
    const double step = ns_bridge_timepoints_step_to(&r.points, t);
    assert_true(9.0 + step > 10.0 && step < 1.0 + 1e-12); /* a little longer: ngspice cuts it */
    assert_int_equal(r.points.nbreaks, 2);
    assert_true(r.breaks[0] == 10.0 && r.breaks[1] == 100.0);
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

/* --- where a waveform chooses them --- */

static double longest_step_with(ns_signal z, double stop) {
    ns_system *s;
    assert_int_equal(ns_system_create(1, 0, 1, 0, &s), NS_OK);
    assert_int_equal(ns_system_set_input(s, 0, &z), NS_OK);
    const double step = ns_bridge_timepoints_longest_step(s, stop);
    ns_system_free(s);
    return step;
}

/* 1/1024 of a period, 1/65536 of the run: the shorter one. */
static void the_longest_step_is_a_part_of_period_and_run(void **state) {
    const double t[] = {1.0, 2.0, 4.0}, v[] = {0.0, 1.0, 0.0};
    const ns_signal pulse = {.kind = NS_PULSE,
                             .u.pulse = {.v2 = 1.0, .tr = 0.1, .tf = 0.1, .pw = 1.0, .per = 5.0}};
    const ns_signal once = {.kind = NS_PULSE,
                            .u.pulse = {.v2 = 1.0, .tr = 0.1, .tf = 0.1, .pw = 1.0, .per = INFINITY}};
    const ns_signal sine = {.kind = NS_SIN, .u.sin = {.va = 1.0, .freq = 4.0}};
    const ns_signal repeated = {.kind = NS_PWL, .u.pwl = {.n = 3, .t = t, .v = v, .repeat = 1.0}};
    const ns_signal line = {.kind = NS_PWL, .u.pwl = {.n = 3, .t = t, .v = v, .repeat = NAN}};
    const ns_signal constant = {.kind = NS_DC, .u.dc = 1.0};
    (void)state;
    assert_near(longest_step_with(pulse, 1e4), 5.0 / 1024.0);
    assert_near(longest_step_with(sine, 1e4), 0.25 / 1024.0);
    assert_near(longest_step_with(repeated, 1e4), 3.0 / 1024.0);
    assert_near(longest_step_with(once, 1e4), 1e4 / 65536.0);
    assert_near(longest_step_with(line, 1e4), 1e4 / 65536.0);
    assert_near(longest_step_with(constant, 1e4), 1e4 / 65536.0);
    assert_near(longest_step_with(pulse, 1.0), 1.0 / 65536.0);
}

static double slowest_of(const ns_signal *z, int count, double stop) {
    ns_system *s;
    assert_int_equal(ns_system_create(1, 0, count, 0, &s), NS_OK);
    for (int i = 0; i < count; i++)
        assert_int_equal(ns_system_set_input(s, i, &z[i]), NS_OK);
    const double slowest = ns_bridge_timepoints_slowest(s, stop);
    ns_system_free(s);
    return slowest;
}

/* A SIN of 4 Hz from 0.5 s on has repeated itself at 0.75 s, a PULSE of 5 s from 2 s on at 7 s, the points of
 * PWL from 1 s to 4 s, later by 6 s, at 3 s + 6 s; DC and what comes once does not count. */
static void the_slowest_source_has_come_once(void **state) {
    const double t[] = {1.0, 2.0, 4.0}, v[] = {0.0, 1.0, 0.0};
    const ns_signal z[] = {
        {.kind = NS_DC, .u.dc = 1.0},
        {.kind = NS_PULSE, .u.pulse = {.v2 = 1.0, .tr = 0.1, .tf = 0.1, .pw = 1.0, .per = INFINITY}},
        {.kind = NS_SIN, .u.sin = {.va = 1.0, .freq = 4.0, .td = 0.5}},
        {.kind = NS_PULSE, .u.pulse = {.v2 = 1.0, .td = 2.0, .tr = 0.1, .tf = 0.1, .pw = 1.0, .per = 5.0}},
        {.kind = NS_PWL, .u.pwl = {.n = 3, .t = t, .v = v, .repeat = 1.0, .td = 6.0}}};
    (void)state;
    assert_near(slowest_of(z, 2, 100.0), 0.0);
    assert_near(slowest_of(z, 3, 100.0), 0.75);
    assert_near(slowest_of(z, 4, 100.0), 7.0);
    assert_near(slowest_of(z, 5, 100.0), 9.0);
    assert_near(slowest_of(z, 5, 8.0), 8.0);
}

/* 1, 2 or 5 times a power of ten; the largest of which fifty fit into the run. */
static void round_times_fit_fifty_times(void **state) {
    static const double stop_round[][2] = {{1.0, 0.02},    {2.4, 0.02},    {2.6, 0.05},    {5.1, 0.1},
                                           {10.1, 0.2},    {9.9, 0.1},     {1e-3, 2e-5},   {1.22e-3, 2e-5},
                                           {2.6e-7, 5e-9}, {1.9e4, 200.0}, {3.7e-9, 5e-11}};
    (void)state;
    for (size_t k = 0; k < sizeof stop_round / sizeof stop_round[0]; k++)
        assert_near(ns_bridge_timepoints_round(stop_round[k][0]), stop_round[k][1]);
}

/* Half of it is ngspice's least distance of breakpoints; more than rounding apart is that too. */
static void the_closest_points_are_two(void **state) {
    (void)state;
    for (int k = 0; k < 21; k++) { /* 1 ns to 1.8e8 s */
        const double stop = 1e-9 * pow(7.3, k), closest = ns_bridge_timepoints_closest(stop);
        assert_int_equal(ns_bridge_timepoints_same(stop, stop - 0.5 * closest), 0);
        assert_int_equal(ns_bridge_timepoints_same(stop, stop - closest), 0);
        assert_true(closest < 1e-14 * stop);
    }
}

static void a_point_that_the_waveform_does_not_choose(void **state) {
    rig r;
    (void)state;
    set_up(&r)->points.start = 50.0;
    r.points.t = 10.0;
    assert_near(ns_bridge_timepoints_unchosen(&r.points), 12.0); /* a fiftieth of the run later */
    r.points.t = 48.1;
    assert_near(ns_bridge_timepoints_unchosen(&r.points), 50.0);
    assert_int_equal(r.points.nbreaks, 2);
    assert_near(r.points.max_step, 2.0);
    r.points.t = 50.0;
    assert_true(ns_bridge_timepoints_unchosen(&r.points) == 0.0);
    assert_true(r.breaks[0] == 100.0 && r.breaks[1] == 100.0);
    assert_near(r.points.max_step, 100.0);
    tear_down(&r);
    set_up(&r)->points.skips_start = 1;
    assert_near(ns_bridge_timepoints_unchosen(&r.points), 0.5 * ns_bridge_timepoints_closest(100.0));
    tear_down(&r);
}

/* ngspice's dctran.c after it accepted the point at time: where the next one will be.  From 46 on a step that
 * does not reach the first breakpoint is halved if 1.9 steps would pass it. */
static double ngspice_steps_to(const ns_timepoints *p, double time, double delta, int version) {
    const double to_break = p->breaks[0] - time;
    delta = fmin(delta, p->max_step);
    if (p->breaks[0] < p->stop) /* else it cuts the step to a tenth */
        assert_true(to_break > 100.0 * (nextafter(time, INFINITY) - time));
    assert_true(p->breaks[0] > time + p->min_break || p->breaks[0] >= p->stop); /* else it removes it */
    if (time + delta > p->breaks[0])
        delta = to_break;
    else if (version >= 46 && time + 1.9 * delta > p->breaks[0])
        delta = 0.5 * to_break;
    return time + delta;
}

/* Points all over the run, of any distance: ngspice comes to each, up to the rounding of one sum. */
static void every_step_ends_where_the_waveform_wants_it(void **state) {
    static const double length[] = {1.0, 0.6, 0.3, 1e-3, 1e-9, 1e-12, 1e-14, 1e-15};
    enum { LENGTHS = sizeof length / sizeof length[0] };
    rig r;
    (void)state;
    for (int k = 0; k < 4000; k++) {
        set_up(&r)->points.min_break = 0.5 * ns_bridge_timepoints_closest(100.0);
        const double t = k % 4 == 0 ? 0.0 : fmod(k * 61.8034, 100.0);
        const double next =
            fmin(100.0, t + fmax((100.0 - t) * length[k % LENGTHS], ns_bridge_timepoints_closest(100.0)));
        r.points.t = t;
        if (t == 0.0 && k % LENGTHS == 0)
            r.points.start = 50.0; /* nothing is shown: the longest step is not that of the run */
        const double unchosen = ns_bridge_timepoints_unchosen(&r.points);
        const double wanted = unchosen > 0.0 ? unchosen : next;
        const double step = ns_bridge_timepoints_step_to(&r.points, wanted);
        for (int version = 39; version <= 46; version += 7) {
            const double got = ngspice_steps_to(&r.points, t, step, version);
            assert_true(ns_bridge_timepoints_same(got, wanted));
        }
        /* without the breakpoint, as after `resume`, still at the same time */
        r.points.breaks[0] = r.points.stop;
        assert_true(ns_bridge_timepoints_same(ngspice_steps_to(&r.points, t, step, 39), wanted));
        tear_down(&r);
    }
}

/* What rounding leaves of a step is no breakpoint. */
static void a_step_of_rounding_sets_no_breakpoint(void **state) {
    rig r;
    (void)state;
    set_up(&r)->points.min_break = 0.5 * ns_bridge_timepoints_closest(100.0);
    r.points.t = 50.0;
    ns_bridge_timepoints_unchosen(&r.points);
    const double next = nextafter(nextafter(50.0, 100.0), 100.0);
    assert_true(ns_bridge_timepoints_step_to(&r.points, next) == next - 50.0);
    assert_true(r.breaks[0] == 100.0);
    tear_down(&r);
}

/* Of a PULSE with periods of 10 s from 5 s on and edges of 10 ms, in a run of 100 s: 7e-7 of a period before
 * each and where it begins, as much of the run before the end and there.  With edges of 1 s 1.5 times as far
 * behind the begin, too; where edges are not in the plot in place of the begin. */
static void points_beside_times_that_are_measured(void **state) {
    const double a = 7e-6, end = 7e-5;
    const double quick[][2] = {{0, 5 - a},     {5 - a, 5},      {5, 15 - a},
                               {14.9, 15 - a}, {95, 100 - end}, {100 - end, 100}};
    const double slow[][2] = {{5 - a, 5}, {5, 5 + 1.5 * a}, {5 + 1.5 * a, 15 - a}};
    const double hidden[][2] = {{5 - 2 * a, 5 - a}, {5 - a, 5 + 1.5 * a}, {5 + 1.5 * a, 15 - a}};
    ns_signal pulse = {.kind = NS_PULSE,
                       .u.pulse = {.v2 = 1, .td = 5, .tr = 0.01, .tf = 0.01, .pw = 3, .per = 10}};
    ns_system *s;
    (void)state;
    assert_int_equal(ns_system_create(1, 0, 1, 0, &s), NS_OK);
    assert_int_equal(ns_system_set_input(s, 0, &pulse), NS_OK);
    for (int k = 0; k < 6; k++)
        assert_near(ns_bridge_timepoints_beside_mark(s, quick[k][0], 100, 1), quick[k][1]);
    for (int k = 0; k < 3; k++)
        assert_near(ns_bridge_timepoints_beside_mark(s, hidden[k][0], 100, 0), hidden[k][1]);
    pulse.u.pulse.tr = 1;
    assert_int_equal(ns_system_set_input(s, 0, &pulse), NS_OK);
    for (int k = 0; k < 3; k++)
        assert_near(ns_bridge_timepoints_beside_mark(s, slow[k][0], 100, 1), slow[k][1]);
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_grid_and_corners_but_no_breakpoints),
        cmocka_unit_test(a_corner_just_behind_the_grid_replaces_it),
        cmocka_unit_test(only_the_end_of_the_step_and_of_the_run_are_breaks),
        cmocka_unit_test(without_corners_the_grid_alone),
        cmocka_unit_test(before_tstart_long_steps_that_meet_it),
        cmocka_unit_test(the_last_two_steps_before_tstart_are_equal),
        cmocka_unit_test(the_start_of_uic_is_shown_just_after_0),
        cmocka_unit_test(always_ahead_of_what_was_accepted),
        cmocka_unit_test(closeness_and_equality),
        cmocka_unit_test(the_longest_step_is_a_part_of_period_and_run),
        cmocka_unit_test(the_slowest_source_has_come_once),
        cmocka_unit_test(round_times_fit_fifty_times),
        cmocka_unit_test(the_closest_points_are_two),
        cmocka_unit_test(a_point_that_the_waveform_does_not_choose),
        cmocka_unit_test(every_step_ends_where_the_waveform_wants_it),
        cmocka_unit_test(points_beside_times_that_are_measured),
        cmocka_unit_test(a_step_of_rounding_sets_no_breakpoint),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
