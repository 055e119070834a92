/* src/march/dense_run.c - one system by dense matrices: the exact engine, and the ladder where that cannot go
 * on. */
#include "dense_internal.h"
#include "march_internal.h"
#include "nonsmooth/theta.h"
#include "select.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static ns_dense_run *run_of(ns_engine *e) {
    return (ns_dense_run *)(void *)e;
}

static const ns_dense_run *run_in(const ns_engine *e) {
    return (const ns_dense_run *)(const void *)e;
}

static void free_run(ns_engine *e) {
    ns_dense_run *r = run_of(e);
    if (!r)
        return;
    ns_exact_free(r->exact);
    ns_ladder_free(r->ladder);
    ns_theta_free(r->step);
    free(r->past);
    free(r->instant.sum);
    free(r->way.begin);
    free(r->trial.flip);
    free(r->accepted.flip);
    free(r->guess);
    free(r);
}

static int allocate_arrays(ns_dense_run *r) {
    const size_t nc = (size_t)r->s->nc, size = (size_t)r->s->n + (size_t)r->s->m;
    r->instant.size = r->s->n + r->s->m;
    r->instant.sum = calloc(4 * size + 1, sizeof(double));
    r->trial.instant = r->accepted.instant = &r->instant;
    r->past = calloc(ns_theta_past_size(r->step) + 1, sizeof(double));
    r->trial.flip = calloc(nc + 1, 1);
    r->accepted.flip = calloc(nc + 1, 1);
    r->guess = calloc((size_t)r->s->m + 1, sizeof *r->guess);
    if (!r->past || !r->trial.flip || !r->accepted.flip || !r->instant.sum || !r->guess)
        return NS_E_MEMORY;
    r->carried = r->instant.sum + size;
    r->sampled[0].at = r->carried + size;
    r->sampled[1].at = r->sampled[0].at + size;
    return NS_OK;
}

static int make_engines(ns_dense_run *r, ns_fault *fault) {
    const ns_march_options *o = &r->options;
    const ns_theta_options options = {o->theta, o->gamma, o->map_bytes};
    int status = ns_theta_create(r->s, &options, &r->step, fault);
    if (status == NS_OK)
        status = allocate_arrays(r);
    if (status == NS_OK)
        status = ns_ladder_create(r->step, &r->trial, o->h, &r->ladder);
    if (status == NS_OK && o->method != NS_THETA)
        status = ns_exact_create(r->step, &r->trial, o->h, &r->exact);
    if (r->exact)
        ns_exact_bound_by(r->exact, &r->engine);
    return status;
}

/* --- what jumps --- */

void ns_march_dense_carry_start(ns_engine *e) {
    ns_dense_run *r = run_of(e);
    memcpy(r->carried, r->instant.sum, sizeof *r->carried * (size_t)r->instant.size);
    r->carries = r->instant.any != 0;
}

static int impulse(ns_engine *e, double *x, double *lambda) {
    const ns_dense_run *r = run_of(e);
    const int n = r->s->n;
    for (int i = 0; i < r->instant.size; i++) {
        const double sum = r->instant.sum[i] + (r->carries ? r->carried[i] : 0);
        if (i < n && x)
            x[i] = sum;
        else if (i >= n && lambda)
            lambda[i - n] = sum;
    }
    return r->started ? NS_OK : NS_E_STATE;
}

/* --- a trial --- */

static int exact_is_ready(const ns_dense_run *r) {
    return r->exact && !ns_exact_in_fallback(r->exact);
}

/* The exact engine fails often and no switch chatters, or it has no matrices for a mode, which may last:
 * steps of first order would go on without a bound of their error. */
static int fails(const ns_dense_run *r) {
    enum { OFTEN = 64 };
    const int often = ns_exact_timed(r->exact) && ns_exact_failures(r->exact) >= OFTEN;
    return !r->accepted.at_event &&
           ((r->may_hand_over >= NS_HANDS_OVER_OFTEN && often) ||
            (r->may_hand_over >= NS_HANDS_OVER_MODES && ns_exact_has_no_matrices(r->exact)));
}

/* The sparse engine may have a mode at once where branch and bound would look for one for seconds. */
static double search_of_trial(const ns_dense_run *r) {
    return r->may_hand_over >= NS_HANDS_OVER_OFTEN ? ns_march_first_question(r->s, 1) : INFINITY;
}

