/* tests/unit/waveform/test_deviation.c - how far a line is from a waveform, of segments whose values are
 * given: distances, integrals, squares, turns.  Expected values follow from the rules that
 * src/waveform/deviation.c states, with round numbers. */
#include "rows_rig.h"

/* Of signal 0: values at times; signal 1: `times` as much. */
static ns_segment segment(ns_waveform *w, int count, const double *t, const double *v, double times) {
    ns_segment g = {.last = count - 1};
    for (int i = 0; i < count; i++)
        g.at[i] = (ns_probe){t[i], row_of(w, v[i], times * v[i])};
    return g;
}

static void give_back(ns_waveform *w, const ns_segment *g) {
    for (int i = 0; i <= g->last; i++)
        ns_waveform_return_row(w, g->at[i].v);
}

static void near(double is, double expected) {
    if (!(fabs(is - expected) <= 1e-9 * fabs(expected)))
        fail_msg("%.12g, not %.12g", is, expected);
}

/* --- distances --- */

static double distance(ns_waveform *w, int count, const double *t, const double *v, double times) {
    const ns_segment g = segment(w, count, t, v, times);
    const double off = ns_waveform_distance(w, &g);
    give_back(w, &g);
    return off;
}

/* Allowed is 1e-3 of 10. */
static void probes_against_the_line(void **state) {
    const ns_waveform_options o = {.lines = 1e-3};
    rig r = prepared(&o);
    (void)state;
    has_been(r.w, -10, 1e3);
    near(distance(r.w, 3, (double[]){1, 2, 3}, (double[]){2, 4.005, 6}, 0), 0.5);
    assert_int_equal(r.w->worst, 0);
    /* a parabola is at a quarter of its way 3/4 as far off as in its middle; near an end it is seen as 1/4 */
    near(distance(r.w, 3, (double[]){1, 1.5, 3}, (double[]){2, 2.995, 6}, 0), 0.5 / 0.75);
    near(distance(r.w, 3, (double[]){1, 1.02, 3}, (double[]){2, 2.045, 6}, 0), 0.5 / 0.25);
    near(distance(r.w, 4, (double[]){1, 1.5, 2, 3}, (double[]){2, 3.005, 3.992, 6}, 0), 0.8);
    near(distance(r.w, 4, (double[]){1, 1.5, 2, 3}, (double[]){2, 3.009, 3.992, 6}, 0), 0.9);
    near(distance(r.w, 3, (double[]){1, 2, 3}, (double[]){2, 4.005, 6}, 1e3), 5); /* of 1e3: 1 allowed */
    assert_int_equal(r.w->worst, 1);
    assert_true(distance(r.w, 2, (double[]){1, 3}, (double[]){2, 6}, 0) == 0);
    rig_end(&r);
}

/* Signal 0 may be off by lines of its largest value, or by rounding: of its kind, the floor, as measured. */
static void what_is_allowed(void **state) {
    static const double t[] = {0, 1, 2}, v[] = {0, 0.1, 0};
    const ns_waveform_options few = {.lines = 1e-3}, noisy = {.lines = 1e-3, .noise = 1e-2},
                              floors = {.lines = 1e-3, .noise = 1e-2, .floor = {0, 0.5}};
    const ns_waveform_options *o[] = {&few, &noisy, &floors};
    static const double allowed[] = {10e-3, 0.2, 0.5};
    (void)state;
    for (int k = 0; k < 3; k++) {
        rig r = prepared(o[k]);
        has_been(r.w, 10, 20);
        near(distance(r.w, 3, t, v, 0), 0.1 / allowed[k]);
        r.w->rounding[0] = 0.7;
        r.w->stale = 1;
        near(distance(r.w, 3, t, v, 0), 0.1 / 0.7);
        ns_waveform_forget_rounding(r.w); /* nothing was measured: it stays */
        near(distance(r.w, 3, t, v, 0), 0.1 / 0.7);
        r.w->rounding_known = 1;
        ns_waveform_forget_rounding(r.w);
        near(distance(r.w, 3, t, v, 0), 0.1 / allowed[k]);
        has_been(r.w, 4e3, -2e5); /* in another call: what is allowed grows with it */
        near(distance(r.w, 3, t, v, 0), 0.1 / (k == 0 ? 4 : 2e3));
        rig_end(&r);
    }
}

