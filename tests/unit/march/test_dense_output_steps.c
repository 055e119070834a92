/* tests/unit/march/test_dense_output_steps.c - what ends a trial with NS_TO_STEP; steps of the scheme; the
 * shortest time in which something changes. */
#include "dense_output.h"

#include "march/run_internal.h"

/* --- steps of the scheme --- */

/* A trial is one step of h at most, and a straight line: the chord of its ends. */
static void a_step_of_the_ladder_is_a_chord(void **state) {
    const double h = 1e-6;
    double reached;
    point begin_at;
    scene z = rectifier();
    (void)state;
    begin(&z, NS_THETA, 1);
    begin_at = shown(&z);
    long events = 0, lines = 0, trials = 0;
    for (; begin_at.t < 2e-3 && trials < 100000; trials++) {
        const int from_event = ns_march_at_event(z.m);
        ok(ns_march_try(z.m, 1, NS_TO_STEP, &reached));
        assert_true(reached >= begin_at.t && reached - begin_at.t < h * (1 + 1e-9));
        const point end_at = shown(&z);
        if (reached > begin_at.t) {
            const double third = begin_at.t + (reached - begin_at.t) / 3,
                         part = (third - begin_at.t) / (reached - begin_at.t);
            const point p = sampled(&z, third), last = sampled(&z, reached);
            assert_true(apart(&z, &last, &end_at) == 0);
            for (int i = 0; i < z.s->n; i++) { /* right after an event all of it is as its end */
                const double from = from_event ? end_at.x[i] : begin_at.x[i];
                assert_true(fabs(p.x[i] - (from + part * (end_at.x[i] - from))) < 1e-13);
            }
            assert_true(isinf(ns_march_shortest(z.m, third, NULL)));
            lines++;
        }
        events += ns_march_at_event(z.m);
        ok(ns_march_accept(z.m));
        begin_at = shown(&z);
    }
    assert_true(events == 3 && lines >= 2000); /* off at the peak at 0.25 ms, on, off at 1.25 ms */
    end(&z);
}

static scene captured(void) {
    const ns_march_options o = {.theta = 0.5, .gamma = 0.5, .h = 1e-6, .method = NS_THETA, .capture = 1};
    scene z = rectifier();
    begin(&z, NS_EXACT, 1);
    ns_march_free(z.m);
    ok(ns_march_create(z.s, &o, &z.m, NULL));
    ok(ns_march_start(z.m, 0, z.w0));
    return z;
}

/* Of steps in which no event is located a sample is what another marcher reads that stops there. */
static void a_step_of_the_captured_scheme(void **state) {
    scene z = captured(), other = captured();
    double now = 0, reached;
    (void)state;
    for (int k = 0; k < 2000; k++) {
        ok(ns_march_try(z.m, 1, NS_TO_STEP, &reached));
        assert_true(reached > now && reached - now < 1e-6 * (1 + 1e-9));
        const point third = sampled(&z, now + (reached - now) / 3), last = sampled(&z, reached),
                    end_at = shown(&z);
        assert_true(apart(&z, &last, &end_at) < 1e-14);
        assert_true(apart_from(&other, &third, NULL) < 1e-14);
        ok(ns_march_accept(other.m));
        assert_true(apart_from(&other, &end_at, NULL) < 1e-14);
        ok(ns_march_accept(other.m));
        ok(ns_march_accept(z.m));
        now = reached;
    }
    assert_true(ns_march_counts(z.m)->events >= 3);
    end(&z);
    end(&other);
}

/* --- what is refused, and what ends a trial --- */

