/* tests/unit/inputs/test_time_events_random.c - schedules of random systems against what else knows of
 * signals: corners and values (signal.h), and the instants at which the marcher, which only looks at the ends
 * of its steps, flips the switches. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "dice.h"
#include "inputs/time_events_internal.h"
#include "nonsmooth.h"
#include "system/active_inputs.h"

enum { INPUTS = 4, COMMANDS = 5, SYSTEMS = 300, POINTS = 6 };
static const double end = 40, eps = DBL_EPSILON;

static double of_time(dice *d) { /* a multiple of 1/8 as often as not: coincidences */
    return dice_chance(d, 0.5) ? (1 + dice_below(d, 40)) / 8.0 : 5 * dice_uniform(d) + 0.05;
}

static double of_value(dice *d) {
    return dice_chance(d, 0.5) ? dice_eighths(d, 2) : 2 * dice_either(d);
}

static ns_signal a_pulse(dice *d) {
    ns_signal s = {.kind = NS_PULSE};
    const double per = 1 + of_time(d);
    s.u.pulse.v1 = of_value(d);
    s.u.pulse.v2 = of_value(d);
    s.u.pulse.td = dice_chance(d, 0.3) ? 0 : of_time(d) - 1;
    s.u.pulse.tr = dice_chance(d, 0.3) ? 0 : of_time(d) / 4;
    s.u.pulse.tf = dice_chance(d, 0.3) ? 0 : of_time(d) / 4;
    s.u.pulse.pw = dice_chance(d, 0.2) ? 0 : of_time(d) / 3;
    s.u.pulse.per = dice_chance(d, 0.2) ? INFINITY : per;
    s.u.pulse.cycles = dice_chance(d, 0.2) ? 1 + dice_below(d, 4) : 0;
    return s;
}

static ns_signal a_pwl(dice *d, double *t, double *v) {
    ns_signal s = {.kind = NS_PWL};
    const int n = 1 + dice_below(d, POINTS);
    t[0] = dice_chance(d, 0.5) ? 0 : of_time(d) - 1;
    for (int i = 0; i < n; i++) {
        v[i] = of_value(d);
        if (i > 0)
            t[i] = t[i - 1] + (dice_chance(d, 0.2) ? 0 : of_time(d));
    }
    s.u.pwl.n = n;
    s.u.pwl.t = t;
    s.u.pwl.v = v;
    s.u.pwl.repeat = NAN;
    const int back = dice_below(d, n);
    if (t[back] < t[n - 1] - 0.5 && dice_chance(d, 0.5))
        s.u.pwl.repeat = t[back];
    s.u.pwl.td = dice_chance(d, 0.5) ? 0 : of_time(d);
    return s;
}

static ns_signal a_curve(dice *d) {
    if (dice_chance(d, 0.6))
        return (ns_signal){.kind = NS_SIN,
                           .u.sin = {of_value(d), of_value(d), 2 * dice_either(d), of_time(d) - 1,
                                     dice_chance(d, 0.5) ? 0 : 0.1 * dice_either(d), 360 * dice_either(d)}};
    const double td1 = of_time(d) - 0.5;
    return (ns_signal){.kind = NS_EXP,
                       .u.exp = {of_value(d), of_value(d), td1, of_time(d),
                                 td1 + (dice_chance(d, 0.9) ? of_time(d) : -0.25), of_time(d)}};
}

