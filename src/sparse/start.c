/* src/sparse/start.c - a consistent start of the sparse marcher: from charges and fluxes, or from the
 * DC operating point. */
#include "sparse_internal.h"

#include <math.h>
#include <string.h>

/* Nothing known: every pair at the finite bound nearest to zero, all switches open. */
static void rest(ns_sparse *m) {
    for (int j = 0; j < m->f->m; j++) {
        m->l[j] = m->s->l[j];
        m->u[j] = m->s->u[j];
        m->mode[j] = isfinite(m->l[j]) ? NS_LOWER : isfinite(m->u[j]) ? NS_UPPER : NS_INSIDE;
        m->crowd_t[j] = m->crowd_t[m->f->m + j] = -INFINITY;
    }
    for (int c = 0; c < m->s->nc; c++)
        m->mode[m->s->command[c].pair] = NS_LOWER;
    ns_sparse_guard_bounds(m);
    memset(m->scale, 0, sizeof(double) * 3 * (size_t)m->f->n);
    m->euler_t = m->kept_euler_t = -INFINITY;
    m->eulers = m->kept_eulers = 0;
    m->crowd_moved = 0;
    m->most_lambda = m->most_y = 0;
    memset(m->lambda_of, 0, sizeof m->lambda_of);
    memset(m->y_of, 0, sizeof m->y_of);
    m->started = m->has_trial = m->scheme.running = m->fault.npairs = 0;
    ns_inputs_stages_reset(m->in);
    memset(m->guess, 0, m->guesses * sizeof *m->guess);
    m->alone = 0;
    m->sought = 1;
}

/* From m->w and m->mode. */
static int begin(ns_sparse *m, double t0) {
    ns_sparse_event_own(m, NULL, t0);
    int status = ns_sparse_resolve(m, NULL, t0);
    m->counts.events--; /* a start is none */
    m->kept = m->live = m->leg;
    if (status == NS_OK)
        status = ns_sparse_next_step(m, t0, NULL, m->leg);
    if (m->contradicted >= 0) {
        m->fault.npairs = 1;
        m->fault.pair[0] = m->contradicted;
    }
    if (status != NS_OK)
        return ns_sparse_fail(m, t0, status);
    m->kept_tau = m->live_tau = 0;
    m->kept_t = m->live_t = t0;
    m->started = 1;
    return NS_OK;
}

static int can_start_at(const ns_sparse *m, double t0) {
    return isfinite(t0) && t0 + m->o.h > t0;
}

int ns_sparse_start(ns_sparse *m, double t0, const double *w0) {
    return ns_sparse_start_as(m, t0, w0, NULL);
}

int ns_sparse_start_as(ns_sparse *m, double t0, const double *w0, const unsigned char *closed) {
    if (!m || (!w0 && m->aside->whole->n > 0))
        return NS_E_NULL;
    m->started = m->has_trial = 0;
    if (!can_start_at(m, t0))
        return ns_sparse_fail(m, t0, NS_E_NUMBER);
    for (int i = 0; w0 && i < m->aside->whole->n; i++)
        if (!isfinite(w0[i]))
            return ns_sparse_fail(m, t0, NS_E_NUMBER);
    rest(m);
    for (int c = 0; closed && c < m->s->nc; c++)
        m->mode[m->s->command[c].pair] = closed[c] ? NS_INSIDE : NS_LOWER;
    ns_sparse_guard_bounds(m);
    for (int i = 0; w0 && i < m->f->n; i++)
        m->next_w[i] = w0[m->aside->stays[i]];
    for (int i = 0; i < m->f->n; i++)
        m->w[i] = m->f->algebraic[i] ? 0 : ns_linalg_csc_dot(&m->f->Tt, i, m->next_w);
    return begin(m, t0);
}

/* With the matrices of rest in place of the marcher's own: x and lambda to m->v. */
static int settle_at_rest(ns_sparse *m, double t0, ns_form *f, ns_mode_factors *q) {
    ns_form *const own = m->f;
    ns_mode_factors *const factors = m->q;
    m->f = f;
    m->q = q;
    memset(m->w, 0, sizeof(double) * (size_t)f->n);
    memset(m->changed, 0, (size_t)m->s->nc);
    ns_inputs_stages_at(m->in, t0);
    ns_sparse_event_command(m, t0);
    ns_sparse_guard_bounds(m);
    const int status = ns_sparse_event_consistent_all(m, t0, 0, NULL, m->next_w);
    m->f = own;
    m->q = factors;
    return status;
}

static int operating_point(ns_sparse *m, double t0, int nhold, const int *hold, const double *hold_x) {
    ns_form *f = NULL;
    ns_mode_factors *q = NULL;
    int status = ns_sparse_form_create(m->s, 1, &f);
    for (int k = 0; k < nhold && status == NS_OK; k++)
        if (m->aside->place[hold[k]] >= 0)
            f->held[m->aside->place[hold[k]]] = hold_x[k];
    if (status == NS_OK)
        status = ns_sparse_factors_create(f, m->o.bytes, &q);
    if (status == NS_OK)
        status = settle_at_rest(m, t0, f, q);
    ns_sparse_factors_free(q);
    ns_sparse_form_free(f);
    return status;
}

int ns_sparse_start_dc(ns_sparse *m, double t0, int nhold, const int *hold, const double *hold_x, double *x) {
    if (!m || (nhold > 0 && (!hold || !hold_x)))
        return NS_E_NULL;
    m->started = m->has_trial = 0;
    if (!can_start_at(m, t0))
        return ns_sparse_fail(m, t0, NS_E_NUMBER);
    if (nhold < 0 || nhold > m->aside->whole->n)
        return ns_sparse_fail(m, t0, NS_E_SIZE);
    for (int k = 0; k < nhold; k++)
        if (hold[k] < 0 || hold[k] >= m->aside->whole->n)
            return ns_sparse_fail(m, t0, NS_E_SIZE);
    rest(m);
    const int status = operating_point(m, t0, nhold, hold, hold_x);
    if (status != NS_OK)
        return ns_sparse_fail(m, t0, status);
    for (int i = 0; i < m->f->n; i++)
        m->w[i] = m->f->algebraic[i] ? 0 : ns_linalg_csc_dot(&m->f->Mt, i, m->v);
    ns_system_inputs(m->s, t0, NS_RIGHT, m->z);
    if (x)
        ns_sparse_output_join(m->aside, m->v, m->z, x);
    for (int k = 0; x && k < nhold; k++)
        x[hold[k]] = hold_x[k];
    return begin(m, t0);
}
