/* tests/rig/dense_output.h - points on the way of trials with NS_TO_STEP, compared with trials that end
 * there.
 */
#ifndef DENSE_OUTPUT_H
#define DENSE_OUTPUT_H

#include <string.h>

#include "converters.h"
#include "dice.h"

static const double pi = 3.14159265358979323846;
static const ns_switch comparator = {0, 0, 0, INFINITY};
static const double fractions[] = {0, 0.011, 0.1, 0.37, 0.5, 0.77, 0.95, 1};
enum { SAMPLES = sizeof fractions / sizeof *fractions, PAIRS = 64 };

static inline void ok(int status) {
    assert_int_equal(status, NS_OK);
}

typedef struct point {
    double t, x[MOST], lambda[PAIRS];
} point;

static inline point sampled(scene *z, double t) {
    point p = {.t = t};
    ok(ns_march_sample(z->m, t, p.x, p.lambda));
    return p;
}

static inline point shown(scene *z) {
    point p = {0};
    ok(ns_march_read(z->m, &p.t, p.x, p.lambda, NULL));
    return p;
}

/* The sparse engine adds a stage each time a point inside of a step is read, up to nine. */
static inline point shown_at_last(scene *z) {
    for (int i = 0; i < 9; i++)
        (void)shown(z);
    return shown(z);
}

/* The largest difference, relative to 1 and to the largest value of each kind. */
static inline double apart(const scene *z, const point *a, const point *b) {
    double worst = 0, x = 1, lambda = 1;
    for (int i = 0; i < z->s->n; i++)
        x = fmax(x, fabs(b->x[i]));
    for (int j = 0; j < z->s->m; j++)
        lambda = fmax(lambda, fabs(b->lambda[j]));
    for (int i = 0; i < z->s->n; i++)
        worst = fmax(worst, fabs(a->x[i] - b->x[i]) / x);
    for (int j = 0; j < z->s->m; j++)
        worst = fmax(worst, fabs(a->lambda[j] - b->lambda[j]) / lambda);
    return worst;
}

/* --- the way of one trial --- */

typedef struct way {
    double from, to;
    point p[SAMPLES];
} way;

static inline double time_at(const way *w, int i) {
    return i == SAMPLES - 1 ? w->to : w->from + fractions[i] * (w->to - w->from);
}

static inline way look(scene *z, double from, double to) {
    way w = {.from = from, .to = to};
    for (int i = 0; i < SAMPLES; i++)
        w.p[i] = sampled(z, time_at(&w, i));
    return w;
}

/* In any order they are the same but for rounding. */
static inline void any_order(scene *z, const way *w, dice *d) {
    for (int k = 0; k < SAMPLES; k++) {
        const int i = dice_below(d, SAMPLES);
        const point p = sampled(z, time_at(w, i));
        assert_true(apart(z, &p, &w->p[i]) == 0);
    }
}

/* Trials that end there. */
static inline double apart_from_trials(scene *z, const way *w) {
    double worst = 0, reached;
    for (int i = 1; i < SAMPLES; i++) {
        ok(ns_march_try(z->m, time_at(w, i), NS_TO_TIME, &reached));
        const point p = shown(z);
        worst = fmax(worst, reached == time_at(w, i) ? apart(z, &w->p[i], &p) : 0);
    }
    return worst;
}

static inline double shortest_is_sensible(scene *z, const way *w) {
    double until, shortest = ns_march_shortest(z->m, w->from, &until);
    assert_true(shortest > 0 && until > w->from);
    assert_true(ns_march_shortest(z->m, w->to, NULL) > 0);
    return shortest;
}

typedef double closed_form(double t);

typedef struct check {
    int unknown;       /* the closed form is of this one; -1: there is none */
    closed_form *form; /* NULL: there is none */
    double tolerance;  /* relative to 1, or the largest value */
    double as_trial;   /* how far from trials that end there */
    /* what was found */
    double worst, worst_as_trial;
    long trials, events, rights;
} check;

