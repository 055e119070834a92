/* src/sparse/charges.c - charges and fluxes of the point, for an engine that goes on from there.
 *
 * Where x, lambda of a step are straight lines, or those of its end, M x of what is shown at its begin is not
 * w there: a transient of no length for the eye may move a current by a part of itself.
 */
#include "linalg/sparse_lu.h"
#include "sparse_internal.h"

#include <string.h>

/* w (n of what stays): T of it becomes it.  Errors: SINGULAR, MEMORY, NUMBER. */
static int take_rows_apart(const ns_form *f, double *w) {
    ns_klu *klu = NULL;
    ns_factors *factors = NULL;
    ns_csc T;
    int status = ns_linalg_csc_transpose(&f->Tt, &T);
    if (status != NS_OK)
        return status;
    status = ns_linalg_klu_create(f->n, T.start, T.row, &klu);
    if (status == NS_OK)
        status = ns_linalg_klu_factor(klu, T.value, &factors);
    if (status == NS_OK)
        ns_linalg_klu_solve(klu, factors, w);
    ns_linalg_factors_free(klu, factors);
    ns_linalg_klu_free(klu);
    ns_linalg_csc_free(&T);
    return status;
}

int ns_sparse_charges(ns_engine *e, double *w) {
    ns_sparse *m = ns_sparse_of(e);
    const ns_sparse_point *at = &m->trial;
    double *own = m->work.w;
    if (!m->started)
        return NS_E_STATE;
    if (!at->step->is_euler || m->o.theta > 0 || at->tau >= at->step->length)
        return NS_OK;
    ns_sparse_step_state(m, at->step, at->tau, own);
    const int status = take_rows_apart(m->f, own);
    for (int i = 0; i < m->f->n && status == NS_OK; i++)
        w[m->output_only->stays[i]] = own[i];
    return status == NS_E_SINGULAR ? NS_OK : status;
}
