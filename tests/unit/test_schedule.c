/* tests/unit/test_schedule.c - what is known ahead of time, against closed forms. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "engine/schedule.h"
#include "nonsmooth.h"
#include "wrap_alloc.h"

static const double eps = DBL_EPSILON, pi = 3.14159265358979323846;

static void assert_near(double is, double should, double tol) {
    if (!(fabs(is - should) <= tol))
        print_message("%.17g is not %.17g\n", is, should);
    assert_true(fabs(is - should) <= tol);
}

static ns_signal pulse(double v1, double v2, double td, double tr, double tf, double pw, double per) {
    return (ns_signal){.kind = NS_PULSE, .u.pulse = {v1, v2, td, tr, tf, pw, per, 0}};
}

static ns_signal sine(double vo, double va, double freq, double td, double phase) {
    return (ns_signal){.kind = NS_SIN, .u.sin = {vo, va, freq, td, 0, phase}};
}

/* One unknown, nz inputs that do not enter, nc commands of no input. */
static ns_system *bare(int nz, int nc) {
    ns_system *s;
    assert_int_equal(ns_system_create(1, nc, nz, nc, &s), NS_OK);
    s->M[0] = 1;
    for (int c = 0; c < nc; c++) {
        s->command[c].pair = c;
        s->command[c].gz = calloc((size_t)nz + 1, sizeof(double));
        assert_non_null(s->command[c].gz);
    }
    return s;
}

static void input(ns_system *s, int i, ns_signal z) {
    assert_int_equal(ns_system_set_input(s, i, &z), NS_OK);
}

static void thresholds(ns_system *s, int c, double on, double off) {
    s->command[c].on = on;
    s->command[c].off = off;
}

static ns_schedule *schedule(const ns_system *s) {
    ns_schedule *made;
    assert_int_equal(ns_schedule_create(s, NULL, &made), NS_OK);
    return made;
}

static void done(ns_schedule *s, ns_system *system) {
    ns_schedule_free(s);
    ns_system_free(system);
}

/* The next instant is at t, and flips commands as the bits of which say; NULL if it does not. */
static const ns_instant *expect(ns_schedule *s, double t, double tol, unsigned which) {
    unsigned bits = 0;
    assert_near(ns_schedule_next(s, INFINITY), t, tol);
    const ns_instant *what = ns_schedule_go(s);
    for (int i = 0; i < what->flips; i++)
        bits |= 1u << what->flip[i];
    assert_int_equal(bits, which);
    return what;
}

/* --- inputs --- */

/* 1 to 5 in 2 s from t = 10, 4 s, back in 1 s, every 20 s: corners at 10, 12, 16, 17 and every 20 s after. */
static void corners_of_a_pulse(void **state) {
    ns_system *system = bare(2, 0);
    double z[2] = {-7, -7}, dz[2] = {-7, -7};
    (void)state;
    input(system, 0, pulse(1, 5, 10, 2, 1, 4, 20));
    input(system, 1, pulse(0, 1, 3, 0, 0, 1, 2)); /* does not enter */
    system->E[0] = 1;
    ns_schedule *s = schedule(system);
    for (int k = 0; k < 1000; k++) {
        static const double at[] = {10, 12, 16, 17}, v[] = {1, 5, 5, 1}, slope[] = {2, 0, -4, 0};
        for (int i = 0; i < 4; i++) {
            const ns_instant *what = expect(s, at[i] + 20 * k, 0, 0); /* integers: exact */
            assert_int_equal(what->jump, 0);
            assert_int_equal(what->turn, 1);
            assert_int_equal(what->inputs, 1);
            assert_int_equal(what->input[0], 0);
            ns_schedule_inputs(s, what->t, z, dz);
            assert_near(z[0], v[i], 0);
            assert_near(dz[0], slope[i], 0);
            ns_schedule_inputs(s, what->t + 0.25, z, dz);
            assert_near(z[0], v[i] + 0.25 * slope[i], 0);
            assert_near(z[1], -7, 0); /* left alone */
        }
    }
    assert_true(isinf(ns_schedule_next(s, 20009)));
    done(s, system);
}

/* A jump at 1 with an other input's turn there, which t = 0.1 + 0.2 + ... also reaches: one instant. */
static void what_happens_together_is_one_instant(void **state) {
    ns_system *system = bare(2, 0);
    (void)state;
    input(system, 0, pulse(0, 1, 1, 0, 0, 0.5, 10));
    input(system, 1, pulse(0, 1, 0.3 + 0.7 * (1 + eps), 0.5, 0.5, 1, INFINITY));
    system->E[0] = system->E[1] = 1;
    ns_schedule *s = schedule(system);
    const ns_instant *what = expect(s, 1, 4 * eps, 0);
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
    ns_schedule *s = schedule(system);
    ns_schedule_seek(s, 0.5, NS_RIGHT, NULL);
    expect(s, 3, 0, 0);
    assert_true(isinf(ns_schedule_next(s, INFINITY)));
    done(s, system);
}

