/* src/ladder/ladder.c - from one corner to the next, by steps from the ladder.
 *
 * The longest rung that fits is tried.  Where a guard breaks inside it, the next shorter one is, and so
 * on down: each success halves what is left before the break, each failure halves the step.
 */
#include "march/march_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* t is off by some eps t at every step of the same h in the same way, which would add up. */
void ns_march_arrive(ns_march *m, double t, double h) {
    m->live.time_lost += (m->live.t - t) + h;
    m->live.t = t;
}

double ns_ladder_short_step(const ns_march *m) {
    const double finest = 16 * DBL_EPSILON * fabs(m->live.t); /* t must be seen to move */
    double h = ldexp(m->h, -NS_EVENT_RUNG);
    while (h < finest && h < m->h)
        h *= 2;
    return h;
}

typedef struct walker {
    double stop;   /* where to, */
    int commanded; /* because the time-only commands in m->due change there */
    int rung;      /* the one to try next */
    int locating;  /* a break is known to lie within the last rung tried */
} walker;

/* The time from where the steps have come to. */
static double rest_of(const ns_march *m, const walker *w) {
    return w->stop - m->live.t - m->live.time_lost;
}

/* What may be left undone before a stop: what t cannot show, and what no ladder has. */
static double next_to_nothing(const ns_march *m) {
    return fmax(16 * DBL_EPSILON * fabs(m->live.t), ldexp(m->h, -NS_LAST_RUNG));
}

/* The length to try: the longest rung that fits, but such that what is left before the stop is nothing or no
 * sliver; the tail in one step of its own length. */
static double choose(const ns_march *m, walker *w, double rest) {
    const double tail = ldexp(m->h, -NS_TAIL_RUNG);
    if (!w->locating && rest < 1.5 * tail)
        return rest;
    for (;; w->rung++) {
        const double h = ldexp(m->h, -w->rung), left = rest - h;
        if (fabs(left) <= 1e-9 * h) /* a rest that lost some ulps is still a whole rung */
            return h;
        if (left > 0 && (w->locating || left > tail / 2))
            return h;
    }
}

/* Events crowd (accumulation, chatter): no location, (P1) at the end of the step. */
static int capture(ns_march *m, double h, double t) {
    int status = ns_theta_try(m->step, h, m->z, 0, NS_RESOLVE);
    if (status != NS_OK)
        return ns_march_fail(m, status);
    const int flips = ns_ladder_switch_by_state(m, m->z, m->flip);
    status = ns_theta_accept(m->step);
    ns_march_arrive(m, t, h);
    if (flips)
        ns_ladder_switch_apply(m, m->flip);
    memset(m->flip, 0, (size_t)m->s->nc);
    if (t - m->live.crowd_t > m->h)
        m->live.crowd = 0;
    return status;
}

/* Tries the step; accepts it unless a guard breaks or a control crosses: then *broke, and m->flip tells
 * which controls. */
static int step_on(ns_march *m, double h, double t, int *broke) {
    int status = ns_theta_try(m->step, h, m->z, 0, NS_HOLD);
    if (status < 0)
        return ns_march_fail(m, status);
    if (status == NS_GUARD)
        memset(m->crossed, 0, (size_t)m->s->nc);
    *broke = status == NS_GUARD || ns_ladder_switch_by_state(m, m->z, m->crossed) > 0;
    if (*broke) {
        memcpy(m->flip, m->crossed, (size_t)m->s->nc);
        return NS_OK;
    }
    status = ns_theta_accept(m->step);
    ns_march_arrive(m, t, h);
    return status;
}

/* One try.  Sets *done at an event. */
static int advance(ns_march *m, walker *w, int *done) {
    const double rest = rest_of(m, w);
    const int crowded = m->live.crowd > NS_CROWD;
    if (crowded && w->rung < NS_CAPTURE_RUNG)
        w->rung = NS_CAPTURE_RUNG;
    const double h = choose(m, w, rest);
    const double t = h >= rest * (1 - 1e-9) ? w->stop : m->live.t + (m->live.time_lost + h);
    ns_system_inputs(m->s, t, NS_LEFT, m->z);
    if (!w->commanded && m->s->nc > 0 && ns_ladder_switch_by_time(m, m->z, m->due)) {
        w->stop = ns_ladder_switch_instant(m, t, m->due);
        w->commanded = 1;
        w->rung = w->locating = 0;
        return NS_OK;
    }
    if (crowded)
        return capture(m, h, t);
    int broke = 0;
    const int status = step_on(m, h, t, &broke);
    if (status != NS_OK)
        return status;
    w->locating |= broke;
    w->rung += w->locating;
    *done = w->locating && (w->rung > NS_EVENT_RUNG || h <= ns_ladder_short_step(m));
    return NS_OK;
}

int ns_ladder_walk(ns_march *m, double stop) {
    walker w = {stop, 0, 0, 0};
    int done = 0;
    memset(m->flip, 0, (size_t)m->s->nc);
    while (!done && rest_of(m, &w) > next_to_nothing(m)) {
        if (m->budget-- <= 0)
            return ns_march_fail(m, NS_E_LIMIT);
        const int status = advance(m, &w, &done);
        if (status != NS_OK)
            return status;
    }
    if (!done)
        ns_march_arrive(m, fmax(m->live.t, w.stop), 0);
    if (!done && w.commanded)
        memcpy(m->flip, m->due, (size_t)m->s->nc);
    m->live.at_event = done || w.commanded;
    m->live.jump = 0;
    return NS_OK;
}
