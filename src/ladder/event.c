/* src/ladder/event.c - one event: the new mode, and any jump.
 *
 * A step of negligible length with theta = gamma = 1 solves M (x+ - x-) = h B lambda with the constraints at
 * x+, which is the impulse problem as h -> 0.  After a jump its lambda is an impulse over h; a second such
 * step leaves the algebraic unknowns clean, and tells what jumped (jump.c).
 */
#include "ladder_internal.h"

#include <float.h>
#include <math.h>

/* A hysteresis: far above what a control moves by in the steps of an event. */
static const double band = 1e-3;

double ns_ladder_short_step(const ns_ladder *l) {
    const double finest = 16 * DBL_EPSILON * fabs(l->point->now.t); /* t must be seen to move */
    double h = ldexp(l->h, -NS_EVENT_RUNG);
    while (h < finest && h < l->h)
        h *= 2;
    return h;
}

double ns_ladder_next_corner(ns_ladder *l) {
    const double t = l->point->now.t;
    if (l->corner <= t) {
        l->corner = ns_ladder_switch_next_crest(l, t);
        for (int i = 0; i < l->s->nz; i++)
            l->corner = fmin(l->corner, ns_signal_next_corner(&l->s->z[i], t));
    }
    return l->corner;
}

static int step_to(ns_ladder *l, double h) {
    const double t = l->point->now.t + (l->point->now.lost + h);
    ns_system_inputs(l->s, t, NS_RIGHT, l->z);
    int status = ns_theta_try(l->step, h, l->z, 1, NS_RESOLVE);
    if (status == NS_OK)
        status = ns_theta_accept(l->step);
    if (status == NS_OK)
        ns_clock_advance(&l->point->now, t, h);
    return status;
}

/* The shorter the step, the worse the condition of the equations; where it spoils the answer, a longer one is
 * negligible still, and a contradiction that impulses hide from a short one shows.  A step that finds one has
 * the say, else the first, and leaves its problem. */
int ns_ladder_short_try(ns_ladder *l, double h) {
    int status = step_to(l, h);
    double longer = h, says = h;
    if (status == NS_OK || status == NS_E_MEMORY)
        return status;
    for (int k = 0; k < 4; k++) {
        longer *= 16;
        if (l->point->now.t + longer >= l->limit || longer > l->h)
            continue;
        const int then = step_to(l, longer);
        if (then == NS_OK)
            return NS_OK;
        if (then == NS_E_INFEASIBLE && status != then) {
            status = then;
            says = longer;
        }
    }
    status = step_to(l, says);
    return status;
}

static void count_event(ns_ladder *l) {
    l->events++;
    if (l->window.events == 0 || l->point->now.t - l->window.from > l->h) {
        l->window.from = l->point->now.t;
        l->window.events = 0;
    }
    l->window.events++;
}

/* The guard that broke was found by a step of the scheme; an implicit one of the same length may just not see
 * it, or (P1) may find that it held after all.  Longer ones may tell, up to a length at which nothing is
 * skipped: if they do not, the walk goes on, and where such events crowd, it captures. */
static int step_until_changed(ns_ladder *l, double *h) {
    const long before = ns_theta_counts(l->step)->events;
    const double longest = ldexp(l->h, -NS_SPURIOUS_RUNG);
    int status = ns_ladder_short_try(l, *h);
    while (status == NS_OK && ns_theta_counts(l->step)->events == before && 2 * *h <= longest &&
           l->point->now.t + 4 * *h < l->limit) {
        *h *= 2;
        status = ns_ladder_short_try(l, *h);
    }
    return status;
}

/* Short steps until one leaves the mode as it is: one that changes it may leave an impulse in lambda. */
int ns_ladder_short_settle(ns_ladder *l, double h) {
    int status = NS_OK, changed = 1;
    for (int round = 0; round < 4 && changed && status == NS_OK; round++) {
        const long before = ns_theta_counts(l->step)->events;
        ns_reinit_jump_last_step(&l->jump, l->step, l->point->now.t);
        status = ns_ladder_short_try(l, h);
        changed = ns_theta_counts(l->step)->events != before;
    }
    return status;
}

