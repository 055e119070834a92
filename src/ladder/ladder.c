/* src/ladder/ladder.c - from one corner of the inputs to the next, by steps of h, h/2, h/4, ...
 *
 * The longest step that fits is tried.  Where a guard breaks inside it, the next shorter one is tried, and so
 * on: each success halves the time left before the break, each failure halves the step.
 */
#include "ladder_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

typedef struct location {
    double stop;   /* s: the steps end there, */
    int commanded; /* because the time-only commands in l->due change there */
    int exponent;  /* the next step to try is h 2^-exponent */
    int locating;  /* a guard is known to break within the last step tried */
} location;

static double time_left(const ns_ladder *l, const location *w) {
    return w->stop - l->point->now.t - l->point->now.lost;
}

/* Less than this before a stop is left out: t cannot show it, or it is shorter than any step. */
static double shortest_rest(const ns_ladder *l) {
    return fmax(16 * DBL_EPSILON * fabs(l->point->now.t), ldexp(l->h, -NS_LAST_EXPONENT));
}

/* The length of the step to try: the longest that fits, and leaves before the stop either nothing or enough
 * for another step of the ladder; the tail is one step of its own length. */
static double choose_step(const ns_ladder *l, location *w, double rest) {
    const double tail = ldexp(l->h, -NS_TAIL_EXPONENT);
    if (!w->locating && rest < 1.5 * tail)
        return rest;
    for (;; w->exponent++) {
        const double h = ldexp(l->h, -w->exponent), left = rest - h;
        if (fabs(left) <= 1e-9 * h) /* time that lost some ulps is still a whole step */
            return h;
        if (left > 0 && (w->locating || left > tail / 2))
            return h;
    }
}

/* Where events are many (accumulation, chatter) none is located: (P1) is solved at the end of the step.
 * *done: there switches change, l->point->flip tells which.  Events stay many while some do. */
static int step_capturing(ns_ladder *l, double h, double t, int *done) {
    int status = ns_theta_try(l->step, h, l->z, 0, NS_RESOLVE);
    if (status != NS_OK)
        return status;
    *done = ns_ladder_switch_by_state(l, l->z, l->point->flip) > 0;
    status = ns_theta_accept(l->step);
    ns_clock_advance(&l->point->now, t, h);
    if (*done)
        l->window.from = t;
    else if (t - l->window.from > l->h)
        l->window.events = 0;
    return status;
}

/* Tries the step.  If a guard breaks or a control crosses: *broke, and l->point->flip says which controls;
 * else accepts it. */
static int step_locating(ns_ladder *l, double h, double t, int *broke) {
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
    if (l->any_apart)
        ns_ladder_switch_passed(l);
    status = ns_theta_accept(l->step);
    ns_clock_advance(&l->point->now, t, h);
    return status;
}

/* Tries one step.  *done: the point is the left side of an event. */
static int try_step(ns_ladder *l, location *w, int *done) {
    const double rest = time_left(l, w);
    const int crowding = l->window.events > NS_CROWDING;
    if (crowding && w->exponent < NS_CAPTURE_EXPONENT)
        w->exponent = NS_CAPTURE_EXPONENT;
    const double h = choose_step(l, w, rest);
    const double t = h >= rest * (1 - 1e-9) ? w->stop : l->point->now.t + (l->point->now.lost + h);
    ns_system_inputs(l->s, t, NS_LEFT, l->z);
    ns_ladder_mean_inputs(l, h, t);
    if (crowding)
        return step_capturing(l, h, t, done);
    int broke = 0;
    const int status = step_locating(l, h, t, &broke);
    if (status != NS_OK)
        return status;
    w->locating |= broke;
    w->exponent += w->locating;
    *done = w->locating && (w->exponent > NS_EVENT_EXPONENT || h <= ns_ladder_short_step(l));
    return *done ? ns_ladder_switch_mirrored(l) : NS_OK;
}

int ns_ladder_any_by_state(const ns_ladder *l) {
    int any = 0;
    for (int c = 0; c < l->s->nc; c++)
        any |= l->s->command[c].gx != NULL;
    return any;
}

/* With those of the state that change here change the ones known ahead that do within the shortest step. */
static void flip_known_commands(ns_ladder *l, const location *w) {
    if (!w->commanded || time_left(l, w) > 2 * ns_ladder_short_step(l))
        return;
    for (int c = 0; c < l->s->nc; c++)
        l->point->flip[c] |= l->due[c];
    ns_clock_advance(&l->point->now, fmax(l->point->now.t, w->stop), 0);
}

int ns_ladder_walk(ns_ladder *l, double stop) {
    const double flips = ns_ladder_switch_by_time(l, stop, l->due);
    location w = {fmin(stop, flips), flips < stop, 0, 0};
    int done = 0, enough = 0;
    memset(l->point->flip, 0, (size_t)l->s->nc);
    while (!done && !enough && time_left(l, &w) > shortest_rest(l)) {
        if (l->budget-- <= 0)
            return NS_E_LIMIT;
        const int status = try_step(l, &w, &done);
        if (status != NS_OK)
            return status;
        enough = l->one_step && !w.locating && !done;
    }
    l->point->at_event = l->point->input_jumps = 0;
    if (enough && time_left(l, &w) > shortest_rest(l))
        return NS_OK;
    if (!done)
        ns_clock_advance(&l->point->now, fmax(l->point->now.t, w.stop), 0);
    if (!done && w.commanded)
        memcpy(l->point->flip, l->due, (size_t)l->s->nc);
    else if (done)
        flip_known_commands(l, &w);
    l->point->at_event = done || w.commanded;
    return NS_OK;
}