/* Rows differ from a tenth of what is allowed on: 1e-3 of 10. */
static void rows_that_differ(void **state) {
    const ns_waveform_options o = {.lines = 1e-3};
    rig r = prepared(&o);
    (void)state;
    has_been(r.w, 10, 100);
    double *a = row_of(r.w, 3, 7), *same = row_of(r.w, 3.0009, 6.991), *first = row_of(r.w, 2.9989, 7),
           *second = row_of(r.w, 3, 7.011);
    assert_false(ns_waveform_differ(r.w, a, same));
    assert_true(ns_waveform_differ(r.w, a, first));
    assert_true(ns_waveform_differ(r.w, a, second));
    rig_end(&r);
}

/* --- integrals --- */

static double deviation(ns_waveform *w, int count, const double *t, const double *v) {
    const ns_segment g = segment(w, count, t, v, 0);
    const double off = ns_waveform_deviation(w, &g);
    give_back(w, &g);
    return off;
}

/* 0.1 at both ends of 1 s, 0.102 amid, where 1 was seen: lines = 0.01 allows a distance of 0.01.  The
 * integral of the waveform is 0.101, of the distance 0.001. */
static double with_integrals(ns_waveform *w) {
    return deviation(w, 3, (double[]){0, 0.5, 1}, (double[]){0.1, 0.102, 0.1});
}

static void integrals_against_trapezoids(void **state) {
    const ns_waveform_options o = {.lines = 0.01};
    const double lines = 0.01, own = 0.101, off = 0.001, half = 0.5 * lines * own;
    rig r = prepared(&o);
    (void)state;
    has_been(r.w, 1, 0);
    r.w->is_first = 0;
    r.w->end = 1;
    r.w->event_t = r.w->start_t = 0;
    near(with_integrals(r.w), off / (half + sqrt(lines) / 3 * lines * own + 1e-12));
    /* where the distance is too large, 10, as well: the integral of 0.15 is off by 0.05 */
    near(deviation(r.w, 3, (double[]){0, 0.5, 1}, (double[]){0.1, 0.2, 0.1}),
         0.05 / ((0.5 + sqrt(lines) / 3) * lines * 0.15 + 1e-12));
    r.w->since_event[0] = 10;
    near(with_integrals(r.w), off / (half + sqrt(lines) / 3 * lines * (10 + own) + 1e-12));
    r.w->error[0] = -0.04; /* a fifth of what is left of the half that is shared out */
    near(with_integrals(r.w), off / (half + 0.2 * (0.5 * lines * (10 + own) - 0.04) + 1e-12));
    r.w->error[0] = 1; /* nothing is left */
    near(with_integrals(r.w), off / (half + 1e-12));
    assert_int_equal(r.w->worst, 0);
    /* the run since 4 s, with an event 2 s ago: half of its integral */
    r.w->since_event[0] = r.w->error[0] = 0;
    r.w->total[0] = 20;
    r.w->start_t = -3;
    r.w->event_t = -1;
    near(with_integrals(r.w), off / (half + sqrt(lines) / 3 * lines * 0.5 * (20 + own) + 1e-12));
    r.w->end = 100; /* never more than all of it */
    r.w->total[0] = 10;
    near(with_integrals(r.w), off / (half + sqrt(lines) / 3 * lines * (10 + own) + 1e-12));
    rig_end(&r);
}

/* In the first stretch after an event: what a line has where the signal is what it is at the next event. */
static void integrals_after_an_event(void **state) {
    const ns_waveform_options o = {.lines = 0.01};
    const double lines = 0.01, own = 0.101, off = 0.001, half = 0.5 * lines * own, since = 5 + own;
    rig r = prepared(&o);
    (void)state;
    has_been(r.w, 1, 0);
    r.w->is_first = 1;
    r.w->end = 1;
    r.w->event_t = r.w->start_t = 0;
    r.w->since_event[0] = 5;
    r.w->at_end[r.w->signal[0]] = -0.2;
    near(with_integrals(r.w), off / (half + lines * 0.2 + 1e-12));
    r.w->at_end[r.w->signal[0]] = 0.5; /* a fifth of what is left, but for a tenth of all */
    near(with_integrals(r.w), off / (half + 0.2 * (0.5 - 0.1) * lines * since + 1e-12));
    r.w->at_end[r.w->signal[0]] = 0.1; /* less than the even part */
    near(with_integrals(r.w), off / (half + sqrt(lines) / 3 * lines * since + 1e-12));
    rig_end(&r);
}

