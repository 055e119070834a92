/* src/sparse/engine.c - the marcher for large circuits: asked, accepted. */
#include "sparse_internal.h"

#include <math.h>
#include <string.h>

int ns_sparse_fail(ns_sparse *m, double t, int status) {
    m->fault.status = (ns_status)status;
    m->fault.nunknowns = 0;
    if (status != NS_E_INFEASIBLE && status != NS_E_SINGULAR && status != NS_E_LIMIT)
        m->fault.npairs = 0;
    m->fault.t = t;
    return status;
}

/* As far into the live leg as t is. */
static void move_to(ns_sparse *m, double t) {
    const int whole = t >= m->live->end_t || (m->live->euler && !(m->o.theta > 0));
    m->live_tau = whole ? m->live->end : fmin(t - m->live->t - m->live->time_lost, m->live->end);
    m->live_t = whole ? m->live->end_t : t;
}

int ns_sparse_at_event(const ns_sparse *m) {
    return m->started && m->live->why == NS_LEG_EVENT && m->live_t >= m->live->end_t;
}

/* The state at the end of a leg, as what comes next begins from. */
static void leave(ns_sparse *m, const ns_dense_step *leg) {
    ns_sparse_step_state(m, leg, leg->end, m->w);
    memcpy(m->mode, leg->mode, (size_t)m->f->m);
    ns_sparse_guard_bounds(m);
}

static int is_refusal(int status) {
    return status == NS_E_SINGULAR || status == NS_E_LIMIT || status == NS_E_INFEASIBLE ||
           status == NS_E_RESIDUAL;
}

static ns_dense_step *free_leg(ns_sparse *m) {
    ns_dense_step *leg = m->leg;
    while (leg == m->live || leg == m->kept)
        leg++;
    return leg;
}

/* The event at the end of a leg, and the next one. */
static int past_event(ns_sparse *m, double t, const ns_dense_step *from, ns_dense_step *to) {
    ns_sparse_event_own(m, from, t);
    if (ns_sparse_predict_step(m, t, from, to))
        return ns_sparse_event_count(m, from, t);
    int status = ns_sparse_resolve(m, from, t);
    if (status == NS_OK) {
        ns_sparse_predict_learn(m, from);
        status = ns_sparse_event_count(m, from, t);
    }
    if (is_refusal(status)) {
        leave(m, from);
        memcpy(m->mode, m->own_mode, (size_t)m->f->m);
        ns_sparse_guard_bounds(m);
    }
    return status == NS_OK ? ns_sparse_next_step(m, t, from, to) : status;
}

/* The switches that time or the state changed at the end of a leg. */
static void blame_commands(ns_sparse *m, const ns_dense_step *leg) {
    for (int c = 0; c < m->s->nc && m->fault.npairs < NS_FAULT_MAX; c++) {
        const int pair = m->s->command[c].pair;
        if (m->own_mode[pair] != leg->mode[pair])
            m->fault.pair[m->fault.npairs++] = pair;
    }
}

/* Gave up at the end of a leg, for the sake of what changed there. */
static int blame(ns_sparse *m, const ns_dense_step *leg, int status) {
    const int pair = m->contradicted >= 0 ? m->contradicted
                     : leg->pair >= 0     ? leg->pair
                     : leg->command >= 0  ? m->s->command[leg->command].pair
                                          : -1;
    if (status != NS_E_LIMIT)
        return status;
    m->fault.npairs = pair >= 0;
    if (pair >= 0)
        m->fault.pair[0] = pair;
    else if (leg->why == NS_LEG_EVENT)
        blame_commands(m, leg);
    return status;
}

