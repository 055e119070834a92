/* tests/unit/inputs/test_time_events_random.c - schedules of random systems against what else knows of
 * signals: corners and values (signal.h), the instants found by looking at controls between corners and
 * crests and bisection, and those at which the marcher flips the switches. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "dice_signals.h"
#include "inputs/time_events_internal.h"
#include "nonsmooth.h"
#include "system/active_inputs.h"

enum { INPUTS = 4, COMMANDS = 5, SYSTEMS = 300 };
static const double end = 40, eps = DBL_EPSILON;

/* C v' = -v, and switches that close nothing (y = 0 - e): all that happens is what the inputs do. */
static ns_system *a_system(dice *d, int curves) {
    ns_system *s;
    double room[DICE_SIGNAL_ROOM];
    assert_int_equal(ns_system_create(1, COMMANDS, INPUTS, COMMANDS, &s), NS_OK);
    s->M[0] = 1;
    s->A[0] = -1;
    for (int i = 0; i < INPUTS; i++) {
        ns_signal z = dice_line(d, room);
        if (curves && dice_chance(d, 0.4))
            z = dice_curve(d);
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
        k->g0 = dice_value(d);
        k->off = dice_value(d);
        k->on = k->off + (dice_chance(d, 0.5) ? 0 : fabs(dice_value(d)));
    }
    return s;
}

static ns_time_events *schedule_of(const ns_system *system) {
    unsigned char active[INPUTS];
    ns_time_events *s;
    assert_int_equal(ns_system_active_inputs(system, active), NS_OK);
    assert_int_equal(ns_inputs_events_create(system, active, &s), NS_OK);
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
    const ns_wave *wave = s->wave;
    const ns_wave_term *term = s->term;
    double value = z[input], cosine, sine;
    for (int k = 0; k < s->terms; k++)
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

/* By how much the control of command c is beyond the threshold that flips it, less tol times its terms. */
static double excess(const ns_system *s, int c, int closed, double t, ns_side side, double tol) {
    const ns_command *k = &s->command[c];
    double g = k->g0, size = fabs(k->g0);
    for (int i = 0; i < s->nz; i++) {
        const double term = k->gz[i] * ns_signal_value(&s->z[i], t, side);
        g += term;
        size += fabs(term);
    }
    return (closed ? k->off - g : g - k->on) - tol * size;
}

/* The first crest or trough of a sine after t, as if undamped. */
static double next_crest(const ns_signal *s, double t) {
    const double half = 0.5 / fabs(s->u.sin.freq), sign = s->u.sin.freq < 0 ? -1 : 1;
    double first = s->u.sin.td + (0.25 - sign * s->u.sin.phase / 360) * 2 * half;
    first += half * ceil((s->u.sin.td - first) / half);
    const double crest = first + half * fmax(0, floor((t - first) / half) + 1);
    return crest <= t + 1e-6 * half ? crest + half : crest;
}

/* Between t and this no control turns round but by damping, or by waves that oppose each other. */
static double next_look(const ns_system *s, double t, double step) {
    double next = fmin(end, t + step);
    for (int i = 0; i < s->nz; i++) {
        next = fmin(next, ns_signal_next_corner(&s->z[i], t));
        if (s->z[i].kind == NS_SIN && s->z[i].u.sin.freq != 0 && s->z[i].u.sin.va != 0)
            next = fmin(next, next_crest(&s->z[i], t));
    }
    return next;
}

static double bisect(const ns_system *s, int c, int closed, double a, double b) {
    for (int i = 0; i < 100 && excess(s, c, closed, a, NS_RIGHT, 0) <= 0; i++) {
        const double middle = a + (b - a) / 2;
        if (!(middle > a && middle < b))
            break;
        *(excess(s, c, closed, middle, NS_LEFT, 0) > 0 ? &b : &a) = middle;
    }
    return a;
}

/* Flips those of the commands in which (NULL: all) that are beyond their threshold at t; how many. */
static int flip_beyond(const ns_system *s, double t, ns_side side, double tol, const unsigned char *which,
                       unsigned char *closed) {
    int count = 0;
    for (int c = 0; c < COMMANDS; c++)
        if ((!which || which[c]) && excess(s, c, closed[c], t, side, tol) > 0) {
            closed[c] = !closed[c];
            count++;
        }
    return count;
}

static void by_looking(const ns_system *s, double step, flips *f) {
    unsigned char closed[COMMANDS] = {0};
    flip_beyond(s, 0, NS_RIGHT, 1e-12, NULL, closed);
    keep(f, 0, closed);
    for (double t = 0; t < end;) {
        const double look = next_look(s, t, step);
        unsigned char due[COMMANDS];
        double first = INFINITY;
        for (int c = 0; c < COMMANDS; c++) {
            due[c] = excess(s, c, closed[c], look, NS_LEFT, 1e-12) > 0;
            if (due[c])
                first = fmin(first, bisect(s, c, closed[c], t, look));
        }
        if (first < look && flip_beyond(s, fmin(look, first + 8 * eps * first), NS_LEFT, -1e-12, due, closed))
            keep(f, first, closed);
        t = fmin(look, first + 1e-7);
        if (t == look && flip_beyond(s, t, NS_RIGHT, 1e-12, NULL, closed))
            keep(f, t, closed);
    }
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

static void compare(const flips *a, const flips *b, unsigned k) {
    for (int i = 0; i < a->n && i < b->n; i++) {
        if (fabs(a->t[i] - b->t[i]) > 1e-5 || memcmp(a->closed[i], b->closed[i], COMMANDS) != 0) {
            print_message("system %u: flip %d at %.17g and %.17g, states", k, i, a->t[i], b->t[i]);
            for (int c = 0; c < COMMANDS; c++)
                print_message(" %d-%d", a->closed[i][c], b->closed[i][c]);
            print_message("\n");
            fail();
        }
    }
    assert_int_equal(a->n, b->n);
}

static void compare_all(const ns_system *s, unsigned k, double h) {
    static flips looked, marched, scheduled;
    looked.n = marched.n = scheduled.n = 0;
    by_looking(s, h, &looked);
    by_marching(s, h, &marched);
    by_schedule(s, &scheduled);
    compare(&looked, &scheduled, k);
    compare(&marched, &scheduled, k);
}

static void flips_of_lines(void **state) {
    (void)state;
    for (unsigned k = 0; k < SYSTEMS; k++) {
        dice d = dice_make(72, k);
        ns_system *s = a_system(&d, 0);
        compare_all(s, k, 0.5);
        ns_system_free(s);
    }
}

static void flips_of_curves(void **state) {
    (void)state;
    for (unsigned k = 0; k < SYSTEMS; k++) {
        dice d = dice_make(73, k);
        ns_system *s = a_system(&d, 1);
        compare_all(s, k, 0.01);
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