/* What rounding may do all along the segment is allowed too. */
static void integrals_of_noise(void **state) {
    const ns_waveform_options o = {.lines = 0.01, .noise = 1e-3};
    const double lines = 0.01, own = 0.202, off = 0.002;
    rig r = prepared(&o);
    (void)state;
    has_been(r.w, 1, 0);
    r.w->is_first = 0;
    r.w->end = 2;
    r.w->event_t = r.w->start_t = 0;
    near(deviation(r.w, 3, (double[]){0, 1, 2}, (double[]){0.1, 0.102, 0.1}),
         off / (0.5 * lines * own + sqrt(lines) / 3 * lines * own + 2e-3));
    rig_end(&r);
}

/* Integrals since the event: of what each line has, and of errors beyond half of lines of it. */
static void integrals_add_up(void **state) {
    const ns_waveform_options o = {.lines = 0.01};
    rig r = prepared(&o);
    (void)state;
    /* -1, -1.2, -1: of the size 1.1, of the distance -0.1; amid 0.001 more: within what is allowed */
    const ns_segment off = segment(r.w, 3, (double[]){0, 0.5, 1}, (double[]){-1, -1.2, -1}, -2);
    const ns_segment within = segment(r.w, 3, (double[]){1, 1.5, 2}, (double[]){-1, -1.002, -1}, 0);
    ns_waveform_add_integrals(r.w, &off, 1);
    near(r.w->since_event[0], 1.1);
    near(r.w->error[0], -0.1 + 0.5 * 0.01 * 1.1);
    near(r.w->since_event[1], 2.2);
    near(r.w->error[1], 0.2 - 0.5 * 0.01 * 2.2);
    ns_waveform_add_integrals(r.w, &within, 1);
    near(r.w->since_event[0], 1.1 + 1.001);
    near(r.w->error[0], -0.1 + 0.5 * 0.01 * 1.1);
    ns_waveform_add_integrals(r.w, &off, -1);
    near(r.w->since_event[0], 1.001);
    assert_true(fabs(r.w->error[0]) < 1e-15 && fabs(r.w->error[1]) < 1e-15);
    ns_waveform_begin_integrals(r.w, 0.25);
    assert_true(r.w->event_t == 0.25 && r.w->since_event[0] == 0 && r.w->error[0] == 0);
    rig_end(&r);
}

/* --- squares --- */

/* A line from 0 to 0.3 in 1 s: the trapezoid of its square is too large by 0.3^2/6 = 0.015.  Its stretch ends
 * at 2: squares there are 4/3 in the mean, of which a quarter of `squares` may be wrong. */
static double with_squares(ns_waveform *w) {
    w->end_values[0] = 2;
    return deviation(w, 2, (double[]){0, 1}, (double[]){0, 0.3});
}

static void squares_against_trapezoids(void **state) {
    const ns_waveform_options o = {.lines = 0.01, .squares = 0.01}, noisy = {.squares = 0.01, .noise = 0.1};
    (void)state;
    rig r = prepared(&o);
    has_been(r.w, 1, 0);
    near(with_squares(r.w), 0.015 / (0.0025 * 4 / 3 + 1e-24));
    assert_int_equal(r.w->squares_decide, 1);
    assert_int_equal(r.w->worst, 0);
    r.w->square[0] = 30; /* of late 10 in the mean; and a tenth of the half that is left of all */
    r.w->square_time = 3;
    near(with_squares(r.w), 0.015 / (0.0025 * 10 + 0.1 * 0.5 * 0.01 * 30));
    r.w->square_error[0] = 0.1;
    near(with_squares(r.w), 0.015 / (0.0025 * 10 + 0.1 * (0.5 * 0.01 * 30 - 0.1)));
    r.w->square_error[0] = 0.2; /* nothing is left */
    near(with_squares(r.w), 0.015 / (0.0025 * 10));
    r.w->worst = 1;
    assert_true(deviation(r.w, 3, (double[]){0, 0.5, 1}, (double[]){0, 0.25, 0.3}) > 5); /* no line at all */
    assert_int_equal(r.w->squares_decide, 0);
    rig_end(&r);
    r = prepared(&noisy); /* 0.1 of 1 */
    has_been(r.w, 1, 0);
    near(with_squares(r.w), 0.015 / (0.0025 * 4 / 3 + 0.1 * 0.1));
    rig_end(&r);
}

