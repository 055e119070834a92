/* tests/unit/inputs/test_switch_times.c - when commands of time flip, against closed forms. */
#include "schedules.h"

/* A triangle from 0 up to 1 and back each in 1 s: above 0.75 from 0.75 to 1.25, on its way up past 0.6 at
 * 0.6, below 0.1 from 1.9 on.  Of g = 1 - triangle the other way round. */
static void flips_of_a_triangle(void **state) {
    ns_system *system = bare(1, 3);
    (void)state;
    input(system, 0, pulse(0, 1, 0, 1, 1, 0, 2));
    thresholds(system, 0, 0.75, 0.75);
    thresholds(system, 1, 0.6, 0.1);
    thresholds(system, 2, 0.25, 0.25);
    system->command[0].gz[0] = system->command[1].gz[0] = 1;
    system->command[2].gz[0] = -1;
    system->command[2].g0 = 1;
    ns_time_events *s = schedule(system);
    assert_true(!ns_inputs_events_closed(s)[0] && !ns_inputs_events_closed(s)[1] &&
                ns_inputs_events_closed(s)[2]);
    for (int k = 0; k < 1000; k++) {
        const double tol = 2 * eps * (2 * k + 2);
        expect(s, 2 * k + 0.6, tol, 2);
        expect(s, 2 * k + 0.75, tol, 1 | 4); /* 0.25 = 1 - 0.75: together */
        expect(s, 2 * k + 1.25, tol, 1 | 4);
        expect(s, 2 * k + 1.9, tol, 2);
    }
    done(s, system);
}

/* The crest of a triangle is at the threshold: touched, up to rounding.  A millionth lower, and it flips. */
static void touching_is_not_crossing(void **state) {
    ns_system *system = bare(3, 3);
    (void)state;
    input(system, 0, pulse(0, 1, 0, 1, 1, 0, 2));
    input(system, 1, sine(0, 1, 0.25, 0, 0));
    input(system, 2, (ns_signal){.kind = NS_DC, .u.dc = 1});
    thresholds(system, 0, 1, 1);
    thresholds(system, 1, 1 - 1e-16, 1 - 1e-16);
    thresholds(system, 2, 3, 3);
    system->command[0].gz[0] = system->command[1].gz[1] = 1;
    system->command[2].gz[0] = system->command[2].gz[1] = system->command[2].gz[2] = 1;
    ns_time_events *s = schedule(system); /* 1: at 1, 5, ...; 2: both crests at 1, 5, ... */
    assert_true(isinf(ns_inputs_events_next(s, 1000)));
    ns_inputs_events_free(s);
    thresholds(system, 0, 1 - 1e-6, 1 - 1e-6);
    s = schedule(system);
    expect(s, 1 - 1e-6, 4 * eps, 1);
    expect(s, 1 + 1e-6, 4 * eps, 1);
    expect(s, 3 - 1e-6, 4 * eps, 1);
    done(s, system);
}

/* sin(2 pi t) is above 1 - d for |t - 1/4| < acos(1 - d)/(2 pi): seen though nothing else marks the place. */
static void a_short_excursion_is_not_missed(void **state) {
    static const double low[] = {0.5, 1e-3, 1e-6, 1e-9, 1e-11};
    (void)state;
    for (int i = 0; i < 5; i++) {
        const double d = 1 - (1 - low[i]), half = asin(sqrt(d / 2)) / pi; /* acos(1-d) = 2 asin(sqrt(d/2)) */
        ns_system *system = bare(1, 1);
        input(system, 0, sine(0, 1, 1, 0, 0));
        thresholds(system, 0, 1 - low[i], 1 - low[i]);
        system->command[0].gz[0] = 1;
        ns_time_events *s = schedule(system);
        for (int k = 0; k < 100; k++) {
            /* g is known to some eps, and turns round there: g' = 2 pi sin(2 pi half) */
            const double tol = 4 * eps * (k + 1) + 4 * eps * (1 + 2 * pi * k) / (2 * pi * sin(2 * pi * half));
            expect(s, k + 0.25 - half, tol, 1);
            expect(s, k + 0.25 + half, tol, 1);
        }
        done(s, system);
    }
}

/* Pulse width modulation: 0.5 + 0.4 sin(2 pi 50 t) over a triangle of 10 kHz crosses it twice a period, where
 * the difference vanishes; with the signs of the slopes. */
static void sine_and_triangle(void **state) {
    ns_system *system = bare(2, 2);
    const ns_signal reference = sine(0.5, 0.4, 50, 0, 0), carrier = pulse(0, 1, 0, 5e-5, 5e-5, 0, 1e-4);
    (void)state;
    input(system, 0, reference);
    input(system, 1, carrier);
    system->command[0].gz[0] = 1;
    system->command[0].gz[1] = -1;
    system->command[1].gz[0] = -1;
    system->command[1].gz[1] = 1;
    ns_time_events *s = schedule(system);
    assert_true(ns_inputs_events_closed(s)[0] && !ns_inputs_events_closed(s)[1]);
    for (int k = 0; k < 2000; k++) {
        const double t = ns_inputs_events_next(s, INFINITY);
        const ns_time_event *what = ns_inputs_events_pass(s);
        assert_int_equal(what->flips, 2);
        assert_int_equal(ns_inputs_events_closed(s)[0], k % 2);
        assert_true(t > k * 5e-5 && t < (k + 1) * 5e-5);
        /* t is off by an eps of 0.1, of a slope of 2e4 */
        assert_near(ns_signal_value(&reference, t, NS_LEFT), ns_signal_value(&carrier, t, NS_LEFT),
                    0.1 * 2e4 * 2 * eps);
    }
    done(s, system);
}

