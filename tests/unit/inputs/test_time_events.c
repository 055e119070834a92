/* tests/unit/inputs/test_time_events.c - what is known ahead of time, against closed forms. */
#include "inputs/time_events_internal.h"
#include "schedules.h"
#include "wrap_alloc.h"

/* --- inputs --- */

/* 1 to 5 in 2 s from t = 10, 4 s, back in 1 s, every 20 s: corners at 10, 12, 16, 17 and every 20 s after. */
static void corners_of_a_pulse(void **state) {
    ns_system *system = bare(2, 0);
    double z[2] = {-7, -7}, dz[2] = {-7, -7};
    (void)state;
    input(system, 0, pulse(1, 5, 10, 2, 1, 4, 20));
    input(system, 1, pulse(0, 1, 3, 0, 0, 1, 2)); /* does not enter */
    system->E[0] = 1;
    ns_time_events *s = schedule(system);
    for (int k = 0; k < 1000; k++) {
        static const double at[] = {10, 12, 16, 17}, v[] = {1, 5, 5, 1}, slope[] = {2, 0, -4, 0};
        for (int i = 0; i < 4; i++) {
            const ns_time_event *what = expect(s, at[i] + 20 * k, 0, 0); /* integers: exact */
            assert_int_equal(what->jump, 0);
            assert_int_equal(what->turn, 1);
            assert_int_equal(what->inputs, 1);
            assert_int_equal(what->input[0], 0);
            ns_inputs_events_values(s, what->t, z, dz);
            assert_near(z[0], v[i], 0);
            assert_near(dz[0], slope[i], 0);
            ns_inputs_events_values(s, what->t + 0.25, z, dz);
            assert_near(z[0], v[i] + 0.25 * slope[i], 0);
            assert_near(z[1], -7, 0); /* left alone */
        }
    }
    assert_true(isinf(ns_inputs_events_next(s, 20009)));
    done(s, system);
}

/* A jump at 1 with an other input's turn there, which t = 0.1 + 0.2 + ... also reaches: one instant. */
static void what_happens_together_is_one_instant(void **state) {
    ns_system *system = bare(2, 0);
    (void)state;
    input(system, 0, pulse(0, 1, 1, 0, 0, 0.5, 10));
    input(system, 1, pulse(0, 1, 0.3 + 0.7 * (1 + eps), 0.5, 0.5, 1, INFINITY));
    system->E[0] = system->E[1] = 1;
    ns_time_events *s = schedule(system);
    const ns_time_event *what = expect(s, 1, 4 * eps, 0);
    assert_int_equal(what->inputs, 2);
    assert_true(what->jump && what->turn);
    what = expect(s, 1.5, 4 * eps, 0);
    assert_int_equal(what->inputs, 2);
    what = expect(s, 2.5, 4 * eps, 0);
    assert_int_equal(what->inputs, 1);
    assert_true(what->turn && !what->jump);
    done(s, system);
}

/* DC, a pulse of no height, a line through a point on it: nothing happens. */
static void corners_of_nothing(void **state) {
    const double t[] = {0, 1, 3}, v[] = {0, 2, 6};
    ns_system *system = bare(4, 0);
    (void)state;
    input(system, 0, (ns_signal){.kind = NS_DC, .u.dc = 3});
    input(system, 1, pulse(2, 2, 1, 0, 0, 1, 3));
    input(system, 2, (ns_signal){.kind = NS_PWL, .u.pwl = {3, t, v, NAN, 0}});
    input(system, 3, sine(1, 0, 50, 1, 0));
    for (int i = 0; i < 4; i++)
        system->E[i] = 1;
    ns_time_events *s = schedule(system);
    ns_inputs_events_seek(s, 0.5, NS_RIGHT, NULL);
    expect(s, 3, 0, 0);
    assert_true(isinf(ns_inputs_events_next(s, INFINITY)));
    done(s, system);
}