/* C v' = -v, and switches that close nothing (y = 0 - e): all that happens is what the inputs do. */
static ns_system *a_system(dice *d, int curves) {
    ns_system *s;
    double t[POINTS], v[POINTS];
    assert_int_equal(ns_system_create(1, COMMANDS, INPUTS, COMMANDS, &s), NS_OK);
    s->M[0] = 1;
    s->A[0] = -1;
    for (int i = 0; i < INPUTS; i++) {
        ns_signal z = dice_chance(d, 0.5) ? a_pulse(d) : a_pwl(d, t, v);
        if (curves && dice_chance(d, 0.4))
            z = a_curve(d);
        assert_int_equal(ns_system_set_input(s, i, &z), NS_OK);
        s->E[i] = dice_chance(d, 0.5) ? 1e-3 : 0;
    }
    for (int c = 0; c < COMMANDS; c++) {
        ns_command *k = &s->command[c];
        s->D[c + c * COMMANDS] = 1;
        k->pair = c;
        k->gz = calloc(INPUTS, sizeof *k->gz);
        for (int i = 0, used = dice_below(d, 3); i <= used; i++)
            k->gz[dice_below(d, INPUTS)] = dice_chance(d, 0.5) ? dice_integer(d, 2) : dice_either(d);
        k->g0 = of_value(d);
        k->off = of_value(d);
        k->on = k->off + (dice_chance(d, 0.5) ? 0 : fabs(of_value(d)));
    }
    return s;
}

static ns_time_events *schedule_of(const ns_system *system) {
    unsigned char acting[INPUTS];
    ns_time_events *s;
    assert_int_equal(ns_system_acting(system, acting), NS_OK);
    assert_int_equal(ns_inputs_events_create(system, acting, &s), NS_OK);
    return s;
}

/* --- corners and values --- */

static double next_corner(const ns_system *s, double t) {
    double next = INFINITY;
    for (int i = 0; i < s->nz; i++)
        if (s->E[i] != 0)
            next = fmin(next, ns_signal_next_corner(&s->z[i], t));
    return next;
}

/* What the schedule says an input is. */
static double scheduled(const ns_time_events *s, int input, double t, const double *z) {
    const ns_wave *wave;
    const ns_wave_term *term;
    double value = z[input], cosine, sine;
    const int terms = ns_inputs_events_terms(s, &term);
    ns_inputs_events_waves(s, &wave);
    for (int k = 0; k < terms; k++)
        if (term[k].input == input && s->begun[k]) {
            ns_inputs_wave_at(&wave[term[k].wave], t, &cosine, &sine);
            value += term[k].cc * cosine + term[k].cs * sine;
        }
    return value;
}

/* Slopes are below 2/0.0125 or jumps; times are off by some eps of 50, growing sines by as much of e^4. */
static void check_values(const ns_time_events *s, const ns_system *system, double t, ns_side side) {
    double z[INPUTS] = {0}, dz[INPUTS] = {0};
    ns_inputs_events_values(s, t, z, dz);
    for (int i = 0; i < system->nz; i++)
        if (system->E[i] != 0) {
            const double is = ns_signal_value(&system->z[i], t, side), says = scheduled(s, i, t, z);
            assert_true(fabs(is - says) <= 64 * eps * 50 * 200);
        }
}

/* Jumps are of eighths, or random; slopes move values by some eps. */
static int jumps(const ns_system *s, double t) {
    int jump = 0;
    for (int i = 0; i < s->nz; i++)
        jump |= s->E[i] != 0 &&
                fabs(ns_signal_value(&s->z[i], t, NS_LEFT) - ns_signal_value(&s->z[i], t, NS_RIGHT)) > 1e-9;
    return jump;
}

static void corners_and_values(void **state) {
    (void)state;
    for (unsigned k = 0; k < SYSTEMS; k++) {
        dice d = dice_make(71, k);
        ns_system *system = a_system(&d, 1);
        for (int c = 0; c < COMMANDS; c++) /* none that is a function of time only */
            system->command[c].gx = calloc(1, sizeof(double));
        for (int c = 0; c < COMMANDS; c++)
            memset(system->command[c].gz, 0, sizeof(double) * INPUTS);
        ns_time_events *s = schedule_of(system);
        for (double t = 0; t < end;) {
            double next = ns_inputs_events_next(s, end), corner = next_corner(system, t);
            /* corners of nothing are left out */
            while (corner < next - 64 * eps * end && corner < end) {
                check_values(s, system, corner, NS_LEFT);
                check_values(s, system, corner, NS_RIGHT);
                corner = next_corner(system, corner);
            }
            if (next > end)
                break;
            assert_true(fabs(next - corner) <= 16 * eps * end);
            check_values(s, system, t + (next - t) * dice_uniform(&d), NS_LEFT);
            check_values(s, system, next, NS_LEFT);
            const ns_time_event *what = ns_inputs_events_pass(s);
            assert_true(what->jump || what->turn);
            assert_int_equal(what->jump, jumps(system, what->t));
            check_values(s, system, what->t, NS_RIGHT);
            t = what->t;
        }
        ns_inputs_events_free(s);
        ns_system_free(system);
    }
}

