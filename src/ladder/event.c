/* src/ladder/event.c - one event: the new mode, and any jump.
 *
 * A step of negligible length with theta = gamma = 1 solves M (x+ - x-) = h B lambda with the constraints at
 * x+, which is the impulse problem as h -> 0.  After a jump its lambda is an impulse over h; a second such
 * step leaves the algebraic unknowns clean, and tells what jumped (jump.c).
 */
#include "march/march_internal.h"

#include <float.h>
#include <math.h>

/* A hysteresis: far above what a control moves by in the steps of an event. */
static const double band = 1e-3;

static int step_to(ns_march *m, double h) {
    const double t = m->live.t + (m->live.time_lost + h);
    ns_system_inputs(m->s, t, NS_RIGHT, m->z);
    int status = ns_theta_try(m->step, h, m->z, 1, NS_RESOLVE);
    if (status == NS_OK)
        status = ns_theta_accept(m->step);
    if (status == NS_OK)
        ns_march_arrive(m, t, h);
    return status;
}

/* The shorter the step, the worse the condition of the equations; where it spoils the answer, a longer one is
 * negligible still, and a contradiction that impulses hide from a short one shows.  A step that finds one has
 * the say, else the first, and leaves its problem. */
int ns_ladder_short_try(ns_march *m, double h) {
    int status = step_to(m, h);
    double longer = h, says = h;
    if (status == NS_OK || status == NS_E_MEMORY)
        return status == NS_OK ? status : ns_march_fail(m, status);
    for (int k = 0; k < 4; k++) {
        longer *= 16;
        if (m->live.t + longer >= m->limit || longer > m->h)
            continue;
        const int then = step_to(m, longer);
        if (then == NS_OK)
            return NS_OK;
        if (then == NS_E_INFEASIBLE && status != then) {
            status = then;
            says = longer;
        }
    }
    status = step_to(m, says);
    return status == NS_OK ? status : ns_march_fail(m, status);
}

static void count_event(ns_march *m) {
    m->events++;
    if (m->live.crowd == 0 || m->live.t - m->live.crowd_t > m->h) {
        m->live.crowd_t = m->live.t;
        m->live.crowd = 0;
    }
    m->live.crowd++;
}

/* The guard that broke was found by a step of the scheme; an implicit one of the same length may just not see
 * it, or (P1) may find that it held after all.  Longer ones may tell, up to a length at which nothing is
 * skipped: if they do not, the walk goes on, and where such events crowd, it captures. */
static int step_until_changed(ns_march *m, double *h) {
    const long before = ns_theta_counts(m->step)->events;
    const double longest = ldexp(m->h, -NS_SPURIOUS_RUNG);
    int status = ns_ladder_short_try(m, *h);
    while (status == NS_OK && ns_theta_counts(m->step)->events == before && 2 * *h <= longest &&
           m->live.t + 4 * *h < m->limit) {
        *h *= 2;
        status = ns_ladder_short_try(m, *h);
    }
    return status;
}

/* Short steps until one leaves the mode as it is: one that changes it may leave an impulse in lambda. */
int ns_ladder_short_settle(ns_march *m, double h) {
    int status = NS_OK, changed = 1;
    for (int round = 0; round < 4 && changed && status == NS_OK; round++) {
        const long before = ns_theta_counts(m->step)->events;
        ns_reinit_jump_last_step(m);
        status = ns_ladder_short_try(m, h);
        changed = ns_theta_counts(m->step)->events != before;
    }
    return status;
}

/* The length of a probe, on the ladder; 0: there is no room before the next corner. */
static double probe_step(ns_march *m) {
    const double least = ns_ladder_short_step(m), room = ns_march_next_corner(m) - m->live.t;
    double h = ldexp(m->h, -NS_RATE_RUNG);
    while (h > least && !(4 * h < room))
        h /= 2;
    return h > least ? h : 0;
}

/* The lambda of a constraint is known to eps w/h after a short step, and between steps of theta = 1/2 what is
 * wrong with it swings on for ever.  Two implicit steps from here, long for rounding and short for the
 * scheme, tell the rates better, unless something happens in them. */
int ns_ladder_short_rates(ns_march *m) {
    const double h = m->step->carry ? probe_step(m) : 0, t = m->live.t;
    if (!(h > 0))
        return 1;
    for (int k = 0; k < 2; k++) {
        ns_system_inputs(m->s, t + (k + 1) * h, NS_LEFT, m->z);
        if (ns_ladder_switch_by_time(m, m->z, m->due) ||
            ns_theta_probe(m->step, (k + 1) * h, m->z, k) != NS_OK ||
            ns_ladder_switch_by_state(m, m->z, m->crossed))
            return 0;
    }
    ns_theta_take_rates(m->step);
    return 1;
}

/* The length of the steps that resolve an event: two and more of them before anything else happens. */
static double event_step(const ns_march *m) {
    const double h = ns_ladder_short_step(m), room = (m->limit - m->live.t) / 8;
    return room > 64 * DBL_EPSILON * fabs(m->live.t) ? fmin(h, room) : h;
}

static int any(const unsigned char *flip, int count) {
    for (int c = 0; c < count; c++)
        if (flip[c])
            return 1;
    return 0;
}

/* A switch with a hysteresis that went to and fro at this instant (m->crossed: how often) and wants to again
 * has no state to be in, and what came of it would hang on h.  Without a hysteresis it may hold its control
 * at the threshold, which steps average. */
int ns_ladder_event_contradicts(ns_march *m) {
    for (int c = 0; c < m->s->nc; c++) {
        const ns_command *k = &m->s->command[c];
        if (!m->flip[c] || m->crossed[c] < 2 || !(k->on - k->off > band * (fabs(k->on) + fabs(k->off))))
            continue;
        ns_march_fail(m, NS_E_LIMIT);
        m->fault.npairs = 1;
        m->fault.pair[0] = k->pair;
        return 1;
    }
    return 0;
}

int ns_ladder_event_resolve(ns_march *m) {
    double h = event_step(m);
    int status = NS_OK, changed = m->live.jump || any(m->flip, m->s->nc);
    count_event(m);
    m->live.at_event = m->live.jump = 0;
    for (int c = 0; c < m->s->nc; c++)
        m->crossed[c] = 0;
    /* a switch may make another one switch; after twice as many rounds as there are switches time goes on */
    for (int round = 0; round <= 2 * m->s->nc + 1; round++) {
        ns_ladder_switch_apply(m, m->flip);
        for (int c = 0; c < m->s->nc; c++)
            m->crossed[c] = (unsigned char)(m->crossed[c] + (m->flip[c] && m->crossed[c] < 2));
        ns_reinit_jump_begin(m);
        status = changed ? ns_ladder_short_try(m, h) : step_until_changed(m, &h);
        if (status == NS_OK)
            status = ns_ladder_short_settle(m, h);
        if (status == NS_OK)
            status = ns_reinit_jump_commit(m);
        if (status != NS_OK || !(changed = ns_ladder_switch_by_state(m, m->z, m->flip)))
            break;
    }
    if (status == NS_OK && changed && ns_ladder_event_contradicts(m))
        status = NS_E_LIMIT;
    for (int c = 0; c < m->s->nc; c++)
        m->flip[c] = 0;
    if (status == NS_OK)
        (void)ns_ladder_short_rates(m);
    return status;
}
