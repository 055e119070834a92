/* src/march/run_scheme.c - the theta scheme in place of a kernel, for a whole trial: nobody judges how the
 * errors of its steps add up, so it is believed where shorter steps come to the same.
 */
#include "run_internal.h"

#include <math.h>
#include <stdlib.h>

/* Charges and fluxes of an engine's point: w (n); x: n. */
static int read_charges(const ns_run *r, ns_engine *e, double *x, double *w) {
    const int status = ns_engine_read(e, NULL, x, NULL, NULL);
    ns_system_charges(r->s, x, w);
    return status;
}

double ns_march_run_finer_step(const ns_run *r, double length) {
    return fmin(ns_march_run_scheme_step(r), length) / 4;
}

/* The same by shorter steps. */
static int read_finer(ns_run *r, const ns_run_start *from, double end, double *x, double *w) {
    const double step = r->scheme_step;
    ns_engine *e = NULL;
    double reached;
    r->scheme_step = ns_march_run_finer_step(r, end - from->t);
    int status = ns_march_run_make(r, NS_RUN_SCHEME, &e);
    r->scheme_step = step;
    if (status != NS_OK)
        return status;
    status = e->table->start(e, from->t, from->w, from->closed);
    if (status == NS_OK)
        status = e->table->try_to(e, end, NS_TO_TIME, &reached);
    if (status == NS_OK)
        status = read_charges(r, e, x, w);
    e->table->free(e);
    return status;
}

int ns_march_run_is_believed(ns_run *r, const ns_run_start *from, double end) {
    static const double same = 7e-4; /* of first order: its error is a third more */
    const int n = r->s->n;
    if (!(end > from->t))
        return 1;
    double *x = calloc(3 * (size_t)n + 1, sizeof *x), *w = x ? x + n : NULL, *finer = x ? w + n : NULL,
           most = INFINITY;
    if (x && read_charges(r, r->at_work, x, w) == NS_OK && read_finer(r, from, end, x, finer) == NS_OK) {
        most = 0;
        for (int i = 0; i < n; i++)
            most = fmax(most, fabs(w[i] - finer[i]) / ns_verify_most_charge(r->check.verify, i));
    }
    free(x);
    return most <= same;
}
