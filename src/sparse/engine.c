/* src/sparse/engine.c - trials of the engine for large circuits, accepted or dropped. */
#include "guards.h"
#include "step.h"

#include <math.h>
#include <string.h>

/* So many steps a trial may take, and so many more for each longest step that fits into it. */
enum { FEWEST_STEPS = 100000, STEPS_A_LENGTH = 20000 };

int ns_sparse_fail(ns_sparse *m, double t, int status) {
    m->fault.status = (ns_status)status;
    m->fault.nunknowns = 0;
    if (status != NS_E_INFEASIBLE && status != NS_E_SINGULAR && status != NS_E_LIMIT)
        m->fault.npairs = 0;
    m->fault.t = t;
    return status;
}

/* The trial as far into its step as t is. */
static void move_to(ns_sparse *m, double t) {
    const ns_dense_step *step = m->trial.step;
    const int whole = t >= step->end_t || (step->is_euler && step->stages == 1 && !(m->o.theta > 0));
    m->trial.tau = whole ? step->length : fmin(t - step->t - step->time_lost, step->length);
    m->trial.t = whole ? step->end_t : t;
}

/* The trial at the beginning of a step. */
static void enter_step(ns_sparse *m, ns_dense_step *step, double t) {
    m->trial = (ns_sparse_point){.step = step, .tau = 0, .t = t};
}

void ns_sparse_rewind(ns_sparse *m, double t0) {
    enter_step(m, m->steps, t0);
    m->accepted = m->trial;
    m->engine.way_from = t0;
    m->started = m->has_trial = 0;
    m->inputs_from = -INFINITY;
    ns_instant_clear(&m->instant);
}

int ns_sparse_first_step(ns_sparse *m) {
    ns_sparse_event_save(m);
    const int status = ns_sparse_next_step(m, m->trial.t, NULL, m->trial.step);
    if (status == NS_OK && ns_sparse_transient_is_due(m, m->trial.step)) {
        ns_sparse_event_restore(m);
        (void)ns_sparse_transient_pass(m, m->trial.t, NULL, m->trial.step);
    }
    m->started = status == NS_OK;
    return status;
}

static int is_at_event(const ns_sparse *m) {
    return m->started && m->trial.step->at_event && m->trial.t >= m->trial.step->end_t;
}

int ns_sparse_at_event(const ns_engine *e) {
    return is_at_event((const ns_sparse *)(const void *)e);
}

/* m->w and m->mode at the end of a step. */
static void leave_step(ns_sparse *m, const ns_dense_step *step) {
    ns_sparse_step_state(m, step, step->length, m->w);
    ns_sparse_guard_set_mode(m, step->mode);
}

static int is_refusal(int status) {
    return status == NS_E_SINGULAR || status == NS_E_LIMIT || status == NS_E_INFEASIBLE ||
           status == NS_E_RESIDUAL;
}

static ns_dense_step *unused_step(ns_sparse *m) {
    ns_dense_step *step = m->steps;
    while (step == m->trial.step || step == m->accepted.step)
        step++;
    return step;
}

/* The event at the end of a step, and the next step. */
static int step_after_event(ns_sparse *m, double t, const ns_dense_step *from, ns_dense_step *to) {
    ns_sparse_event_own_changes(m, from, t);
    if (ns_sparse_predict_step(m, t, from, to))
        return ns_sparse_chatter_event(m, from, t);
    int status = ns_sparse_event_resolve(m, from, t);
    if (status == NS_OK) {
        ns_sparse_predict_learn(m, from);
        status = ns_sparse_chatter_event(m, from, t);
    }
    if (is_refusal(status)) {
        leave_step(m, from);
        ns_sparse_instant_restore(m);
        ns_sparse_guard_set_mode(m, m->commanded_mode);
    }
    if (status != NS_OK || ns_sparse_predict_take(m, t, to))
        return status;
    return ns_sparse_next_step(m, t, from, to);
}

/* The same; where events crowd, the transient that makes them is passed. */
static int step_from_event(ns_sparse *m, double t, const ns_dense_step *from, ns_dense_step *to) {
    const long jumps = m->counts.jumps;
    const int status = step_after_event(m, t, from, to);
    if (status != NS_OK || m->counts.jumps != jumps ||
        !(ns_sparse_transient_is_due(m, to) || ns_sparse_transient_is_left(m, to)))
        return status;
    leave_step(m, from);
    ns_sparse_guard_set_mode(m, m->commanded_mode);
    (void)ns_sparse_transient_pass(m, t, from, to);
    return NS_OK;
}