/* Given out: what was before fades to 2 s / (2 s + 16 * 0.5 s) of it. */
static void squares_fade(void **state) {
    const ns_waveform_options o = {.lines = 0.01, .squares = 0.01};
    rig r = prepared(&o);
    (void)state;
    has_been(r.w, 2, 0);
    const ns_segment g = segment(r.w, 2, (double[]){2, 2.5}, (double[]){1, 2}, -1);
    r.w->start_t = 0;
    r.w->end_values[0] = r.w->end_values[1] = 2;
    r.w->square_time = 3;
    r.w->square[0] = 1.5;
    r.w->square_error[0] = 0.1;
    ns_waveform_note_given(r.w, &g);
    const double integral = (1 + 2 + 4) * 0.5 / 3, error = 1 * 0.5 / 6,
                 allowed = (1 + 2 + 4) / 3.0 * 0.25 * 0.01 * 0.5;
    near(r.w->square_time, 0.2 * 3 + 0.5);
    near(r.w->square[0], 0.2 * 1.5 + integral);
    near(r.w->square_error[0], 0.2 * 0.1 + error - allowed);
    near(r.w->square_error[1], error - allowed);
    ns_segment first = g; /* where the run begins nothing is left of what was before */
    r.w->start_t = 2;
    ns_waveform_note_given(r.w, &first);
    near(r.w->square_time, 0.5);
    near(r.w->square[0], integral);
    rig_end(&r);
}

/* --- turns --- */

/* 1 - bend (s - s0)^2 over 2 s from 10 s on, s the part of the way: the time at which it is seen to turn. */
static double turn_of(ns_waveform *w, double bend, double s0) {
    static const double t[] = {10, 10.2, 10.8, 11.6, 12};
    double v[5];
    for (int i = 0; i < 5; i++)
        v[i] = 1 - bend * pow((t[i] - 10) / 2 - s0, 2);
    v[1] = v[3] = 7; /* the last probe in the first half counts */
    const ns_segment g = segment(w, 5, t, v, 0);
    const double turn = ns_waveform_first_turn(w, &g);
    give_back(w, &g);
    return turn;
}

static void turns_are_found(void **state) {
    const ns_waveform_options o = {.lines = 1e-3, .closest = 0.01};
    rig r = prepared(&o);
    (void)state;
    has_been(r.w, 1, 0);
    near(turn_of(r.w, 1, 0.7), 11.4);
    near(turn_of(r.w, -1, 0.3), 10.6);
    near(turn_of(r.w, -1, 0.01), 10.02);
    assert_true(turn_of(r.w, -1, 0.004) == INFINITY); /* 8 ms after the begin: closer than points may be */
    assert_true(turn_of(r.w, 1, 1.2) == INFINITY && turn_of(r.w, 1, -0.2) == INFINITY);
    /* the top is 0.09 bend above the nearer end: seen if that is more than 0.019 of what is allowed, 1e-3 */
    assert_true(turn_of(r.w, 2.0e-4, 0.7) == INFINITY && turn_of(r.w, 2.0e-4, 0.3) == INFINITY);
    near(turn_of(r.w, 2.3e-4, 0.7), 11.4);
    r.w->rounding[0] = 3e-5;
    assert_true(turn_of(r.w, 2.3e-4, 0.7) == INFINITY);
    near(turn_of(r.w, 4e-4, 0.3), 10.6);
    /* of two signals the first one */
    const ns_segment g = segment(r.w, 3, (double[]){0, 1, 2}, (double[]){0.51, 0.96, 0.91}, 0);
    g.at[0].v[r.w->seen_at + 1] = 0.91; /* 1 - (s-0.3)^2; signal 0: 1 - (s-0.7)^2 */
    g.at[1].v[r.w->seen_at + 1] = 0.96;
    g.at[2].v[r.w->seen_at + 1] = 0.51;
    has_been(r.w, 1, 1);
    near(ns_waveform_first_turn(r.w, &g), 0.6);
    rig_end(&r);
}