/* --- flips --- */

typedef struct flips {
    int n;
    double t[4000];
    unsigned char closed[4000][COMMANDS];
} flips;

static void keep(flips *f, double t, const unsigned char *closed) {
    assert_true(f->n < 4000);
    if (f->n > 0 && memcmp(f->closed[f->n - 1], closed, COMMANDS) == 0)
        return;
    f->t[f->n] = t;
    memcpy(f->closed[f->n++], closed, COMMANDS);
}

static void closed_of(const ns_march *m, unsigned char *closed) {
    for (int c = 0; c < COMMANDS; c++)
        closed[c] = ns_march_mode(m)[c] == NS_INSIDE;
}

static void by_marching(const ns_system *s, double h, flips *f) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = h};
    const double w0 = 0;
    ns_march *m;
    double t = 0;
    unsigned char closed[COMMANDS];
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_start(m, 0, &w0), NS_OK);
    ns_march_read(m, &t, NULL, NULL, NULL);
    closed_of(m, closed);
    keep(f, 0, closed);
    while (t < end) {
        double at = t;
        assert_int_equal(ns_march_try(m, end, NS_TO_EVENT, &t), NS_OK);
        assert_int_equal(ns_march_accept(m), NS_OK);
        if (!ns_march_at_event(m)) {
            closed_of(m, closed);
            keep(f, at, closed);
        }
    }
    ns_march_free(m);
}

static void by_schedule(const ns_system *system, flips *f) {
    ns_time_events *s = schedule_of(system);
    keep(f, 0, ns_inputs_events_closed(s));
    while (ns_inputs_events_next(s, end) <= end) {
        const ns_time_event *what = ns_inputs_events_pass(s);
        keep(f, what->t, ns_inputs_events_closed(s));
    }
    ns_inputs_events_free(s);
}

static void compare(const ns_system *s, unsigned k, double h) {
    static flips a, b;
    a.n = b.n = 0;
    by_marching(s, h, &a);
    by_schedule(s, &b);
    for (int i = 0; i < a.n && i < b.n; i++) {
        if (fabs(a.t[i] - b.t[i]) > 1e-5 || memcmp(a.closed[i], b.closed[i], COMMANDS) != 0) {
            print_message("system %u: flip %d at %.17g and %.17g, states", k, i, a.t[i], b.t[i]);
            for (int c = 0; c < COMMANDS; c++)
                print_message(" %d-%d", a.closed[i][c], b.closed[i][c]);
            print_message("\n");
            fail();
        }
    }
    assert_int_equal(a.n, b.n);
}

static void flips_of_lines(void **state) {
    (void)state;
    for (unsigned k = 0; k < SYSTEMS; k++) {
        dice d = dice_make(72, k);
        ns_system *s = a_system(&d, 0);
        compare(s, k, 0.5);
        ns_system_free(s);
    }
}

static void flips_of_curves(void **state) {
    (void)state;
    for (unsigned k = 0; k < SYSTEMS; k++) {
        dice d = dice_make(73, k);
        ns_system *s = a_system(&d, 1);
        compare(s, k, 0.01);
        ns_system_free(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(corners_and_values),
        cmocka_unit_test(flips_of_lines),
        cmocka_unit_test(flips_of_curves),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