/* The same where there is no event. */
static int step_on(ns_sparse *m, double t, const ns_dense_step *from, ns_dense_step *to) {
    const int status = ns_sparse_next_step(m, t, from, to);
    if (status != NS_OK || !ns_sparse_transient_is_left(m, to))
        return status;
    leave_step(m, from);
    (void)ns_sparse_transient_pass(m, t, from, to);
    return NS_OK;
}

/* Names the switches that time or the state changed at the end of a step. */
static void name_commands(ns_sparse *m, const ns_dense_step *step) {
    for (int c = 0; c < m->s->nc && m->fault.npairs < NS_FAULT_MAX; c++) {
        const int pair = m->s->command[c].pair;
        if (m->commanded_mode[pair] != step->mode[pair])
            m->fault.pair[m->fault.npairs++] = pair;
    }
}

/* No step after this one: names what changed at its end, where the error (status) has not named pairs. */
static int name_fault(ns_sparse *m, const ns_dense_step *step, int status) {
    const int pair = m->contradicting_pair >= 0 ? m->contradicting_pair
                     : step->pair >= 0          ? step->pair
                     : step->command >= 0       ? m->s->command[step->command].pair
                                                : -1;
    if (status != NS_E_LIMIT && (status != NS_E_INFEASIBLE || m->fault.npairs > 0))
        return status;
    m->fault.npairs = pair >= 0;
    if (pair >= 0)
        m->fault.pair[0] = pair;
    else if (step->at_event)
        name_commands(m, step);
    return status;
}

/* Of two refusals the one that says most: that there is no solution. */
static int worst_of(int first, int second) {
    return first == NS_E_INFEASIBLE ? first : second;
}

/* Between events at one instant nothing is shown. */
static int takes_time(const ns_dense_step *step) {
    return step->end_t > step->t;
}

/* The step after that of the trial. */
static int step_of_high_order(ns_sparse *m) {
    ns_dense_step *from = m->trial.step, *to = unused_step(m);
    const double t = from->end_t;
    int status;
    if (m->steps_left-- <= 0)
        return name_fault(m, from, NS_E_LIMIT);
    if (from->at_event && takes_time(from) && (status = ns_sparse_watch_show(m, NS_WATCH_LEFT)) != NS_OK)
        return status;
    leave_step(m, from);
    m->contradicting_pair = -1;
    if (from->is_euler) {
        memcpy(m->z, from->z, sizeof(double) * (size_t)m->f->nz);
        (void)ns_sparse_guard_commands(m, from->images, NULL, NULL);
    }
    if (m->in->first ==
        -INFINITY) { /* a trial was dropped: the instants of commands are not known any more */
        const double known = fmax(from->t, m->inputs_from);
        ns_inputs_stages_at(m->in, known);
        ns_inputs_stages_find_command(m->in, known, m->o.h, from->mode);
    }
    status = from->at_event ? step_from_event(m, t, from, to) : step_on(m, t, from, to);
    const int refused = status;
    if (is_refusal(refused) && m->contradicting_pair < 0)
        status = ns_sparse_next_captured(m, t, from, to);
    if (status != NS_OK)
        return name_fault(m, from, status == NS_E_MEMORY ? status : worst_of(refused, status));
    const int is_event = from->at_event; /* the next step may take the place of this one */
    enter_step(m, to, t);
    return is_event && (takes_time(to) || !to->at_event) ? ns_sparse_watch_show(m, NS_WATCH_RIGHT) : NS_OK;
}

/* The same by steps of the theta scheme. */
static int step_of_scheme(ns_sparse *m) {
    ns_dense_step *from = m->trial.step, *other = from == m->steps ? m->steps + 1 : m->steps;
    ns_dense_step *to = from == m->accepted.step ? other : from;
    const double t = from->end_t;
    if (!m->theta.running || m->theta.t != t)
        leave_step(m, from);
    const int status = ns_sparse_theta_go(m, t, m->until == NS_TO_STEP ? t : m->asked_t, to);
    if (status == NS_OK)
        enter_step(m, to, t);
    return status;
}