/* A slope of another sign than that of the line before is counted, but not at an event; a jump has none. */
static void turns_are_counted(void **state) {
    const ns_waveform_options o = {.lines = 1e-3};
    rig r = prepared(&o);
    (void)state;
    ns_segment up = segment(r.w, 2, (double[]){0, 2}, (double[]){1, 2}, -1);
    ns_waveform_note_given(r.w, &up);
    assert_true(r.w->slope[0] == 0.5 && r.w->slope[1] == -0.5 && r.w->turned[0] == 0);
    near(r.w->total[0], 3);
    ns_segment down = segment(r.w, 2, (double[]){2, 3}, (double[]){2, 0}, 0);
    ns_waveform_note_given(r.w, &down);
    assert_true(r.w->turned[0] == 1 && r.w->turned[1] == 0 && r.w->slope[0] == -2);
    near(r.w->total[0], 4);
    up.from_event = 1;
    ns_waveform_note_given(r.w, &up);
    assert_true(r.w->turned[0] == 1);
    up.jumps = 1;
    ns_waveform_note_given(r.w, &up);
    assert_true(r.w->turned[0] == 1 && r.w->slope[0] == 0);
    rig_end(&r);
}

/* --- two segments as one --- */

static const double before_t[] = {0, 0.5, 1}, before_v[] = {1, 1.5, 2}, after_t[] = {1, 1.75, 2};

static int merges(ns_waveform *w, const double *after, int from_event) {
    ns_waveform_return_all_rows(w);
    ns_waveform_begin_integrals(w, 0);
    w->pending = segment(w, 3, before_t, before_v, 0);
    w->made = segment(w, 3, after_t, after, 0);
    w->made.smooth = 1;
    w->made.from_event = from_event;
    w->is_first = 0;
    w->end = 2;
    if (!from_event)
        ns_waveform_add_integrals(w, &w->pending, 1);
    ns_waveform_add_integrals(w, &w->made, 1);
    return ns_waveform_merge(w);
}

static void segments_merge(void **state) {
    static const double straight[] = {2, 2.75, 3}, bent[] = {2, 2.2, 3}, slightly[] = {2, 2.7549, 3};
    const ns_waveform_options o = {.lines = 1e-3, .every = 0.7, .longest = 2};
    rig r = prepared(&o);
    (void)state;
    has_been(r.w, 1, 0);
    for (int from_event = 0; from_event < 2; from_event++) {
        assert_true(merges(r.w, straight, from_event));
        assert_int_equal(r.w->made.last, 0);
        assert_int_equal(r.w->pending.last, 4);
        assert_int_equal(r.w->pending.from_event, from_event);
        assert_true(r.w->pending.at[0].t == 0 && r.w->pending.at[3].t == 1.75 && r.w->pending.at[4].t == 2);
        near(r.w->since_event[0], 4); /* of 1 ... 3 over 2 s, all of it: they are one */
        assert_false(merges(r.w, bent, from_event));
        assert_int_equal(r.w->pending.last, 2);
        /* near enough as a line (0.0049 of 10), and its integral is off by too much */
        has_been(r.w, 10, 0);
        assert_false(merges(r.w, slightly, from_event));
        near(r.w->since_event[0], (from_event ? 0 : 1.5) + 0.375 * 4.7549 + 0.125 * 5.7549);
    }
    assert_true(merges(r.w, straight, 0));
    r.w->longest = 1.99;
    assert_false(merges(r.w, straight, 0));
    r.w->longest = 2;
    r.w->every = 0.5; /* t = 1 is asked for */
    assert_false(merges(r.w, straight, 0));
    rig_end(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(probes_against_the_line),
        cmocka_unit_test(what_is_allowed),
        cmocka_unit_test(rows_that_differ),
        cmocka_unit_test(integrals_against_trapezoids),
        cmocka_unit_test(integrals_after_an_event),
        cmocka_unit_test(integrals_of_noise),
        cmocka_unit_test(integrals_add_up),
        cmocka_unit_test(squares_against_trapezoids),
        cmocka_unit_test(squares_fade),
        cmocka_unit_test(turns_are_found),
        cmocka_unit_test(turns_are_counted),
        cmocka_unit_test(segments_merge),
    };
    return cmocka_run_group_tests_name("deviation", tests, NULL, NULL);
}
