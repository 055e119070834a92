/* src/ladder/ladder.c - from one corner to the next, by steps from the ladder.
 *
 * The longest rung that fits is tried.  Where a guard breaks inside it, the next shorter one is, and so
 * on down: each success halves what is left before the break, each failure halves the step.
 */
#include "ladder_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

typedef struct walker {
    double stop;   /* where to, */
    int commanded; /* because the time-only commands in l->due change there */
    int rung;      /* the one to try next */
    int locating;  /* a break is known to lie within the last rung tried */
} walker;

/* The time from where the steps have come to. */
static double rest_of(const ns_ladder *l, const walker *w) {
    return w->stop - l->point->now.t - l->point->now.lost;
}

/* What may be left undone before a stop: what t cannot show, and what no ladder has. */
static double next_to_nothing(const ns_ladder *l) {
    return fmax(16 * DBL_EPSILON * fabs(l->point->now.t), ldexp(l->h, -NS_LAST_RUNG));
}

/* The length to try: the longest rung that fits, but such that what is left before the stop is nothing or no
 * sliver; the tail in one step of its own length. */
static double choose(const ns_ladder *l, walker *w, double rest) {
    const double tail = ldexp(l->h, -NS_TAIL_RUNG);
    if (!w->locating && rest < 1.5 * tail)
        return rest;
    for (;; w->rung++) {
        const double h = ldexp(l->h, -w->rung), left = rest - h;
        if (fabs(left) <= 1e-9 * h) /* a rest that lost some ulps is still a whole rung */
            return h;
        if (left > 0 && (w->locating || left > tail / 2))
            return h;
    }
}

/* Events crowd (accumulation, chatter): no location, (P1) at the end of the step. */
static int capture(ns_ladder *l, double h, double t) {
    int status = ns_theta_try(l->step, h, l->z, 0, NS_RESOLVE);
    if (status != NS_OK)
        return status;
    const int flips = ns_ladder_switch_by_state(l, l->z, l->point->flip);
    status = ns_theta_accept(l->step);
    ns_clock_advance(&l->point->now, t, h);
    if (flips)
        ns_ladder_switch_apply(l, l->point->flip);
    memset(l->point->flip, 0, (size_t)l->s->nc);
    if (t - l->window.from > l->h)
        l->window.events = 0;
    return status;
}

/* Tries the step; accepts it unless a guard breaks or a control crosses: then *broke, and l->point->flip
 * tells which controls. */
static int step_on(ns_ladder *l, double h, double t, int *broke) {
    int status = ns_theta_try(l->step, h, l->z, 0, NS_HOLD);
    if (status < 0)
        return status;
    if (status == NS_GUARD)
        memset(l->crossed, 0, (size_t)l->s->nc);
    *broke = status == NS_GUARD || ns_ladder_switch_by_state(l, l->z, l->crossed) > 0;
    if (*broke) {
        memcpy(l->point->flip, l->crossed, (size_t)l->s->nc);
        return NS_OK;
    }
    status = ns_theta_accept(l->step);
    ns_clock_advance(&l->point->now, t, h);
    return status;
}

/* One try.  Sets *done at an event. */
static int advance(ns_ladder *l, walker *w, int *done) {
    const double rest = rest_of(l, w);
    const int crowded = l->window.events > NS_CROWD;
    if (crowded && w->rung < NS_CAPTURE_RUNG)
        w->rung = NS_CAPTURE_RUNG;
    const double h = choose(l, w, rest);
    const double t = h >= rest * (1 - 1e-9) ? w->stop : l->point->now.t + (l->point->now.lost + h);
    ns_system_inputs(l->s, t, NS_LEFT, l->z);
    if (!w->commanded && l->s->nc > 0 && ns_ladder_switch_by_time(l, l->z, l->due)) {
        w->stop = ns_ladder_switch_instant(l, t, l->due);
        w->commanded = 1;
        w->rung = w->locating = 0;
        return NS_OK;
    }
    if (crowded)
        return capture(l, h, t);
    int broke = 0;
    const int status = step_on(l, h, t, &broke);
    if (status != NS_OK)
        return status;
    w->locating |= broke;
    w->rung += w->locating;
    *done = w->locating && (w->rung > NS_EVENT_RUNG || h <= ns_ladder_short_step(l));
    return NS_OK;
}

int ns_ladder_walk(ns_ladder *l, double stop) {
    walker w = {stop, 0, 0, 0};
    int done = 0;
    memset(l->point->flip, 0, (size_t)l->s->nc);
    while (!done && rest_of(l, &w) > next_to_nothing(l)) {
        if (l->budget-- <= 0)
            return NS_E_LIMIT;
        const int status = advance(l, &w, &done);
        if (status != NS_OK)
            return status;
    }
    if (!done)
        ns_clock_advance(&l->point->now, fmax(l->point->now.t, w.stop), 0);
    if (!done && w.commanded)
        memcpy(l->point->flip, l->due, (size_t)l->s->nc);
    l->point->at_event = done || w.commanded;
    l->point->input_jumps = 0;
    return NS_OK;
}
