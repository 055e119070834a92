/* src/march/run_again.c - a trial that was found wrong is gone again from the accepted point: by the same
 * engine with smaller errors, if it can, by the other kernel, then by the theta scheme with smaller steps.
 */
#include "run_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The accepted point, and what is asked for. */
typedef struct again {
    double t, *w;  /* n: charges and fluxes */
    double *point; /* n+m: x, lambda */
    unsigned char *closed;
    int from_event; /* it is the left side of an event */
    int own_w;      /* w is not M x of the point */
    double asked;
    ns_until until;
} again;

static const ns_run_kind kernels[] = {NS_RUN_DENSE, NS_RUN_SPARSE};

/* --- the accepted point --- */

static int begin_again(ns_run *r, again *a) {
    ns_engine_drop(r->at_work);
    a->from_event = ns_engine_at_event(r->at_work);
    const int status = ns_march_run_read_accepted(r, &a->t, &a->w, &a->closed);
    if (status != NS_OK)
        return status;
    a->point = calloc((size_t)r->s->n + (size_t)r->s->m + 1, sizeof *a->point);
    if (!a->point)
        return NS_E_MEMORY;
    const int read = ns_engine_read(r->at_work, NULL, a->point, a->point + r->s->n, NULL);
    double *charges = calloc((size_t)r->s->n + 1, sizeof *charges);
    if (!charges)
        return NS_E_MEMORY;
    ns_system_charges(r->s, a->point, charges);
    a->own_w = memcmp(charges, a->w, sizeof *charges * (size_t)r->s->n) != 0;
    free(charges);
    return read;
}

/* --- one engine --- */

/* From the accepted point on by a start there. */
static int start_is_right(ns_run *r, const again *a) {
    const size_t n = (size_t)r->s->n, all = n + (size_t)r->s->m;
    ns_run_check *k = &r->check;
    double t;
    k->found = 0;
    memcpy(k->here, a->point, sizeof *k->here * all);
    (void)ns_march_check_point(r, a->t, a->from_event ? NS_LEFT : NS_RIGHT);
    ns_verify_left(k->verify);
    if (a->own_w)
        ns_verify_left_charges(k->verify, a->t, a->w);
    k->found = 0;
    if (ns_engine_read(r->at_work, &t, k->here, k->here + n, NULL) != NS_OK ||
        ns_engine_impulse(r->at_work, k->impulse, k->impulse + n) != NS_OK)
        return 0;
    return ns_march_check_point(r, t, NS_RIGHT) && ns_march_check_event(r);
}

/* 1 if the start is all that the trial asks for. */
static int ends_at_start(ns_run *r, const again *a) {
    double t;
    return a->from_event && a->until != NS_TO_TIME &&
           ns_engine_read(r->at_work, &t, NULL, NULL, NULL) == NS_OK && t == a->t;
}

static void note_failure(ns_run *r, int status) {
    if (status == NS_OK || r->failed.status != NS_OK)
        return;
    const ns_fault *f = ns_engine_fault(r->at_work);
    if (f->npairs > 0)
        r->failed = *f;
}

/* The trial by the engine at work, judged whole. */
static int try_judged(ns_run *r, const again *a, double *reached) {
    ns_run_check *k = &r->check;
    k->found = k->is_old = 0;
    k->credit = INFINITY; /* every event, and the end */
    k->way_next = 0;
    k->again_events = 1;
    k->again_from = a->t;
    k->again_to = a->asked;
    const int status = r->at_work->table->try_to(r->at_work, a->asked, a->until, reached);
    const int right = status == NS_OK && ns_march_check_end(r, a->asked, a->until, *reached);
    note_failure(r, status);
    k->credit = 0;
    k->again_events = 0;
    return right;
}

static int start_judged(ns_run *r, const again *a, double *reached) {
    if (r->kind == NS_RUN_DENSE) /* it would hand over to the one that was wrong */
        ns_march_dense_let_hand_over(r->at_work, NS_HANDS_OVER_NEVER);
    const int status = r->at_work->table->start(r->at_work, a->t, a->w, a->closed);
    r->at_work->most_work = 0; /* that was for the start */
    note_failure(r, status);
    r->was_cut_off |= status != NS_OK && r->kind == NS_RUN_DENSE && ns_march_dense_was_cut_off(r->at_work);
    if (status != NS_OK || !start_is_right(r, a))
        return 0;
    r->trial_is_start = ends_at_start(r, a);
    *reached = a->t;
    if (r->trial_is_start)
        return 1;
    if (r->is_dense)
        ns_march_dense_carry_start(r->at_work);
    return try_judged(r, a, reached);
}

/* 1: found by ns_march_run_is_rough(): its time is the end of the trial, its cause is not known. */
static int is_of_rough_steps(const ns_verify_finding *f) {
    return isinf(f->error);
}

int ns_march_run_is_rough(ns_run *r, double t, ns_until until, double reached) {
    enum { LONG = 16 };
    if (r->kind != NS_RUN_DENSE)
        return 0;
    const int is_long =
        until == NS_TO_TIME && ns_march_dense_without_matrices(r->at_work) > LONG * r->options.h;
    if (!is_long &&
        (!ns_march_dense_by_ladder(r->at_work) || ns_march_run_ladder_is_believed(r, t, until, reached)))
        return 0;
    r->check.finding =
        (ns_verify_finding){.cause = NS_VERIFY_FLOW, .t = t, .pair = -1, .unknown = -1, .error = INFINITY};
    return 1;
}

