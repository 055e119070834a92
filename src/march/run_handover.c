/* src/march/run_handover.c - engines of a run: made, and replaced by one another from the accepted point on.
 */
#include "run_internal.h"
#include "system/dense_copy.h"

#include <math.h>
#include <stdlib.h>

/* Systems that are large are written out first. */
static int make_dense(ns_run *r, ns_engine **out, ns_fault *fault) {
    int status = ns_march_too_large(r->s) ? NS_E_SIZE : NS_OK;
    *out = NULL;
    if (status == NS_OK && r->s->large)
        status = ns_system_check(r->s, fault);
    if (status == NS_OK && r->s->large)
        status = ns_system_dense_copy(r->s, &r->dense_copy);
    if (r->dense_copy)
        r->s = r->dense_copy;
    return status == NS_OK ? ns_march_dense_create(r->s, &r->options, out, fault) : status;
}

static void replace_engine(ns_run *r, ns_engine *by, int is_dense) {
    r->before = *r->engine.table->counts(&r->engine);
    r->seen = (ns_recurrence){0};
    r->at_work->table->free(r->at_work);
    r->at_work = by;
    r->is_dense = is_dense;
}

/* The sparse engine is not asked again for a while from t on. */
static void put_off_sparse(ns_run *r, double t) {
    r->retry_interval = ns_march_retry_interval(&r->options, r->retry_interval);
    r->retry_sparse_at = t + r->retry_interval;
    if (r->is_dense)
        ns_march_dense_let_hand_over(r->at_work, 0);
}

int ns_march_run_use_dense(ns_run *r, double t) {
    ns_engine *dense;
    const int status = make_dense(r, &dense, &r->fault);
    if (status != NS_OK)
        return status;
    replace_engine(r, dense, 1);
    put_off_sparse(r, t);
    return NS_OK;
}

/* The accepted point, as charges and fluxes w (n) and commanded switches that are closed (nc).  The caller
 * frees both, also after an error. */
static int read_accepted(ns_run *r, double *t, double **w, unsigned char **closed) {
    const size_t n = (size_t)r->s->n;
    ns_engine *e = r->at_work;
    double *x = calloc(2 * n + 1, sizeof *x);
    *closed = calloc((size_t)r->s->nc + 1, 1);
    *w = x;
    const int status = x && *closed ? ns_engine_read(e, t, x + n, NULL, NULL) : NS_E_MEMORY;
    for (int c = 0; *closed && c < r->s->nc; c++)
        (*closed)[c] = ns_engine_mode(e)[r->s->command[c].pair] == NS_INSIDE;
    if (status == NS_OK)
        ns_system_charges(r->s, x + n, x);
    return status;
}

int ns_march_run_leave_sparse(ns_run *r) {
    double t, *w;
    unsigned char *closed;
    int status = read_accepted(r, &t, &w, &closed);
    if (status == NS_OK)
        status = ns_march_run_use_dense(r, t);
    if (status == NS_OK)
        status = r->at_work->table->start(r->at_work, t, w, closed);
    if (status == NS_OK)
        ns_march_dense_carry_start(r->at_work);
    free(closed);
    free(w);
    return status;
}

/* To the sparse engine, which may refuse. */
static int leave_dense(ns_run *r) {
    const ns_sparse_options options = ns_march_sparse_options(&r->options);
    double t, *w;
    unsigned char *closed;
    ns_engine *sparse = NULL;
    int status = read_accepted(r, &t, &w, &closed);
    if (status == NS_OK)
        status = ns_sparse_table_create(r->s, &options, &sparse, NULL);
    if (status == NS_OK)
        status = sparse->table->start(sparse, t, w, closed);
    free(closed);
    free(w);
    if (status == NS_OK)
        replace_engine(r, sparse, 0);
    else if (sparse)
        sparse->table->free(sparse);
    return status;
}

static int modes_do_not_recur(ns_run *r) {
    const ns_recurrence now = ns_march_dense_recurrence(r->at_work);
    return r->counts_modes && ns_march_modes_do_not_recur(&now, &r->seen);
}

void ns_march_run_try_sparse(ns_run *r, int dense_failed) {
    ns_engine *e = r->at_work;
    const int may_be_due = r->retry_sparse_at < INFINITY;
    double t;
    if (r->options.method != NS_AUTO || !(may_be_due || dense_failed || r->counts_modes) ||
        !ns_march_dense_rests(e, &t))
        return;
    const int first = r->retry_interval == 0 && ns_march_dense_is_exact(e);
    if (t < r->retry_sparse_at && !(first && (dense_failed || modes_do_not_recur(r))))
        return;
    if (leave_dense(r) != NS_OK)
        put_off_sparse(r, t);
}

int ns_march_run_make_engine(ns_run *r, ns_fault *fault) {
    ns_sparse_options options;
    if (ns_march_begins_sparse(r->s, &r->options, &options))
        return ns_sparse_table_create(r->s, &options, &r->at_work, fault);
    const int status = make_dense(r, &r->at_work, fault);
    r->is_dense = 1;
    if (status == NS_OK)
        ns_march_dense_let_hand_over(r->at_work, r->options.method == NS_AUTO);
    return status;
}