/* To the right side of the event here, and of those that follow at the same time. */
static int pass_events(ns_sparse *m) {
    const double t = m->trial.t;
    int status = NS_OK;
    do
        status = ns_engine_is_over(&m->engine) ? NS_E_LIMIT : step_of_high_order(m);
    while (status == NS_OK && m->trial.t == t && is_at_event(m));
    return status;
}

static int move_until(ns_sparse *m, double t, ns_until until) {
    const double from = m->trial.t;
    m->steps_left = FEWEST_STEPS + (long)fmin(1e12, STEPS_A_LENGTH * (t - from) / m->o.h);
    if (until != NS_TO_TIME && is_at_event(m))
        return pass_events(m);
    while (m->trial.t < t && !(until == NS_TO_STEP && m->trial.t > from)) {
        if (ns_engine_is_over(&m->engine))
            return NS_E_LIMIT;
        if (m->trial.t < m->trial.step->end_t) {
            move_to(m, t);
        } else {
            const int status = m->o.theta > 0 ? step_of_scheme(m) : step_of_high_order(m);
            if (status != NS_OK)
                return status;
        }
        if (until != NS_TO_TIME && is_at_event(m))
            return m->trial.t > from ? NS_OK : pass_events(m);
    }
    return NS_OK;
}

void ns_sparse_drop(ns_engine *e) {
    ns_sparse *m = ns_sparse_of(e);
    if (m->trial.step != m->accepted.step || m->trial.t != m->accepted.t) {
        ns_inputs_stages_reset(m->in);
        ns_sparse_theta_stop(m);
    }
    m->trial = m->accepted;
    m->has_trial = 0;
    ns_instant_clear(&m->instant);
    ns_sparse_chatter_drop(m);
}

int ns_sparse_set_input(ns_engine *e, int input, const ns_signal *signal) {
    ns_sparse *m = ns_sparse_of(e);
    (void)input;
    (void)signal;
    ns_sparse_drop(e);
    const int status = m->o.theta > 0 ? NS_E_STATE : ns_inputs_stages_renew(m->in, input);
    if (status != NS_OK)
        return ns_sparse_fail(m, m->accepted.t, status);
    ns_dense_step *step = m->accepted.step;
    if (m->accepted.t < step->end_t) { /* what comes after it was with the input before */
        step->end_t = m->accepted.t;
        step->length = m->accepted.tau;
        step->at_event = 0;
    }
    m->inputs_from = step->end_t;
    ns_inputs_stages_reset(m->in);
    ns_inputs_stages_find_command(m->in, step->end_t, m->o.h, step->mode);
    if (!step->at_event && ns_sparse_event_at(m, step->end_t)) {
        step->at_event = 1;
        step->pair = step->command = -1;
    }
    ns_inputs_stages_reset(m->in);
    ns_sparse_theta_stop(m);
    return NS_OK;
}

int ns_sparse_try(ns_engine *e, double t, ns_until until, double *reached) {
    ns_sparse *m = ns_sparse_of(e);
    if (!m->started)
        return ns_sparse_fail(m, t, NS_E_STATE);
    if (!(t > m->accepted.t) || !isfinite(t))
        return ns_sparse_fail(m, t, NS_E_RANGE);
    const int same = until == m->until;
    if (!(m->has_trial &&
          ((t == m->trial.t && (same || until != NS_TO_STEP)) || (t == m->asked_t && same)))) {
        ns_sparse_drop(e);
        m->asked_t = t;
        m->until = until;
        const int status = move_until(m, t, until);
        if (status != NS_OK) {
            const double at = m->trial.t;
            ns_sparse_drop(e);
            return ns_sparse_fail(m, at, status);
        }
        m->has_trial = 1;
    }
    *reached = m->trial.t;
    return NS_OK;
}

int ns_sparse_accept(ns_engine *e) {
    ns_sparse *m = ns_sparse_of(e);
    if (!m->has_trial)
        return NS_E_STATE;
    m->accepted = m->trial;
    m->engine.way_from = m->trial.t;
    m->has_trial = 0;
    if (m->trial.t > m->finest_until)
        m->o.finer = m->usual_finer;
    ns_sparse_chatter_accept(m);
    return NS_OK;
}