/* Three phases are one wave; a delay is another; an exponential is two. */
static void waves_are_shared(void **state) {
    ns_system *system = bare(5, 0);
    double z[5] = {0}, dz[5], c, sn;
    (void)state;
    for (int i = 0; i < 3; i++)
        input(system, i, sine(i, 2, 50, 0, 120 * i));
    input(system, 3, sine(0, 1, 50, 0.5, 90));
    input(system, 4, (ns_signal){.kind = NS_EXP, .u.exp = {1, 3, 1, 0.25, 2, 0.5}});
    for (int i = 0; i < 5; i++)
        system->E[i] = 1;
    ns_time_events *s = schedule(system);
    const ns_wave *wave = s->wave;
    const ns_wave_term *term = s->term;
    assert_int_equal(s->waves, 4);
    assert_int_equal(s->terms, 6);
    assert_int_equal(s->entering, 5);
    ns_inputs_events_values(s, 0.25, z, dz);
    ns_inputs_wave_at(&wave[0], 0.003, &c, &sn);
    assert_near(c, cos(2 * pi * 50 * 0.003), 8 * eps);
    assert_near(sn, sin(2 * pi * 50 * 0.003), 8 * eps);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(term[i].wave, 0);
        assert_near(z[i] + term[i].cc * c + term[i].cs * sn, i + 2 * sin(2 * pi * (50 * 0.003 + i / 3.0)),
                    32 * eps);
    }
    assert_near(z[3], 1, eps); /* sin 90 degrees, until its delay is over */
    assert_near(z[4], 1, 0);
    const ns_time_event *what = expect(s, 0.5, 0, 0);
    assert_true(what->turn && !what->jump && what->inputs == 1 && what->input[0] == 3);
    ns_inputs_events_values(s, 0.5, z, dz);
    assert_near(z[3], 0, 0);
    expect(s, 1, 0, 0);
    expect(s, 2, 0, 0);
    ns_inputs_events_values(s, 3, z, dz); /* at 3: 1 + 2 - 2 - 2 e^-8 + 2 e^-2 */
    for (int k = 4; k < 6; k++) {
        assert_int_equal(s->begun[k], 1);
        ns_inputs_wave_at(&wave[term[k].wave], 3, &c, &sn);
        z[4] += term[k].cc * c + term[k].cs * sn;
    }
    assert_near(z[4], 1 - 2 * exp(-8) + 2 * exp(-2), 16 * eps);
    assert_true(isinf(ns_inputs_events_next(s, INFINITY)));
    done(s, system);
}

/* --- standing elsewhere --- */

/* Above 1 closes, below -1 opens: what holds between depends on what was, and is said to seek. */
static void seek_takes_the_states_it_is_told(void **state) {
    ns_system *system = bare(1, 1);
    unsigned char closed = 1, open = 0;
    (void)state;
    input(system, 0, pulse(-2, 2, 0, 4, 4, 0, 8)); /* 0 at 2, 1 at 3, 0 at 6, -1 at 7 */
    thresholds(system, 0, 1, -1);
    system->command[0].gz[0] = 1;
    ns_time_events *s = schedule(system);
    ns_inputs_events_seek(s, 802, NS_RIGHT, &closed);
    expect(s, 807, 1e-12, 1);
    ns_inputs_events_seek(s, 802, NS_RIGHT, &open);
    expect(s, 803, 1e-12, 1);
    ns_inputs_events_seek(s, 6, NS_RIGHT, NULL); /* between: open */
    expect(s, 11, 1e-12, 1);
    ns_inputs_events_seek(s, 4, NS_RIGHT, &open); /* a contradiction */
    expect(s, 4, 0, 1);
    expect(s, 7, 1e-12, 1);
    ns_inputs_events_seek(s, 3, NS_LEFT, &open);
    expect(s, 3, 0, 1);
    ns_inputs_events_seek(s, 3, NS_RIGHT, &closed);
    expect(s, 7, 1e-12, 1);
    done(s, system);
}

/* 1 down to 0 from 2 to 4: at 3 it passes 1/2; nothing is left of the control where the ramp ends. */
static void seek_to_where_a_control_falls_to_nothing(void **state) {
    ns_system *system = bare(1, 1);
    unsigned char closed = 1;
    (void)state;
    input(system, 0, pulse(0, 1, 0, 1, 2, 1, 8));
    thresholds(system, 0, 0.5, 0.5);
    system->command[0].gz[0] = 1;
    ns_time_events *s = schedule(system);
    ns_inputs_events_seek(s, 3, NS_LEFT, &closed);
    expect(s, 3, 1e-12, 1);
    ns_inputs_events_seek(s, 2.5, NS_RIGHT, &closed);
    expect(s, 3, 1e-12, 1);
    done(s, system);
}

