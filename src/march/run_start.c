/* src/march/run_start.c - a consistent start: from charges and fluxes, or from the DC operating point. */
#include "exact/exact_internal.h"
#include "partition.h"
#include "sparse/sparse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Switches as in closed (NULL: all open) but those that a function of time changes at t0. */
static int begin(ns_march *m, double t0, const double *w0, const unsigned char *closed) {
    memset(&m->live, 0, sizeof m->live);
    memset(m->closed, 0, (size_t)m->s->nc);
    for (int c = 0; closed && c < m->s->nc; c++)
        m->closed[c] = closed[c];
    m->live.t = t0;
    m->corner = -INFINITY;
    m->limit = INFINITY;
    m->started = m->has_trial = 0;
    const int status = ns_theta_start(m->step, w0, m->closed);
    if (status != NS_OK)
        return ns_march_fail(m, status);
    ns_system_inputs(m->s, t0, NS_RIGHT, m->z);
    ns_ladder_switch_by_time(m, m->z, m->flip);
    for (int c = 0; c < m->s->nc; c++)
        m->closed[c] = (unsigned char)(m->closed[c] != m->flip[c]);
    memset(m->flip, 0, (size_t)m->s->nc);
    memset(m->crossed, 0, (size_t)m->s->nc);
    return NS_OK;
}

/* Commands that the state contradicts, in m->flip, change in m->closed; how many.  m->crossed counts. */
static int toggle(ns_march *m) {
    const int flips = ns_ladder_switch_by_state(m, m->z, m->flip);
    for (int c = 0; c < m->s->nc; c++) {
        m->closed[c] = (unsigned char)(m->closed[c] != m->flip[c]);
        m->crossed[c] = (unsigned char)(m->crossed[c] + (m->flip[c] && m->crossed[c] < 2));
    }
    return flips;
}

static int settle(ns_march *m, double t0, const double *w0) {
    m->live.t = t0;
    m->live.time_lost = 0;
    int status = ns_theta_start(m->step, w0, m->closed);
    if (status != NS_OK)
        return ns_march_fail(m, status);
    status = m->exact ? ns_exact_find_consistent(m->exact) : NS_E_STATE;
    if (status == NS_OK || status == NS_E_MEMORY)
        return status == NS_OK ? status : ns_march_fail(m, status);
    const double h = ns_ladder_short_step(m);
    ns_reinit_jump_begin(m);
    status = ns_ladder_short_try(m, h); /* the jump, */
    if (status == NS_OK)
        status = ns_ladder_short_settle(m, h); /* then clean algebraic unknowns */
    return status == NS_OK ? ns_reinit_jump_commit(m) : status;
}

/* Those that must not be as they are change, from the same w0.  A set of switches that finds no rest
 * chatters: time decides then, unless one with a hysteresis contradicts itself (LIMIT). */
int ns_march_start_as(ns_march *m, double t0, const double *w0, const unsigned char *closed) {
    m->live.t = t0;
    if (!isfinite(t0) || !(t0 + m->h > t0))
        return ns_march_fail(m, NS_E_NUMBER);
    int status = begin(m, t0, w0, closed);
    for (int round = 0; status == NS_OK && round <= 2 * m->s->nc + 1; round++) {
        memset(m->flip, 0, (size_t)m->s->nc);
        status = settle(m, t0, w0);
        if (status == NS_OK && !toggle(m))
            break;
    }
    if (status == NS_OK && ns_ladder_event_contradicts(m))
        status = NS_E_LIMIT;
    memset(m->flip, 0, (size_t)m->s->nc);
    if (status != NS_OK)
        return status;
    (void)ns_ladder_short_rates(m);
    m->started = m->has_trial = 1;
    return ns_march_accept(m);
}

/* Switches that depend on the state start open. */
int ns_march_start(ns_march *m, double t0, const double *w0) {
    if (!m || (!w0 && m->s->n > 0))
        return NS_E_NULL;
    if (m->fleet)
        return ns_march_partition_start(m->fleet, t0, w0);
    int status = m->sparse ? ns_sparse_start(m->sparse, t0, w0) : NS_OK;
    if (m->sparse && !(ns_march_leaves_sparse(m, status) && (status = ns_march_use_dense(m, t0)) == NS_OK))
        return status;
    return ns_march_start_as(m, t0, w0, NULL);
}

static int operating_point(ns_march *m, double t0, int nhold, const int *hold, const double *hold_x,
                           double *x, ns_mode *mode) {
    int status = NS_OK;
    for (int round = 0; round <= 2 * m->s->nc; round++) {
        status = ns_theta_command(m->step, m->closed);
        memcpy(mode, ns_theta_mode(m->step), (size_t)m->s->m);
        ns_system_inputs(m->s, t0, NS_RIGHT, m->z);
        if (status == NS_OK)
            status = ns_theta_lcp_dc(m->step, m->z, nhold, hold, hold_x, mode, x);
        if (status != NS_OK)
            return ns_march_fail(m, status);
        ns_ladder_switch_set(m, x);
        if (!toggle(m))
            break;
    }
    return status;
}

static int start_dc(ns_march *m, double t0, int nhold, const int *hold, const double *hold_x, double *x,
                    double *w0, ns_mode *mode) {
    int status = begin(m, t0, w0, NULL);
    if (status == NS_OK)
        status = operating_point(m, t0, nhold, hold, hold_x, x, mode);
    if (status != NS_OK)
        return status;
    ns_system_charges(m->s, x, w0);
    return ns_march_start(m, t0, w0);
}

int ns_march_start_dc(ns_march *m, double t0, int nhold, const int *hold, const double *hold_x,
                      double *x_out) {
    if (!m || (nhold > 0 && (!hold || !hold_x)))
        return NS_E_NULL;
    if (m->fleet)
        return ns_march_partition_start_dc(m->fleet, t0, nhold, hold, hold_x, x_out);
    int status = m->sparse ? ns_sparse_start_dc(m->sparse, t0, nhold, hold, hold_x, x_out) : NS_OK;
    if (m->sparse && !(ns_march_leaves_sparse(m, status) && (status = ns_march_use_dense(m, t0)) == NS_OK))
        return status;
    m->live.t = t0;
    if (!isfinite(t0))
        return ns_march_fail(m, NS_E_NUMBER);
    if (nhold < 0 || nhold > m->s->n)
        return ns_march_fail(m, NS_E_SIZE);
    for (int k = 0; k < nhold; k++)
        if (hold[k] < 0 || hold[k] >= m->s->n)
            return ns_march_fail(m, NS_E_SIZE);
    const size_t n = (size_t)m->s->n;
    double *x = calloc(2 * n + 1, sizeof *x);
    ns_mode *mode = calloc((size_t)m->s->m + 1, sizeof *mode);
    status = x && mode ? start_dc(m, t0, nhold, hold, hold_x, x, x + n, mode) : ns_march_fail(m, NS_E_MEMORY);
    if (status == NS_OK && x && x_out)
        memcpy(x_out, x, sizeof(double) * n);
    free(x);
    free(mode);
    return status;
}