/* From the end of the live leg to the next one. */
static int go_on(ns_sparse *m) {
    ns_dense_step *from = m->live, *to = free_leg(m);
    const double t = from->end_t;
    int status;
    if (m->budget-- <= 0)
        return blame(m, from, NS_E_LIMIT);
    leave(m, from);
    m->contradicted = -1;
    if (from->euler) {
        memcpy(m->z, from->z, sizeof(double) * (size_t)m->f->nz);
        (void)ns_sparse_guard_commands(m, from->xi, NULL, NULL);
    }
    if (m->in->first == -INFINITY) { /* it was gone back to: its instants are known no more */
        ns_inputs_stages_at(m->in, from->t);
        ns_inputs_stages_find_command(m->in, from->t, m->o.h, from->mode);
    }
    status = from->why == NS_LEG_EVENT ? past_event(m, t, from, to) : ns_sparse_next_step(m, t, from, to);
    if (is_refusal(status) && m->contradicted < 0)
        status = ns_sparse_capture(m, t, from, to);
    if (status != NS_OK)
        return blame(m, from, status);
    m->live = to;
    m->live_tau = 0;
    m->live_t = t;
    return NS_OK;
}

/* The same by steps of the scheme. */
static int step_on(ns_sparse *m) {
    ns_dense_step *from = m->live, *to = from == m->kept ? (from == m->leg ? m->leg + 1 : m->leg) : from;
    const double t = from->end_t;
    if (!m->scheme.running || m->scheme.t != t)
        leave(m, from);
    const int status = ns_sparse_theta_go(m, t, m->asked, to);
    if (status != NS_OK)
        return status;
    m->live = to;
    m->live_tau = 0;
    m->live_t = t;
    return NS_OK;
}

/* Through the event here and those that follow it in no time, to the right side of the last. */
static int pass_events(ns_sparse *m) {
    const double t = m->live_t;
    int status = NS_OK;
    do
        status = go_on(m);
    while (status == NS_OK && m->live_t == t && ns_sparse_at_event(m));
    return status;
}

static int go_to(ns_sparse *m, double t, ns_until until) {
    const double from = m->live_t;
    m->budget = 100000 + (long)fmin(1e12, 20000 * (t - from) / m->o.h);
    if (until == NS_TO_EVENT && ns_sparse_at_event(m))
        return pass_events(m);
    while (m->live_t < t) {
        if (m->live_t < m->live->end_t) {
            move_to(m, t);
        } else {
            const int status = m->o.theta > 0 ? step_on(m) : go_on(m);
            if (status != NS_OK)
                return status;
        }
        if (until == NS_TO_EVENT && ns_sparse_at_event(m))
            return m->live_t > from ? NS_OK : pass_events(m);
    }
    return NS_OK;
}

static void go_back(ns_sparse *m) {
    if (m->live != m->kept || m->live_t != m->kept_t) {
        ns_inputs_stages_reset(m->in);
        m->scheme.running = 0;
    }
    m->live = m->kept;
    m->live_tau = m->kept_tau;
    m->live_t = m->kept_t;
    m->has_trial = 0;
    ns_sparse_event_crowd(m, 0);
}

void ns_sparse_drop(ns_sparse *m) {
    go_back(m);
}

int ns_sparse_try(ns_sparse *m, double t, ns_until until, double *reached) {
    if (!m || !reached)
        return NS_E_NULL;
    if (!m->started)
        return ns_sparse_fail(m, t, NS_E_STATE);
    if (!(t > m->kept_t) || !isfinite(t))
        return ns_sparse_fail(m, t, NS_E_RANGE);
    if (!(m->has_trial && (t == m->live_t || (t == m->asked && until == m->until)))) {
        go_back(m);
        m->asked = t;
        m->until = until;
        const int status = go_to(m, t, until);
        if (status != NS_OK) {
            const double at = m->live_t;
            go_back(m);
            return ns_sparse_fail(m, at, status);
        }
        m->has_trial = 1;
    }
    *reached = m->live_t;
    return NS_OK;
}

int ns_sparse_accept(ns_sparse *m) {
    if (!m)
        return NS_E_NULL;
    if (!m->has_trial)
        return NS_E_STATE;
    m->kept = m->live;
    m->kept_tau = m->live_tau;
    m->kept_t = m->live_t;
    m->has_trial = 0;
    ns_sparse_event_crowd(m, 1);
    return NS_OK;
}
