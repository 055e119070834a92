/* src/march/run_handover.c - engines of a run: made, and replaced by one another from the accepted point on.
 */
#include "run_internal.h"
#include "system/dense_copy.h"

#include <math.h>
#include <stdlib.h>

/* Systems that are large are written out first. */
static int make_dense(ns_run *r, const ns_march_options *o, ns_engine **out, ns_fault *fault) {
    int status = ns_march_too_large(r->s) ? NS_E_SIZE : NS_OK;
    *out = NULL;
    if (status == NS_OK && r->s->large)
        status = ns_system_check(r->s, fault);
    if (status == NS_OK && r->s->large)
        status = ns_system_dense_copy(r->s, &r->dense_copy);
    if (r->dense_copy)
        r->s = r->dense_copy;
    return status == NS_OK ? ns_march_dense_create(r->s, o, out, fault) : status;
}

int ns_march_run_sparse_failed(const ns_run *r, int status) {
    return !r->is_dense && ns_march_leaves_sparse(r->s, &r->options, status);
}

/* Of the scheme that was asked for, or in place of another engine with shorter steps. */
static ns_march_options scheme_options(const ns_run *r) {
    enum { SMALLER_EXPONENT = -4 };
    ns_march_options o = r->options;
    if (o.method == NS_THETA)
        return o;
    o.method = NS_THETA;
    o.theta = o.gamma = 1; /* they may not be given for other methods */
    o.capture = 0;
    o.h = ldexp(o.h, SMALLER_EXPONENT);
    return o;
}

/* By dense matrices, or if that is asked for or there are too many unknowns by sparse factors. */
static int scheme_is_dense(const ns_run *r) {
    const ns_march_options o = scheme_options(r);
    ns_sparse_options sparse;
    return !ns_march_begins_sparse(r->s, &o, &sparse);
}

void ns_march_run_put_to_work(ns_run *r, ns_engine *e, ns_run_kind kind) {
    r->seen = (ns_recurrence){0};
    r->at_work = e;
    r->kind = kind;
    r->is_dense = kind == NS_RUN_DENSE || (kind == NS_RUN_SCHEME && scheme_is_dense(r));
    ns_march_check_attach(r);
}

void ns_march_run_dismiss(ns_run *r, ns_engine *was) {
    ns_march_add_counts(&r->before, was->table->counts(was));
    was->table->free(was);
}

static void replace_engine(ns_run *r, ns_engine *by, ns_run_kind kind) {
    ns_engine *was = r->at_work;
    ns_march_run_put_to_work(r, by, kind);
    ns_march_run_dismiss(r, was);
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
    const int status = make_dense(r, &r->options, &dense, &r->fault);
    if (status != NS_OK)
        return status;
    replace_engine(r, dense, NS_RUN_DENSE);
    put_off_sparse(r, t);
    return NS_OK;
}