/* Where the same trial, made again, ends: the same but for rounding. */
static inline double check_way(scene *z, check *c, double from, double to, double asked, dice *d) {
    const point end = shown_at_last(z);
    const way w = look(z, from, to);
    double reached;
    any_order(z, &w, d);
    (void)shortest_is_sensible(z, &w);
    const point after = shown(z);
    assert_memory_equal(&end, &after, sizeof end);
    for (int i = 0; i < SAMPLES && c->form; i++)
        c->worst = fmax(c->worst, fabs(w.p[i].x[c->unknown] - c->form(time_at(&w, i))));
    c->worst_as_trial = fmax(c->worst_as_trial, apart_from_trials(z, &w));
    ok(ns_march_try(z->m, asked, NS_TO_STEP, &reached));
    const point again = shown(z);
    assert_true(apart(z, &again, &end) < c->as_trial && fabs(reached - to) <= 1e-15 * to);
    return reached;
}

/* From the point to the end, by trials with NS_TO_STEP. */
static inline void walk(scene *z, check *c, double end) {
    double now, reached;
    dice d = dice_make(1, 1);
    ok(ns_march_read(z->m, &now, NULL, NULL, NULL));
    while (now < end) {
        ok(ns_march_try(z->m, end, NS_TO_STEP, &reached));
        assert_true(reached >= now && reached <= end);
        if (reached > now)
            reached = check_way(z, c, now, reached, end, &d);
        else
            assert_int_equal(ns_march_sample(z->m, now, NULL, NULL), NS_E_STATE);
        c->rights += !(reached > now);
        c->events += ns_march_at_event(z->m);
        ok(ns_march_accept(z->m));
        assert_int_equal(ns_march_sample(z->m, reached, NULL, NULL), NS_E_STATE);
        now = reached;
        assert_true(++c->trials < 1000000);
    }
    if (c->form)
        assert_true(c->worst < c->tolerance);
    assert_true(c->worst_as_trial < c->as_trial);
}

/* Another marcher, of the whole, comes to t: the largest difference of x, lambda (and y, if there is one). */
static inline double apart_from(scene *z, const point *p, const double *y) {
    point q = {0};
    double own_y[PAIRS], reached, worst = 0;
    ok(ns_march_try(z->m, p->t, NS_TO_TIME, &reached));
    ok(ns_march_read(z->m, &q.t, q.x, q.lambda, own_y));
    for (int j = 0; y && j < z->s->m; j++)
        worst = fmax(worst, fabs(y[j] - own_y[j]) / 24);
    return fmax(worst, apart(z, p, &q));
}

/* --- with events --- */

static inline scene one_buck(void) {
    scene z = supplied(dc(24));
    buck(&z, "1", FIRST, 10e-6, 300); /* discontinuous */
    return z;
}

/* 20 V at 1, a switch to 2 while v(4) > v(3), 2.5 ohm from 2 to ground, 100 uH to 3, 10 ohm: from 4.7 us on
 * it slides along v(3) = v(4). */
static inline scene chopper(void) {
    scene z = {0};
    ns_signal reference = sine(2, 1e3);
    reference.u.sin.vo = 7.5;
    ok(ns_circuit_create(&z.c));
    put(&z, "v1", 1, 0, dc(20));
    put(&z, "vr", 4, 0, reference);
    ok(ns_circuit_switch(z.c, "s1", 1, 2, 4, 3, &comparator, NULL));
    ok(ns_circuit_resistor(z.c, "rf", 2, 0, 2.5, NULL));
    ok(ns_circuit_inductor(z.c, "l1", 2, 3, 100e-6, NAN, NULL));
    ok(ns_circuit_resistor(z.c, "r1", 3, 0, 10, NULL));
    return z;
}

/* A peak detector at a sine: the diode's current jumps to and from zero, in one trial it does not. */
static inline scene rectifier(void) {
    scene z = supplied(sine(10, 1e3));
    detector(&z, "1", FIRST);
    return z;
}

/* 1 V steps on at 10 us: into L = 1 mH, R = 1 ohm (1 ms) and, behind another resistor, 1 ns. */
static inline scene two_rates(void) {
    scene z = {0};
    ok(ns_circuit_create(&z.c));
    put(&z, "v", 3, 0, pulse(0, 1, 10e-6, 0, 0, 1, INFINITY));
    ok(ns_circuit_inductor(z.c, "l", 3, 1, 1e-3, 0, NULL));
    ok(ns_circuit_resistor(z.c, "r1", 1, 0, 1, NULL));
    ok(ns_circuit_resistor(z.c, "r2", 3, 2, 1e3, NULL));
    ok(ns_circuit_capacitor(z.c, "c", 2, 0, 1e-12, 0, NULL));
    return z;
}

#endif
