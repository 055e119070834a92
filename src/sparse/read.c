/* src/sparse/read.c - the point of the trial, its mode, and the counts. */
#include "sparse_internal.h"
#include "theta/name_fault.h"

#include <math.h>
#include <string.h>

/* Unknowns may overflow before the state does: they are named, and read all the same. */
static int check_read(ns_sparse *m, double at, const double *x, const double *lambda, const double *y) {
    ns_fault found = {.status = NS_E_OVERFLOW, .t = at};
    found.nunknowns = ns_theta_name_infinite(m->output_only->whole->n, x, found.unknown);
    found.npairs = ns_theta_name_infinite(m->f->m, lambda, found.pair);
    if (found.nunknowns + found.npairs == 0)
        found.npairs = ns_theta_name_infinite(m->f->m, y, found.pair);
    if (found.nunknowns + found.npairs == 0)
        return NS_OK;
    m->fault = found;
    return NS_E_OVERFLOW;
}

int ns_sparse_read(ns_sparse *m, double *t, double *x, double *lambda, double *y) {
    if (!m)
        return NS_E_NULL;
    if (!m->started)
        return ns_sparse_fail(m, NAN, NS_E_STATE);
    const double at = m->trial.t;
    const int more =
        m->trial.t < m->trial.step->end_t || m->trial.step->at_event || m->trial.step->stages < NS_ORDER;
    int status = more ? ns_sparse_step_more(m, m->trial.step) : NS_OK;
    if (status != NS_OK)
        return ns_sparse_fail(m, at, status);
    if (m->o.theta > 0)
        status = ns_sparse_theta_point(m, m->trial.step, m->trial.tau, m->v);
    else
        ns_sparse_step_point(m, m->trial.step, m->trial.tau, m->v);
    if (status != NS_OK)
        return ns_sparse_fail(m, at, status);
    if (t)
        *t = at;
    for (int k = 0; k < m->f->nz; k++)
        m->z[k] = ns_signal_value(&m->s->z[k], at, m->trial.t > m->trial.step->t ? NS_LEFT : NS_RIGHT);
    if (x)
        ns_sparse_output_join(m->output_only, m->v, m->z, x);
    if (lambda)
        memcpy(lambda, m->v + m->f->n, sizeof(double) * (size_t)m->f->m);
    for (int j = 0; y && j < m->f->m; j++)
        y[j] = m->trial.step->mode[j] == NS_INSIDE ? 0 : ns_sparse_form_y(m->f, j, m->v, m->z, 1);
    return check_read(m, at, x, lambda, y);
}

const ns_mode *ns_sparse_mode(const ns_sparse *m) {
    const ns_mode *mode = m->trial.step ? m->trial.step->mode : m->mode;
    for (int j = 0; j < m->f->m; j++)
        m->shown_mode[j] = ns_mode_slides(mode[j]) ? NS_INSIDE : mode[j];
    return m->shown_mode;
}

const ns_counts *ns_sparse_counts(ns_sparse *m) {
    m->counts.factors = ns_linalg_klu_fresh(m->q->klu) + ns_linalg_klu_refactor(m->q->klu);
    m->counts.maps = m->q->made;
    m->counts.evicted = m->q->evicted;
    return &m->counts;
}

const ns_fault *ns_sparse_fault(const ns_sparse *m) {
    return &m->fault;
}