/* At 1 the input jumps and the switch with it: from the left both are still to come. */
static void both_sides_of_a_jump(void **state) {
    ns_system *system = bare(1, 1);
    unsigned char closed = 0;
    double z, dz;
    (void)state;
    input(system, 0, pulse(0, 2, 1, 0, 0, 1, 4));
    thresholds(system, 0, 1, 1);
    system->command[0].gz[0] = system->E[0] = 1;
    ns_time_events *s = schedule(system);
    ns_inputs_events_seek(s, 5, NS_LEFT, &closed);
    ns_inputs_events_values(s, 5, &z, &dz);
    assert_near(z, 0, 0);
    const ns_time_event *what = expect(s, 5, 0, 1);
    assert_true(what->jump);
    ns_inputs_events_values(s, 5, &z, &dz);
    assert_near(z, 2, 0);
    expect(s, 6, 0, 1);
    closed = 1;
    ns_inputs_events_seek(s, 5, NS_RIGHT, &closed);
    ns_inputs_events_values(s, 5, &z, &dz);
    assert_near(z, 2, 0);
    expect(s, 6, 0, 1);
    done(s, system);
}

/* Periods of 1e-20 s at t = 1 are not told apart, and not walked one by one. */
static void periods_shorter_than_rounding(void **state) {
    ns_system *system = bare(1, 1);
    (void)state;
    input(system, 0, pulse(0, 2, 0, 2e-21, 2e-21, 4e-21, 1e-20));
    thresholds(system, 0, 1, 1);
    system->command[0].gz[0] = system->E[0] = 1;
    ns_time_events *s = schedule(system);
    ns_inputs_events_seek(s, 1, NS_RIGHT, NULL);
    double before = 1;
    for (int k = 0; k < 100; k++) {
        const double t = ns_inputs_events_next(s, INFINITY);
        assert_true(t >= before && t < 1 + 1e-12);
        before = ns_inputs_events_pass(s)->t;
    }
    assert_true(before > 1);
    done(s, system);
}

/* --- events that repeat --- */

/* Two inputs that enter and a switch of a third: the period of all; 0 where they have none. */
static void the_period_of_all(void **state) {
    const double root = sqrt(2), ramp[] = {0, 1}, level[] = {0, 1};
    const ns_signal once = {.kind = NS_PWL, .u.pwl = {2, ramp, level, NAN, 0}};
    const struct {
        ns_signal a, b, switching;
        double period;
    } of[] = {{pulse(0, 1, 0, 0, 0, 0.5, 1), pulse(0, 1, 0, 0, 0, 0.5, 3), dc(0), 3},
              {pulse(0, 1, 0, 0, 0, 0.5, 1), pulse(0, 1, 0, 0, 0, 0.5, root), dc(0), 0},
              {pulse(0, 1, 0, 0, 0, 0.5, 2), pulse(0, 1, 0, 0, 0, 0.5, 3), dc(0), 0},
              {pulse(0, 1, 0, 0, 0, 0.5, 1), once, pulse(0, 1, 0, 1, 1, 0, 4), 4},
              {pulse(0, 1, 0, 0, 0, 0.5, 1), dc(1), pulse(0, 1, 0, 1, 1, 0, root), 0},
              {pulse(0, 1, 0, 0, 0, 0.5, 1), sine(0, 1, 1, 0, 0), dc(0), 0},
              {once, dc(2), dc(0), 0}};
    (void)state;
    for (int k = 0; k < 7; k++) {
        ns_system *system = bare(3, 1);
        input(system, 0, of[k].a);
        input(system, 1, of[k].b);
        input(system, 2, of[k].switching);
        system->E[0] = system->E[1] = system->command[0].gz[2] = 1;
        thresholds(system, 0, 0.5, 0.5);
        ns_time_events *s = schedule(system);
        while (ns_inputs_events_next(s, 1.25) <= 1.25)
            ns_inputs_events_pass(s);
        assert_near(ns_inputs_events_period(s), of[k].period, 0);
        done(s, system);
    }
}

