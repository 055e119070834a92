/* src/march/run_handover.c - engines of a run: made, and replaced by one another from the accepted point on.
 */
#include "run_internal.h"
#include "system/dense_copy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A kernel in place of one that was wrong may spend this part of the work done before, and a question. */
static const double kernel_part = 0.25;

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
    if (r->scheme_step > 0)
        o.h = fmin(o.h, r->scheme_step);
    return o;
}

double ns_march_run_scheme_step(const ns_run *r) {
    return scheme_options(r).h;
}

/* By dense matrices, or if that is asked for or there are too many unknowns by sparse factors. */
static int scheme_is_dense(const ns_run *r) {
    const ns_march_options o = scheme_options(r);
    ns_sparse_options sparse;
    return !ns_march_begins_sparse(r->s, &o, &sparse);
}

void ns_march_run_put_to_work(ns_run *r, ns_engine *e, ns_run_kind kind) {
    r->at_work = e;
    r->kind = kind;
    /* one that was put aside may have been bounded */
    e->most_work = r->may_spend > 0 ? ns_engine_work(e).all + r->may_spend : 0;
    e->pause_work = 0;
    r->is_dense = kind == NS_RUN_DENSE || (kind == NS_RUN_SCHEME && scheme_is_dense(r));
    ns_march_check_attach(r);
}

void ns_march_run_dismiss(ns_run *r, ns_engine *was) {
    ns_march_add_counts(&r->before, was->table->counts(was));
    ns_march_run_forget(r, was);
}

void ns_march_run_forget(ns_run *r, ns_engine *e) {
    if (!e)
        return;
    const ns_work work = ns_engine_work(e);
    r->work_before.all += work.all;
    r->work_before.once += work.once;
    r->work_before.events += work.events;
    e->table->free(e);
}

/* The one put aside, or a new one, which counts for nothing before it began. */
static int take_engine(ns_run *r, ns_run_kind kind, ns_engine **out, int *is_new) {
    *is_new = !r->aside || r->aside_kind != kind;
    if (*is_new)
        return ns_march_run_make(r, kind, out);
    *out = r->aside;
    r->aside = NULL;
    return NS_OK;
}

/* What it learnt is of use when it is at work again. */
static void put_aside(ns_run *r, ns_engine *e, ns_run_kind kind) {
    if (r->aside)
        ns_march_run_dismiss(r, r->aside);
    r->aside = e;
    r->aside_kind = kind;
}

int ns_march_run_change(ns_run *r, ns_run_kind kind, const ns_run_change *how) {
    ns_engine *const was = r->at_work, *other;
    const ns_run_kind was_kind = r->kind;
    int is_new, status = take_engine(r, kind, &other, &is_new);
    if (status != NS_OK)
        return status;
    ns_march_run_put_to_work(r, other, kind);
    status = how->begin(r, how->data);
    if (status != NS_OK) {
        ns_march_run_put_to_work(r, was, was_kind);
        (is_new ? ns_march_run_forget : ns_march_run_dismiss)(r, other);
        return status;
    }
    if (kind != NS_RUN_SCHEME)
        r->scheme_step = 0;
    other->way_from = fmin(other->way_from, was->way_from);
    if (how->keeps)
        put_aside(r, was, was_kind);
    else
        ns_march_run_dismiss(r, was);
    return NS_OK;
}

