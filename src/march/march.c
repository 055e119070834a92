/* src/march/march.c - the marcher: made, asked, accepted, read. */
#include "exact/exact_internal.h"
#include "partition.h"
#include "sparse/sparse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int ns_march_fail(ns_march *m, int status) {
    const ns_fault *from = ns_theta_fault(m->step);
    m->fault = *from;
    if (status != (int)from->status)
        m->fault.npairs = m->fault.nunknowns = 0;
    m->fault.status = (ns_status)status;
    m->fault.t = m->live.t;
    return status;
}

int ns_march_create(const ns_system *s, const ns_march_options *o, ns_march **out, ns_fault *fault) {
    if (!out)
        return NS_E_NULL;
    *out = NULL;
    if (!s || !o)
        return NS_E_NULL;
    if (!(o->h > 0) || !isfinite(o->h))
        return NS_E_RANGE;
    ns_march *m = calloc(1, sizeof *m);
    if (!m)
        return NS_E_MEMORY;
    m->s = s;
    m->h = o->h;
    m->options = *o;
    m->back = INFINITY;
    int status = NS_OK;
    if (!o->whole && o->method != NS_THETA)
        status = ns_march_partition_create(s, o, &m->fleet, fault);
    if (status == NS_OK && !m->fleet)
        status = ns_march_make_engines(m, fault);
    if (status != NS_OK) {
        ns_march_free(m);
        return status;
    }
    *out = m;
    return NS_OK;
}

void ns_march_free(ns_march *m) {
    if (!m)
        return;
    ns_march_partition_free(m->fleet);
    ns_sparse_free(m->sparse);
    ns_march_free_dense(m);
    ns_system_free(m->own);
    free(m);
}

static void go_back(ns_march *m) {
    if (m->moved) {
        ns_theta_restore(m->step, m->past);
        m->live = m->kept;
        memcpy(m->flip, m->kept_flip, (size_t)m->s->nc);
        m->corner = -INFINITY;
        if (m->exact)
            ns_exact_drop(m->exact);
    }
    m->moved = m->has_trial = 0;
}

void ns_march_drop(ns_march *m) {
    if (m->fleet)
        ns_march_partition_drop(m->fleet);
    else if (m->sparse)
        ns_sparse_drop(m->sparse);
    else
        go_back(m);
}

double ns_march_next_corner(ns_march *m) {
    if (m->corner <= m->live.t) {
        m->corner = ns_ladder_switch_next_crest(m, m->live.t);
        for (int i = 0; i < m->s->nz; i++)
            m->corner = fmin(m->corner, ns_signal_next_corner(&m->s->z[i], m->live.t));
    }
    return m->corner;
}

/* Arrived at a corner: a jump of an input is an event, and commands may jump with it.  Where an input only
 * turns, currents that are its rate jump, and the rates handed on with them; a mode that ends there too is an
 * event. */
static void look_at_corner(ns_march *m) {
    int jump = 0;
    ns_system_inputs(m->s, m->live.t, NS_LEFT, m->z_left);
    ns_system_inputs(m->s, m->live.t, NS_RIGHT, m->z);
    for (int i = 0; i < m->s->nz; i++)
        jump |= m->z[i] != m->z_left[i];
    if (!jump) {
        m->live.at_event = !ns_ladder_short_rates(m);
        return;
    }
    ns_ladder_switch_by_time(m, m->z, m->flip);
    m->live.at_event = m->live.jump = 1;
}

static int flying(const ns_march *m) {
    return m->exact && !ns_exact_in_fallback(m->exact);
}

static int go_to(ns_march *m, double t, ns_until until) {
    int status = NS_OK;
    m->moved = 1;
    /* bounds the tries: each event takes some 2 x 24 to be located, NS_CROWD of them fit into one h */
    m->budget = 4000 + (long)fmin(1e12, 4000 * (t - m->live.t) / m->h);
    const int from_event = m->live.at_event && until == NS_TO_EVENT;
    while (status == NS_OK && m->live.t < t) {
        if (flying(m)) {
            status = ns_exact_go(m->exact, t, until);
            m->tired = status == NS_OK && ns_march_hands_over(m);
            if (m->tired)
                return NS_E_LIMIT;
            const int there = m->live.at_event || m->live.t == m->kept.t;
            if (until == NS_TO_EVENT && flying(m) && (from_event || there))
                return status;
            continue;
        }
        if (m->live.at_event) {
            m->limit = fmin(t, ns_march_next_corner(m));
            status = ns_ladder_event_resolve(m);
            m->live.since = m->live.t;
            if (from_event)
                return status;
            continue;
        }
        const double corner = ns_march_next_corner(m);
        m->limit = fmin(t, corner);
        const double back = m->exact ? ns_exact_fallback_until(m->exact) : INFINITY;
        status = ns_ladder_walk(m, back > m->live.t ? fmin(m->limit, back) : m->limit);
        if (status == NS_OK && !m->live.at_event && m->live.t == corner)
            look_at_corner(m);
        if (m->live.at_event && until == NS_TO_EVENT) /* right here: on to its right side */
            return m->live.t > m->kept.t ? status : ns_ladder_event_resolve(m);
    }
    return status;
}