int ns_march_run_read_accepted(ns_run *r, double *t, double **w, unsigned char **closed) {
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

static int make_scheme(ns_run *r, ns_engine **out) {
    const ns_march_options o = scheme_options(r);
    ns_sparse_options sparse;
    return ns_march_begins_sparse(r->s, &o, &sparse) ? ns_sparse_create(r->s, &sparse, out, NULL)
                                                     : make_dense(r, &o, out, NULL);
}

int ns_march_run_make(ns_run *r, ns_run_kind kind, ns_engine **out) {
    ns_march_options o = r->options;
    *out = NULL;
    if (kind == NS_RUN_SCHEME)
        return make_scheme(r, out);
    if (o.method == NS_THETA)
        o.method = NS_EXACT;
    if (!(o.gamma > 0))
        o.theta = o.gamma = 1;
    if (kind == NS_RUN_DENSE)
        return make_dense(r, &o, out, NULL);
    const ns_sparse_options sparse = ns_march_sparse_options(&o);
    return ns_sparse_create(r->s, &sparse, out, NULL);
}

/* --- from the accepted point on by another engine --- */

/* By the engine at work; it is judged.  Errors: those of a start, RESIDUAL (it is wrong: r->refused). */
static int start_at_accepted(ns_run *r, double t, const double *w, const unsigned char *closed) {
    const ns_run_start s = {.t = t, .w = w, .closed = closed};
    const int status = r->at_work->table->start(r->at_work, t, w, closed);
    if (status != NS_OK || ns_march_check_start(r, &s))
        return status;
    r->check.found = 0;
    r->check.retries++;
    return ns_march_run_refuse(r, &r->check.finding);
}

/* To another engine, which may refuse: then the one at work stays. */
static int start_other(ns_run *r, ns_run_kind kind, double t, const double *w, const unsigned char *closed) {
    ns_engine *const was = r->at_work, *other = NULL;
    const ns_run_kind was_kind = r->kind;
    int status = ns_march_run_make(r, kind, &other);
    if (status != NS_OK)
        return status;
    ns_march_run_put_to_work(r, other, kind);
    status = start_at_accepted(r, t, w, closed);
    if (status == NS_OK) {
        r->refused = 0;
        ns_march_run_dismiss(r, was);
        return NS_OK;
    }
    ns_march_run_put_to_work(r, was, was_kind);
    other->table->free(other);
    return status;
}

static int leave_for(ns_run *r, ns_run_kind kind) {
    double t, *w;
    unsigned char *closed;
    int status = ns_march_run_read_accepted(r, &t, &w, &closed);
    if (status == NS_OK)
        status = start_other(r, kind, t, w, closed);
    r->refused = 0; /* the one at work goes on */
    free(closed);
    free(w);
    return status;
}

int ns_march_run_leave_sparse(ns_run *r) {
    double t, *w;
    unsigned char *closed;
    int status = ns_march_run_read_accepted(r, &t, &w, &closed);
    if (status == NS_OK)
        status = ns_march_run_use_dense(r, t);
    if (status == NS_OK)
        status = start_at_accepted(r, t, w, closed);
    if (r->refused && status == NS_E_RESIDUAL && start_other(r, NS_RUN_SCHEME, t, w, closed) == NS_OK)
        status = NS_OK;
    if (status == NS_OK && r->is_dense)
        ns_march_dense_carry_start(r->at_work);
    free(closed);
    free(w);
    return status;
}

/* --- back to an engine that was found wrong --- */

void ns_march_run_leave_for_now(ns_run *r, double t, ns_run_kind was) {
    const int away = r->back_at < INFINITY;
    r->retry_sparse_at = INFINITY;
    r->back_interval = ns_march_retry_interval(&r->options, r->back_interval);
    r->back_to = away ? r->back_to : was;
    r->back_at = r->kind == r->back_to ? INFINITY : t + r->back_interval;
}

void ns_march_run_leave_for_the_start(ns_run *r, double t, ns_run_kind was) {
    r->retry_sparse_at = INFINITY;
    r->back_to = was;
    r->back_at = t;
}

void ns_march_run_return(ns_run *r) {
    double t;
    if (r->back_at == INFINITY || r->check.is_old || r->trial_is_start || ns_engine_at_event(r->at_work) ||
        ns_engine_read(r->at_work, &t, NULL, NULL, NULL) != NS_OK || t < r->back_at)
        return;
    r->back_at = INFINITY;
    if (leave_for(r, r->back_to) == NS_OK) {
        if (r->kind == NS_RUN_DENSE)
            ns_march_dense_let_hand_over(r->at_work, r->options.method == NS_AUTO);
        return;
    }
    r->back_interval = ns_march_retry_interval(&r->options, r->back_interval);
    r->back_at = t + r->back_interval;
}

/* --- back to the sparse engine, which refused --- */

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
    if (leave_for(r, NS_RUN_SPARSE) != NS_OK)
        put_off_sparse(r, t);
}

int ns_march_run_make_engine(ns_run *r, ns_fault *fault) {
    const int is_scheme = r->options.method == NS_THETA;
    ns_sparse_options options;
    r->kind = is_scheme ? NS_RUN_SCHEME : NS_RUN_SPARSE;
    if (ns_march_begins_sparse(r->s, &r->options, &options))
        return ns_sparse_create(r->s, &options, &r->at_work, fault);
    const int status = make_dense(r, &r->options, &r->at_work, fault);
    r->kind = is_scheme ? NS_RUN_SCHEME : NS_RUN_DENSE;
    r->is_dense = 1;
    if (status == NS_OK)
        ns_march_dense_let_hand_over(r->at_work, r->options.method == NS_AUTO);
    return status;
}
