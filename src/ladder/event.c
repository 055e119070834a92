/* src/ladder/event.c - one event: the new mode, and any jump.
 *
 * A step of negligible length with theta = gamma = 1 solves M (x+ - x-) = h B lambda with the constraints at
 * x+, which is the impulse problem as h -> 0.  After a jump its lambda is an impulse over h; a second such
 * step leaves the algebraic unknowns clean, and tells what jumped (jump.c).
 */
#include "ladder_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* A band between thresholds wider than this, relative to them, is a hysteresis: far above what a control
 * moves by in the steps of an event. */
static const double band = 1e-3;

double ns_ladder_short_step(const ns_ladder *l) {
    const double finest = 16 * DBL_EPSILON * fabs(l->point->now.t); /* t must be seen to move */
    double h = ldexp(l->h, -NS_EVENT_EXPONENT);
    while (h < finest && h < l->h)
        h *= 2;
    return h;
}

double ns_ladder_next_corner(ns_ladder *l) {
    const double t = l->point->now.t;
    if (l->corner <= t) {
        l->corner = INFINITY;
        for (int i = 0; i < l->s->nz; i++) {
            const double next = ns_signal_next_corner(&l->s->z[i], t);
            l->corner_is_active =
                (next <= l->corner && l->active[i]) || (next >= l->corner && l->corner_is_active);
            l->corner = fmin(l->corner, next);
        }
    }
    return l->corner;
}

int ns_ladder_inputs_jump(ns_ladder *l) {
    int jumps = 0;
    ns_system_inputs(l->s, l->point->now.t, NS_LEFT, l->z_left);
    ns_system_inputs(l->s, l->point->now.t, NS_RIGHT, l->z);
    for (int i = 0; i < l->s->nz; i++)
        jumps |= l->z[i] != l->z_left[i];
    return jumps;
}

void ns_ladder_mean_inputs(ns_ladder *l, double h, double t) {
    if (h > ldexp(l->h, -NS_EDGE_EXPONENT))
        return;
    ns_system_inputs(l->s, l->point->now.t, NS_RIGHT, l->fall);
    for (int k = 0; k < l->s->nz; k++)
        l->fall[k] -= ns_signal_value(&l->s->z[k], t, NS_LEFT);
    l->step->fall = l->fall;
}

/* The integrals of x and lambda over a step of length h count, by their values at its end. */
static void count_step(ns_ladder *l, double h) {
    ns_instant *to = l->point->instant;
    double *x = l->jump.x;
    if (to && ns_theta_read(l->step, x, x + l->s->n, NULL) == NS_OK)
        ns_instant_add(to, 0, to->size, h, x);
}

void ns_ladder_short_begin(ns_ladder *l) {
    const ns_instant *at = l->point->instant;
    if (at)
        memcpy(l->instant, at->sum, sizeof *at->sum * (size_t)at->size);
    ns_reinit_jump_begin(&l->jump, l->step, l->point->now);
}

int ns_ladder_short_commit(ns_ladder *l) {
    ns_instant *to = l->point->instant;
    const long jumps = l->jump.jumps;
    const int status = ns_reinit_jump_commit(&l->jump, l->step, l->h, &l->point->now, l->z);
    if (to && l->jump.jumps > jumps) {
        memcpy(to->sum, l->instant, sizeof *to->sum * (size_t)to->size);
        ns_instant_add(to, 0, l->s->n, 1, l->jump.to.X);
        ns_instant_add(to, l->s->n, l->s->m, 1, l->jump.to.Lambda);
    }
    return status;
}

static int try_implicit_step(ns_ladder *l, double h) {
    const double t = l->point->now.t + (l->point->now.lost + h);
    ns_system_inputs(l->s, t, NS_RIGHT, l->z);
    ns_ladder_mean_inputs(l, h, t);
    int status = ns_theta_try(l->step, h, l->z, 1, NS_RESOLVE);
    if (status == NS_OK)
        status = ns_theta_accept(l->step);
    if (status == NS_OK) {
        ns_clock_advance(&l->point->now, t, h);
        count_step(l, h);
    }
    return status;
}

