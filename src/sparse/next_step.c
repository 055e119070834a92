/* src/sparse/next_step.c - the step after another one: of high order, of the theta scheme, or, after several
 * steps that ended where they began, an implicit Euler step. */
#include "guards.h"
#include "step.h"

#include <math.h>
#include <string.h>

/* The weight of the past in the usual length of steps; a step too_long times as long as that is shortened to
 * long_enough times. */
static const double remembers = 0.95, too_long = 16, long_enough = 4;
/* But not below h 2^-SHORTEST: chatter is counted within the length of a step. */
enum { SHORTEST = 3 };
/* After so many steps that ended where they began, Euler steps. */
enum { MOST_FAILURES = 6 };
/* One that ends with a wrong sign is made so many times as long, so often. */
enum { LONGER = 3 };
static const double longer = 16;
/* Where a step does not resolve a transient that breaks a guard, the next one is shorter by 2^-this. */
enum { SHORTER = 2 };
/* The first Euler step of a capture is h 2^-this. */
enum { CAPTURE_FIRST = 14, CAPTURE_LAST = 2, CAPTURE_BY = 4 };
/* If no step can be made in the mode after a capture, the next capture is so many times as long: two sources
 * that closed diodes join may differ by less than their rounding after a short one. */
static const double longer_capture = 4;
/* What a capture takes from the steps that are left. */
enum { CAPTURE_COST = 3000 };

/* 1 if a pair that conducts has the wrong sign at v: the rounding of charges, over so short a time. */
static int is_wrong_at(const ns_sparse *m, const double *v) {
    int any = 0;
    for (int j = 0; j < m->f->m; j++)
        any |= m->mode[j] == NS_INSIDE && has_wrong_sign(m, j, v[m->f->n + j]);
    return any;
}

/* v (n+m): the unknowns where the Euler step begins, which differ from those at its end by what the inputs
 * move (m->z: at its end): a ramp of 1e14 V/s, 0.2 V in 2e-15 s.  1: there are other ones, and no sign is
 * wrong. */
static int begin_of_euler(ns_sparse *m, ns_dense_step *step, double *v) {
    const ns_cached_factors *k;
    double *by = step->z + m->f->nz;
    int any = 0;
    for (int i = 0; i < m->f->nz; i++) {
        by[i] = ns_signal_value(&m->s->z[i], step->t, NS_RIGHT) - m->z[i];
        any |= by[i] != 0;
    }
    if (!any || m->f->held || ns_sparse_factors_factor(m->q, step->g, m->mode, 1, &k) != NS_OK)
        return 0;
    ns_sparse_step_rhs(m, step->g, NULL, by, 1, 0);
    if (ns_sparse_factors_solve(m->q, k, m->r, v) != NS_OK)
        return 0;
    for (int i = 0; i < m->f->size; i++)
        v[i] += step->images[i];
    return !is_wrong_at(m, v);
}

/* Of length h, but not so short that charges in that time are rounding. */
static int euler_step(ns_sparse *m, ns_dense_step *step, double t, double limit, double h) {
    const size_t n = (size_t)m->f->n;
    const double room = limit - t - step->time_lost;
    double g = fmin(fmax(h, ns_sparse_finest(m)), room);
    int status = ns_sparse_event_consistent(m, t, g, m->w, step->images, NULL);
    for (int i = 0; i < LONGER && status == NS_OK && g < room && is_wrong_at(m, step->images); i++) {
        g = fmin(longer * g, room);
        status = ns_sparse_event_consistent(m, t, g, m->w, step->images, NULL);
    }
    step->t = t;
    step->g = step->length = g;
    step->end_t = g < room ? t + (step->time_lost + g) : limit;
    step->at_event = 0;
    step->pair = step->command = -1;
    step->is_euler = 1;
    step->stages = step->shown =
        status == NS_OK && begin_of_euler(m, step, step->images + m->f->size) ? 2 : 1;
    step->next_exponent = step->length_exponent;
    memcpy(step->powers, m->w, sizeof(double) * n);
    for (size_t i = 0; i < n; i++)
        step->powers[n + i] =
            m->f->algebraic[i] ? 0 : ns_linalg_csc_dot(&m->f->Mt, (int)i, step->images) - m->w[i];
    memcpy(step->mode, m->mode, (size_t)m->f->m);
    memcpy(step->z, m->z, sizeof(double) * (size_t)m->f->nz);
    m->counts.steps++;
    return status;
}

/* An Euler step, counted: many of them in a short time are chatter. */
static int counted_euler_step(ns_sparse *m, ns_dense_step *step, double t, double limit, double h) {
    const int status = ns_sparse_chatter_euler(m, step, t);
    return status == NS_OK ? euler_step(m, step, t, limit, h) : status;
}