/* Three phases are one wave; a delay is another; an exponential is two. */
static void waves_are_shared(void **state) {
    ns_system *system = bare(5, 0);
    const ns_wave *wave;
    const ns_wave_term *term;
    const int *entering;
    double z[5] = {0}, dz[5], c, sn;
    (void)state;
    for (int i = 0; i < 3; i++)
        input(system, i, sine(i, 2, 50, 0, 120 * i));
    input(system, 3, sine(0, 1, 50, 0.5, 90));
    input(system, 4, (ns_signal){.kind = NS_EXP, .u.exp = {1, 3, 1, 0.25, 2, 0.5}});
    for (int i = 0; i < 5; i++)
        system->E[i] = 1;
    ns_schedule *s = schedule(system);
    assert_int_equal(ns_schedule_waves(s, &wave), 4);
    assert_int_equal(ns_schedule_terms(s, &term), 6);
    assert_int_equal(ns_schedule_entering(s, &entering), 5);
    ns_schedule_inputs(s, 0.25, z, dz);
    ns_wave_at(&wave[0], 0.003, &c, &sn);
    assert_near(c, cos(2 * pi * 50 * 0.003), 8 * eps);
    assert_near(sn, sin(2 * pi * 50 * 0.003), 8 * eps);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(term[i].wave, 0);
        assert_near(z[i] + term[i].cc * c + term[i].cs * sn, i + 2 * sin(2 * pi * (50 * 0.003 + i / 3.0)),
                    32 * eps);
    }
    assert_near(z[3], 1, eps); /* sin 90 degrees, until its delay is over */
    assert_near(z[4], 1, 0);
    const ns_instant *what = expect(s, 0.5, 0, 0);
    assert_true(what->turn && !what->jump && what->input[0] == 3);
    ns_schedule_inputs(s, 0.5, z, dz);
    assert_near(z[3], 0, 0);
    expect(s, 1, 0, 0);
    expect(s, 2, 0, 0);
    ns_schedule_inputs(s, 3, z, dz); /* at 3: 1 + 2 - 2 - 2 e^-8 + 2 e^-2 */
    for (int k = 4; k < 6; k++) {
        assert_int_equal(ns_schedule_term_counts(s, k), 1);
        ns_wave_at(&wave[term[k].wave], 3, &c, &sn);
        z[4] += term[k].cc * c + term[k].cs * sn;
    }
    assert_near(z[4], 1 - 2 * exp(-8) + 2 * exp(-2), 16 * eps);
    assert_true(isinf(ns_schedule_next(s, INFINITY)));
    done(s, system);
}