static void other_trials_have_no_way(void **state) {
    double reached;
    scene z = rectifier();
    (void)state;
    begin(&z, NS_EXACT, 1);
    assert_int_equal(ns_march_sample(NULL, 0, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_march_sample(z.m, 0, NULL, NULL), NS_E_STATE);
    ok(ns_march_try(z.m, 1e-5, NS_TO_EVENT, &reached));
    assert_int_equal(ns_march_sample(z.m, 1e-6, NULL, NULL), NS_E_STATE);
    assert_true(isnan(ns_march_shortest(z.m, 1e-6, NULL)));
    ok(ns_march_try(z.m, 1e-5, NS_TO_STEP, &reached));
    assert_int_equal(ns_march_sample(z.m, -1e-9, NULL, NULL), NS_E_RANGE);
    assert_int_equal(ns_march_sample(z.m, 1.1e-5, NULL, NULL), NS_E_RANGE);
    assert_int_equal(ns_march_sample(z.m, NAN, NULL, NULL), NS_E_RANGE);
    ok(ns_march_sample(z.m, 0.9e-5, NULL, NULL));
    ok(ns_march_try(z.m, 1e-5, NS_TO_TIME, &reached)); /* the same trial */
    ok(ns_march_sample(z.m, 0.9e-5, NULL, NULL));
    end(&z);
}

/* A start of the ladder ends some steps of h/2^20 after the time it is asked for.  The way of the next trial
 * begins at that time all the same: whoever replaces one engine by another reads the accepted point there. */
static void the_way_begins_at_the_start(void **state) {
    (void)state;
    scene z = one_buck();
    double reached, t, x[16];
    assert_true(z.c != NULL);
    begin(&z, NS_THETA, 1);
    ok(ns_march_read(z.m, &t, NULL, NULL, NULL));
    assert_true(t > 0);
    ok(ns_march_try(z.m, 1e-5, NS_TO_STEP, &reached));
    assert_true(reached > t && z.s->n <= 16);
    ok(ns_march_sample(z.m, 0, x, NULL));
    assert_int_equal(ns_march_sample(z.m, -1e-9, x, NULL), NS_E_RANGE);
    ok(ns_march_accept(z.m));
    ok(ns_march_try(z.m, 1e-5, NS_TO_STEP, &t));
    assert_int_equal(ns_march_sample(z.m, 0, x, NULL), NS_E_RANGE);
    end(&z);
}

/* Nor does it begin later if another engine takes over from the end of the start (eighteen-pulse 52001000000
 * of the stress set by "exact": a start by steps, after it sparse, and "a parameter is outside its range").
 */
static void the_way_begins_at_the_start_of_another_engine(void **state) {
    (void)state;
    static const ns_run_kind others[] = {NS_RUN_SPARSE, NS_RUN_DENSE};
    for (int k = 0; k < 2; k++) {
        scene z = one_buck();
        double reached, t, x[16], first[16];
        begin(&z, NS_THETA, 1);
        ok(ns_march_read(z.m, &t, NULL, NULL, NULL));
        assert_true(t > 0 && z.s->n <= 16);
        ok(ns_march_run_leave_for((ns_run *)(void *)z.m->engine, others[k], 1));
        ok(ns_march_try(z.m, 1e-5, NS_TO_STEP, &reached));
        assert_true(reached > t);
        ok(ns_march_sample(z.m, 0, x, NULL));
        ok(ns_march_sample(z.m, t, first, NULL));
        for (int i = 0; i < z.s->n; i++)
            assert_true(x[i] == first[i]);
        end(&z);
    }
}

/* Every corner of every input ends one, of those that drive only a switch too: of a pulse of 10 us with edges
 * four a period. */
static void corners_end_trials(void **state) {
    (void)state;
    const ns_method methods[] = {NS_EXACT, NS_SPARSE, NS_AUTO};
    for (int k = 0; k < 3; k++) {
        scene z = one_buck();
        double now = 0, reached;
        begin(&z, methods[k], 1);
        while (now < 100e-6) {
            const double corner = ns_signal_next_corner(&z.s->z[0], now);
            ok(ns_march_try(z.m, 100e-6, NS_TO_STEP, &reached));
            assert_true(reached <= corner);
            ok(ns_march_accept(z.m));
            now = reached;
        }
        end(&z);
    }
}

/* The fast of two rates is looked for until it has died out: 40 times 1 ns, to exp(-40); the slow one then.
 */
static void shortest_follows_what_dies_out(void **state) {
    double reached, until;
    scene z = two_rates();
    (void)state;
    begin(&z, NS_EXACT, 1);
    for (int k = 0; k < 2; k++) { /* to the step, and across it */
        ok(ns_march_try(z.m, 1, NS_TO_STEP, &reached));
        ok(ns_march_accept(z.m));
    }
    ok(ns_march_try(z.m, 1e-3, NS_TO_STEP, &reached));
    const double fast = ns_march_shortest(z.m, 10e-6, &until);
    assert_true(fast > 0.02e-9 && fast < 0.1e-9); /* between h |rate| = 0.025 and 0.05, and a margin */
    assert_true(fabs(until - (10e-6 + 40e-9)) < 1e-9);
    const double slow = ns_march_shortest(z.m, until, &until);
    assert_true(slow > 0.02e-3 && slow < 0.1e-3 && isinf(until));
    end(&z);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_step_of_the_ladder_is_a_chord),
                                       cmocka_unit_test(a_step_of_the_captured_scheme),
                                       cmocka_unit_test(other_trials_have_no_way),
                                       cmocka_unit_test(corners_end_trials),
                                       cmocka_unit_test(the_way_begins_at_the_start),
                                       cmocka_unit_test(shortest_follows_what_dies_out),
                                       cmocka_unit_test(the_way_begins_at_the_start_of_another_engine)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
