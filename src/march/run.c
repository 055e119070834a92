/* src/march/run.c - one system: the engine at work is asked, and leaves to another one what it cannot do.
 *
 * What the sparse engine refuses the dense ones go on with, for a while; what costs the dense engines too
 * much the sparse one goes on with.
 */
#include "run_internal.h"

#include <math.h>
#include <stdlib.h>

static ns_run *run_of(ns_engine *e) {
    return (ns_run *)(void *)e;
}

static int leaves_sparse(const ns_run *r, int status) {
    return !r->is_dense && ns_march_leaves_sparse(r->s, &r->options, status);
}

static int start(ns_engine *e, double t0, const double *w0, const unsigned char *closed) {
    ns_run *r = run_of(e);
    int status = r->at_work->table->start(r->at_work, t0, w0, closed);
    if (leaves_sparse(r, status) && (status = ns_march_run_use_dense(r, t0)) == NS_OK)
        status = r->at_work->table->start(r->at_work, t0, w0, closed);
    return status;
}

static int start_dc(ns_engine *e, double t0, int nhold, const int *hold, const double *hold_x, double *x) {
    ns_run *r = run_of(e);
    int status = r->at_work->table->start_dc(r->at_work, t0, nhold, hold, hold_x, x);
    if (leaves_sparse(r, status) && (status = ns_march_run_use_dense(r, t0)) == NS_OK)
        status = r->at_work->table->start_dc(r->at_work, t0, nhold, hold, hold_x, x);
    return status;
}

/* At most two rounds: the dense engines hand over once. */
static int try_to(ns_engine *e, double t, ns_until until, double *reached) {
    ns_run *r = run_of(e);
    for (int round = 0;; round++) {
        if (r->is_dense)
            ns_march_run_try_sparse(r, round > 0);
        int status = r->at_work->table->try_to(r->at_work, t, until, reached);
        if (leaves_sparse(r, status) && (status = ns_march_run_leave_sparse(r)) == NS_OK)
            status = r->at_work->table->try_to(r->at_work, t, until, reached);
        if (status == NS_OK || !r->is_dense || round > 0 || !ns_march_dense_hands_over(r->at_work))
            return status;
    }
}

static const ns_counts *counts(ns_engine *e) {
    ns_run *r = run_of(e);
    r->sum = *r->at_work->table->counts(r->at_work);
    ns_march_add_counts(&r->sum, &r->before);
    return &r->sum;
}

static ns_engine *at_work(const ns_engine *e) {
    return ((const ns_run *)(const void *)e)->at_work;
}

static void free_run(ns_engine *e) {
    ns_run *r = run_of(e);
    if (!r)
        return;
    if (r->at_work)
        r->at_work->table->free(r->at_work);
    ns_system_free(r->dense_copy);
    free(r);
}

static const ns_engine_table table = {
    .free = free_run,
    .start = start,
    .start_dc = start_dc,
    .try_to = try_to,
    .counts = counts,
    .at_work = at_work,
};

int ns_march_run_create(const ns_system *s, const ns_march_options *o, ns_engine **out, ns_fault *fault) {
    ns_run *r = calloc(1, sizeof *r);
    *out = NULL;
    if (!r)
        return NS_E_MEMORY;
    r->engine.table = &table;
    r->s = s;
    r->options = *o;
    r->retry_sparse_at = INFINITY;
    r->counts_modes = ns_march_counts_modes(s);
    const int status = ns_march_run_make_engine(r, fault);
    if (status != NS_OK) {
        free_run(&r->engine);
        return status;
    }
    *out = &r->engine;
    return NS_OK;
}
