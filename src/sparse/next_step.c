/* src/sparse/next_step.c - the next step from the end of another: of high order, of the scheme, or, where
 * steps end at once, implicit Euler steps, counted. */
#include "sparse_internal.h"

#include <math.h>
#include <string.h>

/* Of how long legs were of late, how much is remembered from one to the next; a step so many times as long is
 * made over to one that is no more than so many times. */
static const double remembers = 0.95, too_long = 16, long_enough = 4;
/* But not below h 2^-this: who changes all the time within the length of a step chatters, and is refused. */
enum { SHORTEST = 3 };

static int euler_leg(ns_sparse *m, ns_dense_step *leg, double t, double limit, double h) {
    const size_t n = (size_t)m->f->n;
    const double rest = limit - t - leg->time_lost, g = fmin(h, rest);
    leg->t = t;
    leg->g = leg->end = g;
    leg->end_t = g < rest ? t + (leg->time_lost + g) : limit;
    leg->why = NS_LEG_GOES_ON;
    leg->pair = leg->command = -1;
    leg->euler = 1;
    leg->stages = 1;
    leg->next_rung = leg->rung;
    memcpy(leg->dw, m->w, sizeof(double) * n);
    const int status = ns_sparse_event_consistent(m, t, g, m->w, leg->xi, NULL);
    for (size_t i = 0; i < n; i++)
        leg->dw[n + i] = m->f->algebraic[i] ? 0 : ns_linalg_csc_dot(&m->f->Mt, (int)i, leg->xi) - m->w[i];
    memcpy(leg->mode, m->mode, (size_t)m->f->m);
    memcpy(leg->z, m->z, sizeof(double) * (size_t)m->f->nz);
    m->counts.steps++;
    return status;
}

/* An Euler step.  Many of them in a short time are chatter: that is refused (LIMIT), naming the pair of the
 * last event. */
static int counted_leg(ns_sparse *m, ns_dense_step *leg, double t, double limit, double h) {
    if (!(t - m->euler_t <= ldexp(m->o.h, -leg->rung))) {
        m->euler_t = t;
        m->eulers = 0;
    }
    m->crowd_moved = 1;
    return ++m->eulers > NS_MOST_EULERS ? NS_E_LIMIT : euler_leg(m, leg, t, limit, h);
}

/* Where events end legs long before their steps do, these are no longer than they need to be: D^i w vanish
 * sooner, and what is left of them tells what jumps. */
static void fit_usual(const ns_sparse *m, const ns_dense_step *before, ns_dense_step *leg) {
    leg->usual = before ? fmax(before->end, remembers * before->usual) : m->o.h;
    if (!before || before->why != NS_LEG_EVENT || !(ldexp(m->o.h, -leg->rung) > too_long * leg->usual))
        return;
    while (leg->rung < SHORTEST + m->o.finer && ldexp(m->o.h, -leg->rung) > long_enough * leg->usual)
        leg->rung++;
}

/* From where legs end at once an Euler step of h 2^-this gets on: the first ones, which may be enough, are
 * far shorter, as what happens within one is first order. */
static int shorter(const ns_sparse *m, double t, double h) {
    enum { LESS = 10, FIRST = 22, BY = 2 };
    const int before = t - m->euler_t <= h ? m->eulers : 0;
    return before * BY < FIRST - LESS ? FIRST - before * BY : LESS;
}

/* A leg from m->w, m->mode at t after one that ended there. */
int ns_sparse_next_step(ns_sparse *m, double t, const ns_dense_step *before, ns_dense_step *leg) {
    const double tiny = before ? ldexp(m->o.h, -before->next_rung - NS_SHORT_RUNG) : 0;
    const int stuck = before && before->why == NS_LEG_EVENT && !(before->end > tiny) ? before->stuck + 1 : 0;
    leg->rung = before ? before->next_rung : 0;
    leg->stuck = stuck;
    leg->time_lost = before ? ns_sparse_step_past(before) : 0;
    fit_usual(m, before, leg);
    ns_inputs_stages_at(m->in, t);
    ns_inputs_stages_find_command(m->in, t, m->o.h, m->mode);
    const double limit = fmax(fmin(m->in->corner, m->in->first), nextafter(t, INFINITY));
    const double h = ldexp(m->o.h, -leg->rung);
    int status;
    if (m->o.theta > 0)
        return ns_sparse_theta_go(m, t, t, leg);
    if (stuck > NS_STUCK)
        status = counted_leg(m, leg, t, limit, ldexp(h, -shorter(m, t, h)));
    else
        status = ns_sparse_step_begin(m, leg, t, limit);
    if (status == NS_OK && leg->why == NS_LEG_GOES_ON && leg->end_t == limit && ns_sparse_event_at(m, limit))
        leg->why = NS_LEG_EVENT;
    return status;
}

/* Where no mode is found in no time, an implicit Euler step that takes a while may: from m->w, m->mode. */
int ns_sparse_capture(ns_sparse *m, double t, const ns_dense_step *before, ns_dense_step *leg) {
    const size_t n = (size_t)m->f->n, pairs = (size_t)m->f->m;
    int status = NS_E_LIMIT;
    memcpy(m->next_w, m->w, sizeof(double) * n);
    memcpy(m->old_mode, m->mode, pairs);
    ns_inputs_stages_at(m->in, t);
    ns_inputs_stages_find_command(m->in, t, m->o.h, m->mode);
    const double limit = fmax(fmin(m->in->corner, m->in->first), nextafter(t, INFINITY));
    for (int less = NS_CAPTURE_FIRST; less >= 2 && status != NS_OK; less -= 4) {
        memcpy(m->w, m->next_w, sizeof(double) * n);
        memcpy(m->mode, m->old_mode, pairs);
        ns_sparse_guard_bounds(m);
        leg->rung = before->next_rung;
        leg->stuck = 0;
        leg->usual = before->usual;
        leg->time_lost = ns_sparse_step_past(before);
        status = counted_leg(m, leg, t, limit, ldexp(m->o.h, -leg->rung - less));
    }
    if (status == NS_OK && leg->end_t == limit && ns_sparse_event_at(m, limit))
        leg->why = NS_LEG_EVENT;
    m->counts.jumps_by_steps++;
    m->budget -= 3000; /* it has no end in sight */
    return status;
}