/* The shorter the step, the worse the condition of the equations.  Where that spoils the answer, steps up to
 * 16^4 times as long, still negligible, are tried; these also show a contradiction that impulses hide from a
 * short one.  If none has an answer, the first that was INFEASIBLE is repeated, else the shortest: its
 * problem is what ns_march_problem() gives. */
int ns_ladder_short_try(ns_ladder *l, double h) {
    int status = try_implicit_step(l, h);
    const double longest = fmin(l->h, l->limit - l->point->now.t);
    double longer = 16 * h, failing = h;
    if (status == NS_OK || status == NS_E_MEMORY)
        return status;
    for (int k = 0; k < 4 && longer < longest; k++, longer *= 16) {
        const int longer_status = try_implicit_step(l, longer);
        if (longer_status == NS_OK)
            return NS_OK;
        if (longer_status == NS_E_INFEASIBLE && status != longer_status) {
            status = longer_status;
            failing = longer;
        }
    }
    status = try_implicit_step(l, failing);
    return status;
}

/* The guard that broke was found by a step of the scheme.  An implicit one of the same length may not break
 * it, or (P1) may find that it held after all.  Longer ones are tried, up to a length at which nothing is
 * skipped, and only until the exact engine is to be asked again, as nothing bounds their error; if none
 * changes the mode, steps go on as before, and where such events are many, they are captured. */
static int step_until_changed(ns_ladder *l, double *h) {
    const long before = ns_theta_counts(l->step)->events;
    const double longest = ldexp(l->h, -NS_SPURIOUS_EXPONENT);
    int status = ns_ladder_short_try(l, *h);
    while (status == NS_OK && ns_theta_counts(l->step)->events == before && 2 * *h <= longest &&
           l->point->now.t + 4 * *h < l->until) {
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

/* The length of the steps that rates are computed from; 0: there is no time for them before the next corner
 * or command. */
static double rate_step(ns_ladder *l) {
    const double t = l->point->now.t, least = ns_ladder_short_step(l);
    double h = ldexp(l->h, -NS_RATE_EXPONENT);
    const double flips = ns_ladder_switch_by_time(l, t + 4 * h, l->due);
    const double room = fmin(ns_ladder_next_corner(l), flips) - t;
    while (h > least && !(4 * h < room))
        h /= 2;
    return h > least ? h : 0;
}

/* After a short step the lambda of a constraint has an error of eps w/h, and steps of theta = 1/2 carry that
 * error on with alternating sign.  Two implicit steps from here, long for rounding and short for the scheme,
 * give better rates, unless a guard breaks or a command changes in them. */
int ns_ladder_short_rates(ns_ladder *l) {
    const double h = l->step->carry ? rate_step(l) : 0, t = l->point->now.t;
    if (!(h > 0))
        return 1;
    for (int k = 0; k < 2; k++) {
        ns_system_inputs(l->s, t + (k + 1) * h, NS_LEFT, l->z);
        if (ns_theta_probe(l->step, (k + 1) * h, l->z, k) != NS_OK ||
            ns_ladder_switch_by_state(l, l->z, l->crossed))
            return 0;
    }
    ns_theta_take_rates(l->step);
    return 1;
}

/* The length of the steps that resolve an event: several of them end before the next event known ahead. */
static double event_step(const ns_ladder *l) {
    const double h = ns_ladder_short_step(l), room = (l->limit - l->point->now.t) / 8;
    return room > 64 * DBL_EPSILON * fabs(l->point->now.t) ? fmin(h, room) : h;
}

/* A switch with hysteresis that changed twice at this instant (l->crossed) and has to again has no consistent
 * state, and the result would depend on h.  Without hysteresis it may hold its control at the threshold,
 * which steps average. */
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

int ns_ladder_short_change(ns_ladder *l, double *h, int changed) {
    *h = *h > 0 ? *h : event_step(l);
    ns_ladder_switch_apply(l, l->point->flip);
    for (int c = 0; c < l->s->nc; c++)
        l->crossed[c] = (unsigned char)(l->crossed[c] + (l->point->flip[c] && l->crossed[c] < 2));
    ns_ladder_short_begin(l);
    int status = changed ? ns_ladder_short_try(l, *h) : step_until_changed(l, h);
    if (status == NS_OK)
        status = ns_ladder_short_settle(l, *h);
    return status == NS_OK ? ns_ladder_short_commit(l) : status;
}