static int go_to(ns_dense_run *r, double t, ns_until until) {
    const double accepted_t = r->accepted.now.t;
    const int from_event = r->trial.at_event && until != NS_TO_TIME;
    int status = NS_OK, done = 0;
    r->moved = 1;
    r->without_matrices = 0;
    r->by_ladder = 0;
    r->way.is_line = 0;
    r->sampled[0].known = r->sampled[1].known = 0;
    ns_ladder_begin_trial(r->ladder, t - r->trial.now.t);
    ns_march_dense_bound_search(r, search_of_trial(r));
    while (status == NS_OK && !done && r->trial.now.t < t) {
        if (exact_is_ready(r) && r->way.is_line && r->trial.now.t > accepted_t)
            break; /* a trial is read as a line, or as the exact engine has it, not as both */
        if (ns_engine_is_over(&r->engine)) {
            status = NS_E_LIMIT;
            break;
        }
        if (exact_is_ready(r)) {
            status = ns_exact_go(r->exact, accepted_t, t, until);
            r->by_ladder = 0;
            r->hands_over = status == NS_OK && fails(r);
            const int there = r->trial.at_event || r->trial.now.t == accepted_t;
            done = r->hands_over || (until != NS_TO_TIME && exact_is_ready(r) && (from_event || there)) ||
                   (until == NS_TO_STEP && r->trial.now.t > accepted_t);
            continue;
        }
        if (until == NS_TO_STEP && (status = ns_march_dense_begin_line(r, r->trial.at_event)) != NS_OK)
            break;
        const double interrupt = r->exact ? ns_exact_fallback_until(r->exact) : INFINITY;
        const ns_ladder_stop stop = {t, until, from_event, accepted_t, interrupt};
        const double from = r->trial.now.t;
        status = ns_ladder_go(r->ladder, &stop, &done);
        r->by_ladder = r->exact && r->trial.now.t > from && from == accepted_t;
        if (r->exact && ns_exact_has_no_matrices(r->exact))
            r->without_matrices += r->trial.now.t - from;
        r->trial.last_event_t = r->trial.now.t; /* modes may change on its way */
    }
    if (status == NS_OK && r->hands_over)
        return NS_E_LIMIT;
    r->was_cut_off = !(ns_theta_search_left(r->step) > 0);
    r->hands_over =
        status != NS_OK && status != NS_E_MEMORY && r->may_hand_over >= NS_HANDS_OVER_OFTEN && r->was_cut_off;
    return status == NS_OK ? NS_OK : ns_march_dense_fail(r, status);
}

static void drop(ns_engine *e) {
    ns_march_dense_drop(run_of(e));
    ns_march_dense_clear_instant(run_of(e));
}

static int try_to(ns_engine *e, double t, ns_until until, double *reached) {
    ns_dense_run *r = run_of(e);
    r->hands_over = 0;
    if (!r->started)
        return ns_march_dense_fail(r, NS_E_STATE);
    if (!(t > r->accepted.now.t) || !isfinite(t))
        return ns_march_dense_fail(r, NS_E_RANGE);
    const int same = until == r->until;
    const int again =
        r->has_trial && ((t == r->trial.now.t && (same || until != NS_TO_STEP)) || (t == r->asked && same));
    if (!again) {
        drop(e);
        const int status = go_to(r, t, until);
        if (status != NS_OK) {
            drop(e);
            return status;
        }
        r->has_trial = 1;
        r->asked = t;
        r->until = until;
    }
    *reached = r->trial.now.t;
    return NS_OK;
}

static int accept_trial(ns_engine *e) {
    return ns_march_dense_accept(run_of(e));
}

/* --- what is read --- */

static int read_point(ns_engine *e, double *t, double *x, double *lambda, double *y) {
    ns_dense_run *r = run_of(e);
    if (!r->started)
        return NS_E_STATE;
    if (t)
        *t = r->trial.now.t;
    if (!x && !lambda && !y)
        return NS_OK;
    const int status = ns_theta_read(r->step, x, lambda, y);
    return status == NS_OK ? NS_OK : ns_march_dense_fail(r, status);
}

/* Without y, which would double the time.  STATE while the scheme is at work: only read() computes its point.
 */
static int peek(ns_engine *e, double *x, double *lambda) {
    ns_dense_run *r = run_of(e);
    return r->started && exact_is_ready(r) ? ns_theta_read(r->step, x, lambda, NULL) : NS_E_STATE;
}

static const ns_mode *mode_of(ns_engine *e) {
    return ns_theta_mode(run_of(e)->step);
}

static int at_event(const ns_engine *e) {
    return run_in(e)->trial.at_event;
}