/* --- commands --- */

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
    ns_schedule *s = schedule(system);
    assert_true(!ns_schedule_closed(s)[0] && !ns_schedule_closed(s)[1] && ns_schedule_closed(s)[2]);
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
    ns_schedule *s = schedule(system); /* 1: at 1, 5, ...; 2: both crests at 1, 5, ... */
    assert_true(isinf(ns_schedule_next(s, 1000)));
    ns_schedule_free(s);
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
        ns_schedule *s = schedule(system);
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
    ns_schedule *s = schedule(system);
    assert_true(ns_schedule_closed(s)[0] && !ns_schedule_closed(s)[1]);
    for (int k = 0; k < 2000; k++) {
        const double t = ns_schedule_next(s, INFINITY);
        const ns_instant *what = ns_schedule_go(s);
        assert_int_equal(what->flips, 2);
        assert_int_equal(ns_schedule_closed(s)[0], k % 2);
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
    ns_schedule *s = schedule(system);
    const double t = ns_schedule_next(s, INFINITY);
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
    ns_schedule *s = schedule(system);
    const ns_instant *what = expect(s, ns_schedule_next(s, 0.5), 0, 3 & ~2u);
    assert_near(what->t, 0, 4 * eps);
    int flips = 0;
    for (int k = 0; ns_schedule_next(s, 10000.25) <= 10000.25; k++) {
        what = ns_schedule_go(s);
        flips += what->flips;
        assert_near(2 * what->t, round(2 * what->t), 2e-9);
        if (k % 7 == 0) {
            unsigned char closed[2];
            memcpy(closed, ns_schedule_closed(s), 2);
            ns_schedule_seek(s, what->t, NS_RIGHT, closed);
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
    ns_schedule *s = schedule(system);
    ns_schedule_seek(s, -0.5, NS_RIGHT, NULL);
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
    ns_schedule *s = schedule(system);
    expect(s, log(2), 8 * eps, 1);
    expect(s, log(2 * (exp(1) - 1)), 8 * eps, 1);
    assert_true(isinf(ns_schedule_next(s, 1e6)));
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
    ns_schedule *s = schedule(system);
    ns_schedule_seek(s, 802, NS_RIGHT, &closed);
    expect(s, 807, 1e-12, 1);
    ns_schedule_seek(s, 802, NS_RIGHT, &open);
    expect(s, 803, 1e-12, 1);
    ns_schedule_seek(s, 6, NS_RIGHT, NULL); /* between: open */
    expect(s, 11, 1e-12, 1);
    ns_schedule_seek(s, 4, NS_RIGHT, &open); /* a contradiction */
    expect(s, 4, 0, 1);
    expect(s, 7, 1e-12, 1);
    ns_schedule_seek(s, 3, NS_LEFT, &open);
    expect(s, 3, 0, 1);
    ns_schedule_seek(s, 3, NS_RIGHT, &closed);
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
    ns_schedule *s = schedule(system);
    ns_schedule_seek(s, 3, NS_LEFT, &closed);
    expect(s, 3, 1e-12, 1);
    ns_schedule_seek(s, 2.5, NS_RIGHT, &closed);
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
    ns_schedule *s = schedule(system);
    ns_schedule_seek(s, 5, NS_LEFT, &closed);
    ns_schedule_inputs(s, 5, &z, &dz);
    assert_near(z, 0, 0);
    const ns_instant *what = expect(s, 5, 0, 1);
    assert_true(what->jump);
    ns_schedule_inputs(s, 5, &z, &dz);
    assert_near(z, 2, 0);
    expect(s, 6, 0, 1);
    closed = 1;
    ns_schedule_seek(s, 5, NS_RIGHT, &closed);
    ns_schedule_inputs(s, 5, &z, &dz);
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
    ns_schedule *s = schedule(system);
    ns_schedule_seek(s, 1, NS_RIGHT, NULL);
    double before = 1;
    for (int k = 0; k < 100; k++) {
        const double t = ns_schedule_next(s, INFINITY);
        assert_true(t >= before && t < 1 + 1e-12);
        before = ns_schedule_go(s)->t;
    }
    assert_true(before > 1);
    done(s, system);
}

/* --- many switches, no memory --- */

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
    ns_schedule *s = schedule(system);
    double before = 0;
    while (ns_schedule_next(s, 22) <= 22) {
        const ns_instant *what = ns_schedule_go(s);
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

static void no_memory(void **state) {
    ns_system *system = bare(3, 2);
    (void)state;
    input(system, 0, pulse(0, 1, 0, 1, 1, 0, 2));
    input(system, 1, sine(0, 1, 1, 0, 0));
    input(system, 2, pulse(0, 1, 0, 1, 1, 1, 5));
    thresholds(system, 0, 0.5, 0.5);
    thresholds(system, 1, 0.5, 0.5);
    system->command[0].gz[0] = system->command[1].gz[1] = system->E[2] = 1;
    for (long k = 1;; ++k) {
        ns_schedule *s;
        fail_alloc_at(k);
        const int status = ns_schedule_create(system, NULL, &s);
        const long made = allocs_made();
        fail_alloc_off();
        if (made < k) {
            assert_int_equal(status, NS_OK);
            ns_schedule_free(s);
            break;
        }
        assert_int_equal(status, NS_E_MEMORY);
        assert_null(s);
    }
    assert_int_equal(ns_schedule_create(system, NULL, NULL), NS_E_NULL);
    ns_schedule *s;
    assert_int_equal(ns_schedule_create(NULL, NULL, &s), NS_E_NULL);
    ns_schedule_free(NULL);
    ns_system_free(system);
}

/* No input, no command: nothing ever happens. */
static void an_empty_schedule(void **state) {
    ns_system *system = bare(0, 0);
    (void)state;
    ns_schedule *s = schedule(system);
    assert_true(isinf(ns_schedule_next(s, INFINITY)));
    assert_int_equal(ns_schedule_go(s)->flips, 0);
    assert_near(ns_schedule_time(s), 0, 0);
    done(s, system);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(corners_of_a_pulse),
        cmocka_unit_test(what_happens_together_is_one_instant),
        cmocka_unit_test(corners_of_nothing),
        cmocka_unit_test(waves_are_shared),
        cmocka_unit_test(flips_of_a_triangle),
        cmocka_unit_test(touching_is_not_crossing),
        cmocka_unit_test(a_short_excursion_is_not_missed),
        cmocka_unit_test(sine_and_triangle),
        cmocka_unit_test(a_growing_sine),
        cmocka_unit_test(zero_crossings),
        cmocka_unit_test(rounding_of_the_control),
        cmocka_unit_test(an_exponential),
        cmocka_unit_test(seek_takes_the_states_it_is_told),
        cmocka_unit_test(seek_to_where_a_control_falls_to_nothing),
        cmocka_unit_test(both_sides_of_a_jump),
        cmocka_unit_test(periods_shorter_than_rounding),
        cmocka_unit_test(many_switches),
        cmocka_unit_test(no_memory),
        cmocka_unit_test(an_empty_schedule),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