/* A thousand periods on, what comes next is what comes there. */
static void skipped_periods(void **state) {
    ns_system *system = bare(2, 1);
    double z[2], dz[2];
    (void)state;
    input(system, 0, pulse(0, 1, 0, 1, 1, 1, 4));
    input(system, 1, pulse(0, 1, 0, 1, 1, 0, 2));
    system->E[0] = system->command[0].gz[1] = 1;
    thresholds(system, 0, 0.5, 0.5);
    ns_time_events *s = schedule(system);
    expect(s, 0.5, 1e-15, 1);
    expect(s, 1, 0, 0);
    ns_inputs_events_skip(s, 4001, 4000);
    ns_inputs_events_values(s, 4001.25, z, dz);
    assert_near(z[0], 1, 0);
    expect(s, 4001.5, 1e-12, 1);
    expect(s, 4002, 0, 0);
    expect(s, 4002.5, 1e-12, 1);
    ns_inputs_events_values(s, 4002.75, z, dz);
    assert_near(z[0], 0.25, 1e-12);
    assert_near(dz[0], -1, 0);
    done(s, system);
}

/* A turn is no event of the circuit; a jump is, and a flip, and both if they fall together with a turn. */
static void turns_are_no_events(void **state) {
    ns_system *system = bare(3, 1);
    (void)state;
    input(system, 0, pulse(0, 1, 1, 1, 1, 1, 10)); /* turns at 1, 2, 3, 4 */
    input(system, 1, pulse(0, 1, 3, 0, 0, 2, 10)); /* jumps at 3, 5 */
    input(system, 2, pulse(0, 1, 4, 0, 0, 2, 10)); /* flips at 4, 6 */
    system->E[0] = system->E[1] = system->command[0].gz[2] = 1;
    thresholds(system, 0, 0.5, 0.5);
    ns_time_events *s = schedule(system);
    for (int t = 1; t <= 6; t++) {
        assert_near(ns_inputs_events_next(s, INFINITY), t, 0);
        assert_int_equal(ns_inputs_events_is_event(s), t > 2);
        ns_inputs_events_pass(s);
    }
    done(s, system);
}

/* --- no memory, nothing at all --- */

static void no_memory(void **state) {
    ns_system *system = bare(3, 2);
    (void)state;
    input(system, 0, pulse(0, 1, 0, 1, 1, 0, 2));
    input(system, 1, sine(0, 1, 1, 0, 0));
    input(system, 2, pulse(0, 1, 0, 1, 1, 1, 5));
    thresholds(system, 0, 0.5, 0.5);
    thresholds(system, 1, 0.5, 0.5);
    system->command[0].gz[0] = system->command[1].gz[1] = system->E[2] = 1;
    const unsigned char active[] = {0, 0, 1};
    for (long k = 1;; ++k) {
        ns_time_events *s;
        fail_alloc_at(k);
        const int status = ns_inputs_events_create(system, active, &s);
        const long made = allocs_made();
        fail_alloc_off();
        if (made < k) {
            assert_int_equal(status, NS_OK);
            ns_inputs_events_free(s);
            break;
        }
        assert_int_equal(status, NS_E_MEMORY);
        assert_null(s);
    }
    assert_int_equal(ns_inputs_events_create(system, NULL, NULL), NS_E_NULL);
    ns_time_events *s;
    assert_int_equal(ns_inputs_events_create(NULL, NULL, &s), NS_E_NULL);
    ns_inputs_events_free(NULL);
    ns_system_free(system);
}

/* No input, no command: nothing ever happens. */
static void an_empty_schedule(void **state) {
    ns_system *system = bare(0, 0);
    (void)state;
    ns_time_events *s = schedule(system);
    assert_true(isinf(ns_inputs_events_next(s, INFINITY)));
    const ns_time_event *what = ns_inputs_events_pass(s);
    assert_int_equal(what->flips, 0);
    assert_near(what->t, 0, 0);
    done(s, system);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(corners_of_a_pulse),
        cmocka_unit_test(what_happens_together_is_one_instant),
        cmocka_unit_test(corners_of_nothing),
        cmocka_unit_test(waves_are_shared),
        cmocka_unit_test(seek_takes_the_states_it_is_told),
        cmocka_unit_test(seek_to_where_a_control_falls_to_nothing),
        cmocka_unit_test(both_sides_of_a_jump),
        cmocka_unit_test(periods_shorter_than_rounding),
        cmocka_unit_test(the_period_of_all),
        cmocka_unit_test(skipped_periods),
        cmocka_unit_test(turns_are_no_events),
        cmocka_unit_test(no_memory),
        cmocka_unit_test(an_empty_schedule),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