int ns_march_run_use_dense(ns_run *r, double t) {
    ns_engine *dense;
    const int status = make_dense(r, &r->options, &dense, &r->fault);
    if (status != NS_OK)
        return status;
    ns_engine *const was = r->at_work;
    ns_march_run_put_to_work(r, dense, NS_RUN_DENSE);
    ns_march_run_dismiss(r, was);
    ns_march_run_leave_for_now(r, t, NS_RUN_SPARSE, INFINITY);
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

typedef struct accepted {
    double t, *w;
    unsigned char *closed;
    ns_mode *mode; /* m */
} accepted;

static int read_accepted(ns_run *r, accepted *a) {
    const size_t m = (size_t)r->s->m;
    a->mode = malloc((m + 1) * sizeof *a->mode);
    const int status = ns_march_run_read_accepted(r, &a->t, &a->w, &a->closed);
    if (a->mode)
        memcpy(a->mode, ns_engine_mode(r->at_work), m * sizeof *a->mode);
    return a->mode ? status : NS_E_MEMORY;
}

static void free_accepted(accepted *a) {
    free(a->closed);
    free(a->w);
    free(a->mode);
}

/* By the engine at work; it is judged.  Errors: those of a start, RESIDUAL (it is wrong: r->refused). */
static int start_at_accepted(ns_run *r, const void *data) {
    const accepted *a = data;
    const ns_run_start s = {.t = a->t, .w = a->w, .closed = a->closed};
    ns_engine_guess(r->at_work, a->mode);
    const int status = r->at_work->table->start(r->at_work, a->t, a->w, a->closed);
    if (status == NS_OK && !ns_march_check_start(r, &s)) {
        r->check.found = 0;
        r->check.retries++;
        return ns_march_run_refuse(r, &r->check.finding);
    }
    if (status == NS_OK)
        r->refused = 0;
    return status;
}

int ns_march_run_leave_for(ns_run *r, ns_run_kind kind, int keeps) {
    accepted a;
    const ns_run_change how = {start_at_accepted, &a, keeps};
    int status = read_accepted(r, &a);
    if (status == NS_OK)
        status = ns_march_run_change(r, kind, &how);
    r->refused = 0; /* the one at work goes on */
    free_accepted(&a);
    return status;
}

int ns_march_run_leave_sparse(ns_run *r) {
    accepted a;
    const ns_run_change by_scheme = {start_at_accepted, &a, 0};
    const double from = r->at_work->way_from;
    int status = read_accepted(r, &a);
    if (status == NS_OK)
        status = ns_march_run_use_dense(r, a.t);
    if (status == NS_OK)
        status = start_at_accepted(r, &a);
    if (r->refused && status == NS_E_RESIDUAL)
        status = ns_march_run_change(r, NS_RUN_SCHEME, &by_scheme);
    if (status == NS_OK)
        r->at_work->way_from = from;
    if (status == NS_OK && r->is_dense)
        ns_march_dense_carry_start(r->at_work);
    free_accepted(&a);
    return status;
}

/* --- back to an engine that failed, or was found wrong --- */

static void leave_scheme_after(ns_run *r, double t, double stay) {
    enum { LEAST_EXPONENT = -30 }; /* so that twice as long is longer */
    r->scheme_stay = fmin(fmax(stay, ldexp(r->options.h, LEAST_EXPONENT)), r->options.h);
    r->back_from_scheme = t + r->scheme_stay;
}

void ns_march_run_leave_for_now(ns_run *r, double t, ns_run_kind was, double stay) {
    enum { SHORTEST_EXPONENT = -6 };
    const int at_once = t < r->back_from_scheme + r->scheme_stay;
    const int away = r->back_at < INFINITY;
    r->back_interval = ns_march_retry_interval(&r->options, r->back_interval);
    r->back_to = away ? r->back_to : was;
    r->back_at = r->kind == r->back_to ? INFINITY : t + r->back_interval;
    r->back_work = (1 + kernel_part) * ns_march_run_work(r).all + ns_march_first_question(r->s, r->is_dense);
    leave_scheme_after(r, t,
                       at_once ? 2 * r->scheme_stay : fmin(stay, ldexp(r->options.h, SHORTEST_EXPONENT)));
}

/* Where no kernel was right steps of the scheme go on, which are of first order: nobody judges how their
 * errors add up, and they may cost far more than all before.  So it goes as short a way as may be, twice as
 * far if no kernel goes farther than that after it.  The other kernel may follow a transient step by step. */
static int is_due(ns_run *r, double t) {
    return t >= r->back_at ||
           (r->kind == NS_RUN_SCHEME ? t >= r->back_from_scheme : ns_march_run_work(r).all >= r->back_work);
}

void ns_march_run_leave_for_the_start(ns_run *r, double t, ns_run_kind was) {
    r->back_to = was;
    r->back_at = r->back_from_scheme = t;
}

/* Right after an event a switch that changed with another one may be beside its own threshold still. */
int ns_march_run_rests(ns_run *r, double *t) {
    return !r->check.is_old && !r->trial_is_start && !r->is_right_side && !ns_engine_at_event(r->at_work) &&
           ns_engine_read(r->at_work, t, NULL, NULL, NULL) == NS_OK;
}

static ns_dense_handover handover_of(const ns_run *r) {
    return r->options.method == NS_AUTO ? NS_HANDS_OVER_OFTEN : NS_HANDS_OVER_MODES;
}

void ns_march_run_return(ns_run *r) {
    double t;
    if (r->back_at == INFINITY || !ns_march_run_rests(r, &t) || !is_due(r, t))
        return;
    r->back_at = INFINITY;
    if (ns_march_run_leave_for(r, r->back_to, 0) == NS_OK) {
        if (r->kind == NS_RUN_DENSE)
            ns_march_dense_let_hand_over(r->at_work, handover_of(r));
        return;
    }
    r->back_interval = ns_march_retry_interval(&r->options, r->back_interval);
    r->back_at = t + r->back_interval;
    leave_scheme_after(r, t, 2 * r->scheme_stay);
    if (r->kind == NS_RUN_SCHEME && r->scheme_step > 0) { /* such steps were for a trial */
        r->scheme_step = 0;
        (void)ns_march_run_leave_for(r, NS_RUN_SCHEME, 0);
    }
}

int ns_march_run_make_engine(ns_run *r, ns_fault *fault) {
    const int is_scheme = r->options.method == NS_THETA;
    ns_sparse_options options;
    r->kind = is_scheme ? NS_RUN_SCHEME : NS_RUN_SPARSE;
    if (ns_march_begins_sparse(r->s, &r->options, &options)) {
        const int made = ns_sparse_create(r->s, &options, &r->at_work, fault);
        if (made != NS_E_SINGULAR || ns_march_too_large(r->s))
            return made; /* else the dense engines name what is not determined, where they start */
    }
    const int status = make_dense(r, &r->options, &r->at_work, fault);
    r->kind = is_scheme ? NS_RUN_SCHEME : NS_RUN_DENSE;
    r->is_dense = 1;
    if (status == NS_OK)
        ns_march_dense_let_hand_over(r->at_work, handover_of(r));
    return status;
}