typedef struct attempt {
    const again *from;
    double *reached;
    int *is_rough; /* 1: the scheme would have to take shorter steps */
} attempt;

static int begin_attempt(ns_run *r, const void *data) {
    const attempt *by = data;
    const again *a = by->from;
    *by->is_rough = 0;
    if (!start_judged(r, a, by->reached))
        return NS_E_RESIDUAL;
    /* where it found an event shorter steps may be beyond that */
    if (r->kind == NS_RUN_SCHEME && (*by->reached == a->asked || !ns_engine_at_event(r->at_work))) {
        const ns_run_start from = {.t = a->t, .w = a->w, .closed = a->closed};
        *by->is_rough = !ns_march_run_is_believed(r, &from, *by->reached);
    } else if (ns_march_run_is_rough(r, a->asked, a->until, *by->reached))
        return NS_E_RESIDUAL;
    return *by->is_rough ? NS_E_RESIDUAL : NS_OK;
}

/* --- all of them --- */

/* By the same engine, which was asked for less than it can do: it keeps to smaller errors. */
static int go_finer(ns_run *r, const again *a, double *reached) {
    while (ns_engine_be_finer(r->at_work)) {
        if (try_judged(r, a, reached))
            return 1;
        ns_engine_drop(r->at_work);
    }
    return 0;
}

/* By the scheme with shorter steps, until shorter ones come to the same.
 * NOLINTNEXTLINE(readability-non-const-parameter): written to through by */
static int go_by_scheme(ns_run *r, const again *a, double *reached) {
    enum { TRIES = 4 };
    int is_rough = 1;
    const attempt by = {a, reached, &is_rough};
    const ns_run_change how = {begin_attempt, &by, 0};
    r->scheme_step = 0;
    for (int i = 0; i < TRIES && is_rough; i++) {
        if (ns_march_run_change(r, NS_RUN_SCHEME, &how) == NS_OK)
            return 1;
        r->scheme_step = ns_march_run_finer_step(r, *reached - a->t);
    }
    r->scheme_step = 0;
    return 0;
}

static int is_judged_right(ns_run *r, const void *data) {
    const attempt *by = data;
    const int right = try_judged(r, by->from, by->reached);
    if (!right)
        ns_engine_drop(r->at_work);
    return right;
}

/* Signs that are wrong for a moment are excused.
 * NOLINTNEXTLINE(readability-non-const-parameter): written to through by */
static int go_excused(ns_run *r, const again *a, double *reached) {
    const attempt by = {a, reached, NULL};
    return ns_march_run_goes_excused(r, is_judged_right, &by);
}

/* A start that would take more than the run took so far comes last, if none passes without.
 * NOLINTNEXTLINE(readability-non-const-parameter): written to through by */
static int go_by_others(ns_run *r, const again *a, double most, double *reached) {
    const ns_run_kind own = r->kind;
    int done = 0, is_rough;
    const attempt by = {a, reached, &is_rough};
    const ns_run_change how = {begin_attempt, &by, 0};
    r->may_spend = most;
    r->was_cut_off = 0;
    for (size_t i = 0; i < sizeof kernels / sizeof *kernels && !done && !ns_march_sliding_is_cause(r); i++)
        done = kernels[i] != own && ns_march_run_change(r, kernels[i], &how) == NS_OK;
    if (!done && own != NS_RUN_SCHEME && !ns_march_sliding_is_cause(r))
        done = go_by_scheme(r, a, reached);
    r->may_spend = r->at_work->most_work = 0;
    if (done)
        ns_march_run_was_wrong(r, a->t, own, *reached - a->t);
    return done || (most > 0 && r->was_cut_off && go_by_others(r, a, 0, reached));
}

int ns_march_run_again(ns_run *r, double t, ns_until until, double *reached) {
    ns_run_check *k = &r->check;
    const ns_verify_finding first = k->finding;
    ns_verify_finding last = first;
    again a = {.asked = t, .until = until};
    int status = begin_again(r, &a), right = 0, chatters = 0;
    k->retries++;
    k->found = 0;
    r->failed.status = NS_OK;
    if (status == NS_OK) {
        right = go_excused(r, &a, reached) || go_finer(r, &a, reached) ||
                go_by_others(r, &a, ns_march_run_work(r).all, reached);
        last = k->finding;
        chatters = !right && ns_march_sliding_is_cause(r);
        right = right || (!chatters && ns_march_run_allows(r, &first) && try_judged(r, &a, reached));
        k->is_old = right;
        k->asked = t;
        k->until = (int)until;
        if (!right)
            ns_engine_drop(r->at_work);
    }
    free(a.point);
    free(a.w);
    free(a.closed);
    k->found = 0;
    if (right || status != NS_OK)
        return right ? NS_OK : status;
    return is_of_rough_steps(&first) && r->failed.status != NS_OK
               ? ns_march_run_refuse_failed(r)
               : ns_march_run_refuse(r, chatters ? &last : &first);
}