/* The length of a probe, on the ladder; 0: there is no room before the next corner. */
static double probe_step(ns_ladder *l) {
    const double least = ns_ladder_short_step(l), room = ns_ladder_next_corner(l) - l->point->now.t;
    double h = ldexp(l->h, -NS_RATE_RUNG);
    while (h > least && !(4 * h < room))
        h /= 2;
    return h > least ? h : 0;
}

/* The lambda of a constraint is known to eps w/h after a short step, and between steps of theta = 1/2 what is
 * wrong with it swings on for ever.  Two implicit steps from here, long for rounding and short for the
 * scheme, tell the rates better, unless something happens in them. */
int ns_ladder_short_rates(ns_ladder *l) {
    const double h = l->step->carry ? probe_step(l) : 0, t = l->point->now.t;
    if (!(h > 0))
        return 1;
    for (int k = 0; k < 2; k++) {
        ns_system_inputs(l->s, t + (k + 1) * h, NS_LEFT, l->z);
        if (ns_ladder_switch_by_time(l, l->z, l->due) ||
            ns_theta_probe(l->step, (k + 1) * h, l->z, k) != NS_OK ||
            ns_ladder_switch_by_state(l, l->z, l->crossed))
            return 0;
    }
    ns_theta_take_rates(l->step);
    return 1;
}

/* The length of the steps that resolve an event: two and more of them before anything else happens. */
static double event_step(const ns_ladder *l) {
    const double h = ns_ladder_short_step(l), room = (l->limit - l->point->now.t) / 8;
    return room > 64 * DBL_EPSILON * fabs(l->point->now.t) ? fmin(h, room) : h;
}

static int any(const unsigned char *flip, int count) {
    for (int c = 0; c < count; c++)
        if (flip[c])
            return 1;
    return 0;
}

/* A switch with a hysteresis that went to and fro at this instant (l->crossed: how often) and wants to again
 * has no state to be in, and what came of it would hang on h.  Without a hysteresis it may hold its control
 * at the threshold, which steps average. */
int ns_ladder_event_contradicts(ns_ladder *l) {
    for (int c = 0; c < l->s->nc; c++) {
        const ns_command *k = &l->s->command[c];
        if (!l->point->flip[c] || l->crossed[c] < 2 ||
            !(k->on - k->off > band * (fabs(k->on) + fabs(k->off))))
            continue;
        l->contradiction = k->pair;
        return 1;
    }
    return 0;
}

int ns_ladder_event_resolve(ns_ladder *l) {
    double h = event_step(l);
    int status = NS_OK, changed = l->point->input_jumps || any(l->point->flip, l->s->nc);
    count_event(l);
    l->point->at_event = l->point->input_jumps = 0;
    for (int c = 0; c < l->s->nc; c++)
        l->crossed[c] = 0;
    /* a switch may make another one switch; after twice as many rounds as there are switches time goes on */
    for (int round = 0; round <= 2 * l->s->nc + 1; round++) {
        ns_ladder_switch_apply(l, l->point->flip);
        for (int c = 0; c < l->s->nc; c++)
            l->crossed[c] = (unsigned char)(l->crossed[c] + (l->point->flip[c] && l->crossed[c] < 2));
        ns_reinit_jump_begin(&l->jump, l->step, l->point->now);
        status = changed ? ns_ladder_short_try(l, h) : step_until_changed(l, &h);
        if (status == NS_OK)
            status = ns_ladder_short_settle(l, h);
        if (status == NS_OK)
            status = ns_reinit_jump_commit(&l->jump, l->step, l->h, &l->point->now, l->z);
        if (status != NS_OK || !(changed = ns_ladder_switch_by_state(l, l->z, l->point->flip)))
            break;
    }
    if (status == NS_OK && changed && ns_ladder_event_contradicts(l))
        status = NS_E_LIMIT;
    for (int c = 0; c < l->s->nc; c++)
        l->point->flip[c] = 0;
    if (status == NS_OK)
        (void)ns_ladder_short_rates(l);
    return status;
}