/* As ns_march_try(), by dense matrices. */
static int try_densely(ns_march *m, double t, ns_until until, double *reached) {
    if (!m->started)
        return ns_march_fail(m, NS_E_STATE);
    if (!(t > m->kept.t) || !isfinite(t))
        return ns_march_fail(m, NS_E_RANGE);
    const int again = m->has_trial && (t == m->live.t || (t == m->asked && until == m->until));
    if (!again) {
        go_back(m);
        m->step->failed = 0;
        const int status = go_to(m, t, until);
        if (status != NS_OK) {
            go_back(m);
            return status;
        }
        m->has_trial = 1;
        m->asked = t;
        m->until = until;
    }
    *reached = m->live.t;
    return NS_OK;
}

int ns_march_try(ns_march *m, double t, ns_until until, double *reached) {
    if (!m || !reached)
        return NS_E_NULL;
    if (m->fleet)
        return ns_march_partition_try(m->fleet, t, until, reached);
    for (int round = 0;; round++) { /* the last: it tires but once */
        if (!m->sparse)
            ns_march_return_to_sparse(m);
        int status = m->sparse ? ns_sparse_try(m->sparse, t, until, reached) : NS_OK;
        if (m->sparse && !(ns_march_leaves_sparse(m, status) && (status = ns_march_leave_sparse(m)) == NS_OK))
            return status;
        status = try_densely(m, t, until, reached);
        if (status == NS_OK || round > 0 || !m->tired)
            return status;
    }
}

int ns_march_accept(ns_march *m) {
    if (!m)
        return NS_E_NULL;
    if (m->fleet)
        return ns_march_partition_accept(m->fleet);
    if (m->sparse)
        return ns_sparse_accept(m->sparse);
    if (!m->has_trial)
        return NS_E_STATE;
    ns_theta_save(m->step, m->past);
    m->kept = m->live;
    if (m->exact)
        ns_exact_accept(m->exact);
    memcpy(m->kept_flip, m->flip, (size_t)m->s->nc);
    m->moved = m->has_trial = 0;
    return NS_OK;
}

int ns_march_read(ns_march *m, double *t, double *x, double *lambda, double *y) {
    if (!m)
        return NS_E_NULL;
    if (m->fleet)
        return ns_march_partition_read(m->fleet, t, x, lambda, y);
    if (m->sparse)
        return ns_sparse_read(m->sparse, t, x, lambda, y);
    if (!m->started)
        return NS_E_STATE;
    if (t)
        *t = m->live.t;
    const int status = ns_theta_read(m->step, x, lambda, y);
    return status == NS_OK ? NS_OK : ns_march_fail(m, status);
}

const ns_mode *ns_march_mode(const ns_march *m) {
    if (m->fleet)
        return ns_march_partition_mode(m->fleet);
    return m->sparse ? ns_sparse_mode(m->sparse) : ns_theta_mode(m->step);
}

int ns_march_at_event(const ns_march *m) {
    if (m->fleet)
        return ns_march_partition_at_event(m->fleet);
    return m->sparse ? ns_sparse_at_event(m->sparse) : m->live.at_event;
}

ns_method ns_march_engine(const ns_march *m) {
    if (m->fleet)
        return ns_march_partition_engine(m->fleet);
    if (m->sparse)
        return m->options.method == NS_THETA ? NS_THETA : NS_SPARSE;
    return flying(m) ? NS_EXACT : NS_THETA;
}

const ns_counts *ns_march_counts(ns_march *m) {
    if (m->fleet)
        return ns_march_partition_counts(m->fleet);
    if (m->sparse) {
        m->counts = *ns_sparse_counts(m->sparse);
    } else {
        const long jumps = m->counts.jumps, by_steps = m->counts.jumps_by_steps;
        m->counts = *ns_theta_counts(m->step);
        m->counts.events = m->events;
        m->counts.jumps = jumps;
        m->counts.jumps_by_steps = by_steps;
    }
    m->sum = m->counts;
    ns_march_sum_counts(m, &m->sum);
    return &m->sum;
}

int ns_march_problem(const ns_march *m, ns_mlcp *p, double *h) {
    if (!m || !p)
        return NS_E_NULL;
    if (m->fleet)
        return ns_march_partition_problem(m->fleet, p, h);
    if (m->sparse)
        return NS_E_STATE;
    return m->fault.status == ns_theta_fault(m->step)->status ? ns_theta_problem(m->step, p, h) : NS_E_STATE;
}

const ns_fault *ns_march_fault(const ns_march *m) {
    if (m->fleet)
        return ns_march_partition_fault(m->fleet);
    return m->sparse ? ns_sparse_fault(m->sparse) : &m->fault;
}