static ns_method method(const ns_engine *e) {
    return exact_is_ready(run_in(e)) ? NS_EXACT : NS_THETA;
}

static const ns_counts *counts(ns_engine *e) {
    ns_dense_run *r = run_of(e);
    r->counts = *ns_theta_counts(r->step);
    r->counts.events = r->counts.jumps = r->counts.jumps_by_steps = 0;
    if (r->exact)
        ns_march_add_counts(&r->counts, ns_exact_counts(r->exact));
    ns_ladder_counts(r->ladder, &r->counts);
    return &r->counts;
}

/* By counts: fitted to CPU times of 68 circuits of tests/stress, as instructions of the sparse engine that
 * take as long; half of them take 0.7 to 1.15 times as much as it says. */
static ns_work work(ns_engine *e) {
    const ns_counts *c = counts(e);
    const ns_dense_run *r = run_in(e);
    const double size = (double)r->s->n + (double)r->s->m, square = size * size;
    const double by_replay = r->exact ? (double)ns_exact_replayed(r->exact) : 0, events = (double)c->events;
    const double once = ns_theta_matrix_work(r->step, c);
    return (ns_work){.all = once + 2900 * (double)c->steps + 28 * square * (events - by_replay) +
                            280 * square * (double)c->trials + ns_theta_problem_work(r->step),
                     .once = once,
                     .events = events};
}

static const ns_fault *fault(const ns_engine *e) {
    return &run_in(e)->fault;
}

static int problem(const ns_engine *e, ns_mlcp *p, double *h) {
    const ns_dense_run *r = run_in(e);
    return r->fault.status == ns_theta_fault(r->step)->status ? ns_theta_problem(r->step, p, h) : NS_E_STATE;
}

int ns_march_dense_hands_over(const ns_engine *e) {
    return run_in(e)->hands_over;
}

int ns_march_dense_by_ladder(const ns_engine *e) {
    return run_in(e)->by_ladder;
}

void ns_march_dense_believe(ns_engine *e) {
    run_of(e)->by_ladder = 0;
}

double ns_march_dense_without_matrices(const ns_engine *e) {
    return run_in(e)->without_matrices;
}

int ns_march_dense_was_cut_off(const ns_engine *e) {
    return run_in(e)->was_cut_off;
}

void ns_march_dense_let_hand_over(ns_engine *e, ns_dense_handover may) {
    run_of(e)->may_hand_over = may;
}

/* The exact engine looks for itself what the input does at the left side of an event; so it gets one. */
static int set_input(ns_engine *e, int input, const ns_signal *signal) {
    ns_dense_run *r = run_of(e);
    (void)signal;
    drop(e);
    int status = ns_ladder_set_input(r->ladder, input);
    if (status == NS_OK && r->exact)
        status = ns_exact_set_input(r->exact, input);
    if (status != NS_OK)
        return ns_march_dense_fail(r, status);
    if (exact_is_ready(r) && !r->trial.at_event && ns_exact_input_matters(r->exact, input))
        r->trial.at_event = r->trial.input_jumps = 1;
    r->has_trial = 1;
    return ns_march_dense_accept(r);
}

static void watch(ns_engine *e, const ns_watch *w) {
    if (run_of(e)->exact)
        ns_exact_watch(run_of(e)->exact, w);
}

static const ns_engine_table table = {
    .free = free_run,
    .start = ns_march_dense_start,
    .start_dc = ns_march_dense_start_dc,
    .try_to = try_to,
    .drop = drop,
    .accept = accept_trial,
    .read = read_point,
    .impulse = impulse,
    .mode = mode_of,
    .at_event = at_event,
    .method = method,
    .counts = counts,
    .work = work,
    .fault = fault,
    .sample = ns_march_dense_sample,
    .shortest = ns_march_dense_shortest,
    .problem = problem,
    .peek = peek,
    .watch = watch,
    .guess = ns_march_dense_guess,
    .set_input = set_input,
};

int ns_march_dense_create(const ns_system *s, const ns_march_options *o, ns_engine **out, ns_fault *fault) {
    ns_dense_run *r = calloc(1, sizeof *r);
    *out = NULL;
    if (!r)
        return NS_E_MEMORY;
    r->engine.table = &table;
    r->s = s;
    r->options = *o;
    const int status = make_engines(r, fault);
    if (status != NS_OK) {
        free_run(&r->engine);
        return status;
    }
    *out = &r->engine;
    return NS_OK;
}