/* e^(20 t - 50) sin(2 pi t): the factor comes to 1 at 2.5, where the sine is negative until 3, and is above
 * 1e4 then. */
static void a_growing_sine(void **state) {
    ns_system *system = bare(1, 1);
    ns_signal z = sine(0, exp(-50), 1, 0, 0);
    (void)state;
    z.u.sin.theta = -20;
    input(system, 0, z);
    thresholds(system, 0, 1, 1);
    system->command[0].gz[0] = 1;
    ns_time_events *s = schedule(system);
    const double t = ns_inputs_events_next(s, INFINITY);
    assert_true(t > 3 && t < 3.25);
    assert_near(exp(20 * t - 50) * sin(2 * pi * t), 1, 2 * 4 * eps * 2 * pi * exp(10.1)); /* 2 eps t g' */
    done(s, system);
}

/* sin(2 pi t) changes its sign at k/2, where all that is left of it is rounding; and so does its sum with a
 * slow line.  From each instant the way goes on alike after a seek. */
static void zero_crossings(void **state) {
    ns_system *system = bare(2, 2);
    (void)state;
    input(system, 0, sine(0, 1, 1, 0, 0));
    input(system, 1, pulse(-1e-9, 1e-9, 0.05, 1e6, 1, 1, INFINITY));
    system->command[0].gz[0] = system->command[1].gz[0] = system->command[1].gz[1] = 1;
    ns_time_events *s = schedule(system);
    const ns_time_event *what = expect(s, ns_inputs_events_next(s, 0.5), 0, 3 & ~2u);
    assert_near(what->t, 0, 4 * eps);
    int flips = 0;
    for (int k = 0; ns_inputs_events_next(s, 10000.25) <= 10000.25; k++) {
        what = ns_inputs_events_pass(s);
        flips += what->flips;
        assert_near(2 * what->t, round(2 * what->t), 2e-9);
        if (k % 7 == 0) {
            unsigned char closed[2];
            memcpy(closed, ns_inputs_events_closed(s), 2);
            ns_inputs_events_seek(s, what->t, NS_RIGHT, closed);
        }
    }
    assert_int_equal(flips, 20000 + 20001);
    done(s, system);
}

/* Thresholds 3e-17 apart, which g = t - 1 + 1 is not known to: both switches flip at once, though the
 * instants differ by more than roundings of t. */
static void rounding_of_the_control(void **state) {
    ns_system *system = bare(1, 2);
    (void)state;
    input(system, 0, pulse(-1, 1, -1, 2, 2, 2, INFINITY));
    thresholds(system, 0, 1, 1);
    thresholds(system, 1, 1 + 2 * eps, 1);
    for (int c = 0; c < 2; c++) {
        system->command[c].gz[0] = 1;
        system->command[c].g0 = 1;
    }
    ns_time_events *s = schedule(system);
    ns_inputs_events_seek(s, -0.5, NS_RIGHT, NULL);
    expect(s, 0, 0, 3);
    done(s, system);
}

/* 1 - e^-t passes 1/2 at ln 2; from 1 s on e^-(t-1) less, it is back there where
 * e^-(t-1) - e^-t = 1/2:  t = ln(2 (e - 1)). */
static void an_exponential(void **state) {
    ns_system *system = bare(1, 1);
    (void)state;
    input(system, 0, (ns_signal){.kind = NS_EXP, .u.exp = {0, 1, 0, 1, 1, 1}});
    thresholds(system, 0, 0.5, 0.5);
    system->command[0].gz[0] = 1;
    ns_time_events *s = schedule(system);
    expect(s, log(2), 8 * eps, 1);
    expect(s, log(2 * (exp(1) - 1)), 8 * eps, 1);
    assert_true(isinf(ns_inputs_events_next(s, 1e6)));
    done(s, system);
}

/* 1000 triangles, each a thousandth of a period after the other, over 0.75: two flips a period of each, in
 * order. */
static void many_switches(void **state) {
    enum { N = 1000 };
    ns_system *system = bare(N, N);
    int seen[N] = {0};
    (void)state;
    for (int i = 0; i < N; i++) {
        input(system, i, pulse(0, 1, i * 2e-3, 1, 1, 0, 2));
        thresholds(system, i, 0.75, 0.75);
        system->command[i].gz[i] = 1;
    }
    ns_time_events *s = schedule(system);
    double before = 0;
    while (ns_inputs_events_next(s, 22) <= 22) {
        const ns_time_event *what = ns_inputs_events_pass(s);
        assert_true(what->t > before);
        before = what->t;
        for (int i = 0; i < what->flips; i++) {
            const int c = what->flip[i], k = seen[c]++, period = k / 2;
            assert_near(what->t, c * 2e-3 + 2 * period + (k % 2 ? 1.25 : 0.75), 64 * eps * 22);
        }
    }
    for (int i = 0; i < N; i++)
        assert_true(seen[i] >= 20 && seen[i] <= 22);
    done(s, system);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(flips_of_a_triangle),
        cmocka_unit_test(touching_is_not_crossing),
        cmocka_unit_test(a_short_excursion_is_not_missed),
        cmocka_unit_test(sine_and_triangle),
        cmocka_unit_test(a_growing_sine),
        cmocka_unit_test(zero_crossings),
        cmocka_unit_test(rounding_of_the_control),
        cmocka_unit_test(an_exponential),
        cmocka_unit_test(many_switches),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