/* Where events end steps long before their full length, steps are shortened: D^i w vanish sooner, and what is
 * left of them tells what jumps. */
static void shorten_to_usual(const ns_sparse *m, const ns_dense_step *before, ns_dense_step *step) {
    step->usual_length = before ? fmax(before->length, remembers * before->usual_length) : m->o.h;
    if (!before || !before->at_event ||
        !(ldexp(m->o.h, -step->length_exponent) > too_long * step->usual_length))
        return;
    while (step->length_exponent < SHORTEST + m->o.finer &&
           ldexp(m->o.h, -step->length_exponent) > long_enough * step->usual_length)
        step->length_exponent++;
}

/* Events in a row, the one at the end of a step the last, after which the mode was the same: Euler steps
 * proved that the guard holds there. */
static int count_unchanged(const ns_sparse *m, const ns_dense_step *before) {
    return before && before->at_event && !before->is_euler &&
                   memcmp(before->mode, m->mode, (size_t)m->f->m) == 0
               ? before->unchanged + 1
               : 0;
}

/* A guard that breaks where it was proved to hold does so in a transient that the step does not resolve: a
 * shorter one shows when.  (The first time it may be below zero there by no more than the error allowed.) */
static void shorten_where_unchanged(const ns_dense_step *before, ns_dense_step *step) {
    if (step->unchanged > 1 && step->failures > 0 &&
        step->length_exponent < before->length_exponent + SHORTER)
        step->length_exponent = before->length_exponent + SHORTER;
}

/* Where steps end where they begin, an Euler step of h 2^-this passes the event.  The first ones, which may
 * be enough, are the shortest: an Euler step is of first order. */
static int euler_exponent(const ns_sparse *m, double t, double h) {
    enum { LAST = 10, FIRST = 22, BY = 2 };
    const ns_event_window *w = &m->chatter.eulers;
    const int before = t - w->from <= h ? w->events : 0;
    return before * BY < FIRST - LAST ? FIRST - before * BY : LAST;
}

double ns_sparse_next_limit(ns_sparse *m, double t) {
    ns_inputs_stages_at(m->in, t);
    ns_inputs_stages_find_command(m->in, t, m->o.h, m->mode);
    return fmax(fmin(m->in->corner, m->in->first), nextafter(t, INFINITY));
}

int ns_sparse_next_step(ns_sparse *m, double t, const ns_dense_step *before, ns_dense_step *step) {
    const double tiny = before ? ldexp(m->o.h, -before->next_exponent - NS_SHORT_EXPONENT) : 0;
    step->length_exponent = before ? before->next_exponent : 0;
    step->failures = before && before->at_event && !(before->length > tiny) ? before->failures + 1 : 0;
    step->time_lost = before ? ns_sparse_step_time_lost(before) : 0;
    step->after_event = before && before->at_event;
    step->unchanged = count_unchanged(m, before);
    shorten_to_usual(m, before, step);
    shorten_where_unchanged(before, step);
    const double limit = ns_sparse_next_limit(m, t), h = ldexp(m->o.h, -step->length_exponent);
    int status;
    ns_inputs_stages_late(m->in, step->time_lost);
    if (m->o.theta > 0)
        return ns_sparse_theta_go(m, t, t, step);
    if (step->failures > MOST_FAILURES)
        status = counted_euler_step(m, step, t, limit, ldexp(h, -euler_exponent(m, t, h)));
    else
        status = ns_sparse_control_step(m, step, t, limit);
    if (status == NS_OK && !step->at_event && step->end_t == limit && ns_sparse_event_at(m, limit))
        step->at_event = 1;
    return status;
}

int ns_sparse_next_captured(ns_sparse *m, double t, const ns_dense_step *before, ns_dense_step *step) {
    const double limit = ns_sparse_next_limit(m, t);
    const int again = before->is_euler && memcmp(before->mode, m->mode, (size_t)m->f->m) == 0;
    const double least = again ? fmin(longer_capture * before->length, ldexp(m->o.h, -CAPTURE_LAST)) : 0;
    int status = NS_E_LIMIT;
    ns_sparse_event_save(m);
    for (int less = CAPTURE_FIRST; less >= CAPTURE_LAST && status != NS_OK; less -= CAPTURE_BY) {
        ns_sparse_event_restore(m);
        step->length_exponent = before->next_exponent;
        step->failures = step->after_event = step->unchanged = 0;
        step->usual_length = before->usual_length;
        step->time_lost = ns_sparse_step_time_lost(before);
        const double length = ldexp(m->o.h, -step->length_exponent - less);
        status = counted_euler_step(m, step, t, limit, fmax(length, least));
    }
    if (status == NS_OK && step->end_t == limit && ns_sparse_event_at(m, limit))
        step->at_event = 1;
    m->counts.jumps_by_steps++;
    m->steps_left -= CAPTURE_COST;
    return status;
}
