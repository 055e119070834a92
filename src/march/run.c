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

static int start(ns_engine *e, double t0, const double *w0, const unsigned char *closed) {
    const ns_run_start s = {.t = t0, .w = w0, .closed = closed};
    return ns_march_run_start(run_of(e), &s);
}

/* NOLINTNEXTLINE(readability-non-const-parameter): x is written to through s */
static int start_dc(ns_engine *e, double t0, int nhold, const int *hold, const double *hold_x, double *x) {
    const ns_run_start s = {.t = t0, .is_dc = 1, .nhold = nhold, .hold = hold, .hold_x = hold_x, .x = x};
    return ns_march_run_start(run_of(e), &s);
}

/* By the engine at work, or by another one if it refuses.  What is found wrong in the trial ends it.  Where
 * engines hand it to one another, the last one goes on as well as it can. */
static int try_engines(ns_run *r, double t, ns_until until, double *reached) {
    enum { ROUNDS = 3, QUESTIONS = 40 };
    for (int rounds = 0, questions = 0; rounds < ROUNDS && questions < QUESTIONS;) {
        const double to = rounds + questions == 0 ? ns_march_check_begin(r, t, until) : t;
        if (r->check.found)
            return NS_E_RESIDUAL;
        int status = r->at_work->table->try_to(r->at_work, to, until, reached);
        *(ns_engine_is_over(r->at_work) ? &questions : &rounds) += 1;
        if (r->check.found || status == NS_OK || !ns_march_run_hand_over(r, t, until, reached, &status))
            return status;
        if (r->trial_is_start)
            return NS_OK;
    }
    if (r->kind == NS_RUN_DENSE)
        ns_march_dense_let_hand_over(r->at_work, NS_HANDS_OVER_NEVER);
    r->at_work->most_work = 0;
    return r->at_work->table->try_to(r->at_work, t, until, reached);
}

static int try_to(ns_engine *e, double t, ns_until until, double *reached) {
    ns_run *r = run_of(e);
    r->refused = 0;
    if (r->trial_is_start && until != NS_TO_TIME)
        return ns_engine_read(r->at_work, reached, NULL, NULL, NULL);
    r->trial_is_start = 0;
    ns_march_run_return(r);
    ns_march_run_choose(r, until);
    r->by_steps = until == NS_TO_STEP;
    const int status = try_engines(r, t, until, reached);
    if (r->trial_is_start)
        return NS_OK;
    if (r->check.found || (status == NS_OK && (!ns_march_check_end(r, t, until, *reached) ||
                                               ns_march_run_is_rough(r, t, until, *reached))))
        return ns_march_sliding_is_cause(r) ? ns_march_run_refuse(r, &r->check.finding)
                                            : ns_march_run_again(r, t, until, reached);
    return status;
}

/* Takes in the modes of switches without hysteresis that the state commands; 1 if one is not as at the last
 * call. */
static int note_switched(ns_run *r) {
    const ns_mode *mode = NULL;
    int any = 0;
    for (int c = 0; c < r->s->nc; c++) {
        const ns_command *k = &r->s->command[c];
        if (!k->gx || k->on != k->off)
            continue;
        mode = mode ? mode : ns_engine_mode(r->at_work);
        any |= r->switched[c] != mode[k->pair];
        r->switched[c] = mode[k->pair];
    }
    return any;
}

static int accept_trial(ns_engine *e) {
    ns_run *r = run_of(e);
    const int is_start = r->trial_is_start;
    r->check.is_old = r->trial_is_start = 0;
    const int status = is_start ? NS_OK : ns_engine_accept(r->at_work);
    double t;
    if (status == NS_OK && ns_engine_read(r->at_work, &t, NULL, NULL, NULL) == NS_OK) {
        const int switched = note_switched(r);
        r->is_right_side = r->by_steps && t == r->accepted_t && (switched || r->is_right_side);
        r->accepted_t = t;
    }
    return status;
}

static void drop(ns_engine *e) {
    ns_run *r = run_of(e);
    r->check.is_old = r->trial_is_start = 0;
    ns_engine_drop(r->at_work);
}

static int set_input(ns_engine *e, int input, const ns_signal *signal) {
    ns_run *r = run_of(e);
    drop(e);
    ns_march_run_forget(r, r->aside);
    r->aside = NULL;
    ns_march_check_renew(r);
    const int status = r->dense_copy ? ns_system_set_input(r->dense_copy, input, signal) : NS_OK;
    return status == NS_OK ? r->at_work->table->set_input(r->at_work, input, signal) : status;
}

static const ns_counts *counts(ns_engine *e) {
    ns_run *r = run_of(e);
    r->sum = *r->at_work->table->counts(r->at_work);
    ns_march_add_counts(&r->sum, &r->before);
    if (r->aside)
        ns_march_add_counts(&r->sum, r->aside->table->counts(r->aside));
    r->sum.checks = r->check.checks;
    r->sum.retries = r->check.retries;
    return &r->sum;
}

static const ns_fault *fault(const ns_engine *e) {
    const ns_run *r = (const ns_run *)(const void *)e;
    return r->refused ? &r->fault : ns_engine_fault(r->at_work);
}

static int problem(const ns_engine *e, ns_mlcp *p, double *h) {
    const ns_run *r = (const ns_run *)(const void *)e;
    return r->refused ? NS_E_STATE : ns_engine_problem(r->at_work, p, h);
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
    if (r->aside)
        r->aside->table->free(r->aside);
    ns_march_check_free(r);
    ns_system_free(r->dense_copy);
    free(r->switched);
    free(r);
}

static const ns_engine_table table = {
    .free = free_run,
    .start = start,
    .start_dc = start_dc,
    .try_to = try_to,
    .drop = drop,
    .accept = accept_trial,
    .counts = counts,
    .fault = fault,
    .problem = problem,
    .set_input = set_input,
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
    r->back_at = INFINITY;
    r->chooses = ns_march_chooses(s, o);
    r->switched = calloc((size_t)s->nc + 1, sizeof *r->switched);
    int status = r->switched ? ns_march_run_make_engine(r, fault) : NS_E_MEMORY;
    if (status == NS_OK)
        status = ns_march_check_create(r);
    if (status != NS_OK) {
        free_run(&r->engine);
        return status;
    }
    *out = &r->engine;
    return NS_OK;
}
