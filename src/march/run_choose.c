/* src/march/run_choose.c - the engine that costs less is at work (choice.h); one that fails leaves to the
 * other.
 */
#include "run_internal.h"

#include <math.h>

static ns_run_kind other_kind(const ns_run *r) {
    return r->kind == NS_RUN_DENSE ? NS_RUN_SPARSE : NS_RUN_DENSE;
}

void ns_march_run_begin_choice(ns_run *r, double t) {
    ns_march_choice_begin(&r->choice, t, ns_march_run_work(r), ns_march_first_question(r->s, r->is_dense));
}

/* A start that takes more than all that is done between two questions fails. */
static int change(ns_run *r) {
    r->may_spend = r->choice.interval;
    const int status = ns_march_run_leave_for(r, other_kind(r), 1);
    r->may_spend = r->at_work->most_work = 0;
    if (status == NS_OK && r->kind == NS_RUN_DENSE)
        ns_march_dense_let_hand_over(r->at_work, NS_HANDS_OVER_OFTEN);
    return status;
}

static void change_at(ns_run *r, double now) {
    const double before = ns_march_run_work(r).all;
    const int status = change(r);
    const ns_work work = ns_march_run_work(r);
    if (status == NS_OK) {
        ns_march_choice_began(&r->choice, work.all - before);
        ns_march_choice_changed(&r->choice, now, work);
    } else if (r->choice.asks)
        ns_march_choice_stuck(&r->choice, work, work.all - before);
    else
        ns_march_choice_failed(&r->choice, now, work);
}

static int may_choose(ns_run *r, double *now) {
    return r->chooses && !(r->back_at < INFINITY) && r->kind != NS_RUN_SCHEME && ns_march_run_rests(r, now);
}

/* An engine that is asked ends with LIMIT if it needs too much; the one at work, if a trial through all
 * events needs far more than all between two: the other one is asked for the same trial.  (One that
 * comes back to work within a trial: ns_march_run_put_to_work().) */
static void bound_work(ns_run *r, ns_until until) {
    ns_engine *e = r->at_work;
    double now, most = 0;
    if (ns_march_choice_limit(&r->choice) < INFINITY)
        most = ns_engine_work(e).all + ns_march_choice_limit(&r->choice) - ns_march_run_work(r).all;
    else if (!r->choice.asks && until == NS_TO_TIME && may_choose(r, &now))
        most = ns_engine_work(e).all + ns_march_choice_trial(&r->choice);
    e->most_work = most;
    e->pause_work = r->chooses && until == NS_TO_STEP && ns_march_choice_pause(&r->choice) > 0
                        ? ns_engine_work(e).all + ns_march_choice_pause(&r->choice)
                        : 0;
}

/* Short trials are many.  An odd number: where every second one begins at an event, none of these would be
 * looked at. */
static int is_to_look(ns_run *r, ns_until until) {
    enum { EVERY = 3 };
    return until == NS_TO_TIME || r->choice.asks || ++r->trials % EVERY == 0;
}

static void look_at_choice(ns_run *r, double now) {
    const ns_choice_answer answer = ns_march_choice_look(
        &r->choice, now, ns_march_run_work(r), ns_march_bounds_of_event(r->s, r->kind == NS_RUN_DENSE));
    if (answer == NS_CHOICE_CHANGE)
        change_at(r, now);
}

void ns_march_run_choose(ns_run *r, ns_until until) {
    double now;
    if (r->chooses && is_to_look(r, until) && may_choose(r, &now))
        look_at_choice(r, now);
    bound_work(r, until);
}

void ns_march_run_was_wrong(ns_run *r, double t, ns_run_kind was, double stay) {
    if (!r->choice.asks) {
        ns_march_run_leave_for_now(r, t, was, stay);
        if (r->kind == NS_RUN_DENSE && r->chooses) /* farther on the other one is as good as it was */
            ns_march_dense_let_hand_over(r->at_work, NS_HANDS_OVER_OFTEN);
        return;
    }
    ns_march_choice_failed(&r->choice, t, ns_march_run_work(r));
    if (r->kind == NS_RUN_SCHEME)
        ns_march_run_leave_for_now(r, t, was == NS_RUN_DENSE ? NS_RUN_SPARSE : NS_RUN_DENSE, stay);
}

/* The other one goes on from the accepted point, and this one is not asked soon.  At the left side of an
 * event its start may be all that the trial asks for: *reached. */
static int fail_and_change(ns_run *r, ns_until until, double *reached) {
    const int ends = ns_engine_at_event(r->at_work) && until != NS_TO_TIME,
              is_over = ns_engine_is_over(r->at_work);
    double now, begun;
    if (ns_engine_read(r->at_work, &now, NULL, NULL, NULL) != NS_OK || change(r) != NS_OK)
        return 0;
    r->back_at = r->kind == r->back_to ? INFINITY : r->back_at;
    if (r->chooses && is_over && r->choice.asks)
        ns_march_choice_changed(&r->choice, now, ns_march_run_work(r));
    else if (r->chooses)
        ns_march_choice_failed(&r->choice, now, ns_march_run_work(r));
    else
        ns_march_run_leave_for_now(r, now, NS_RUN_DENSE, INFINITY);
    bound_work(r, until);
    r->trial_is_start = ends && ns_engine_read(r->at_work, &begun, NULL, NULL, NULL) == NS_OK && begun == now;
    if (r->trial_is_start)
        *reached = now;
    else if (r->is_dense)
        ns_march_dense_carry_start(r->at_work);
    return 1;
}

/* The trial to t took too much: by the other one, with the same bound, or on without one. */
static void ask_in_trial(ns_run *r, double t) {
    double now;
    if (!may_choose(r, &now)) {
        r->at_work->most_work = 0;
        return;
    }
    ns_march_choice_cut_off(&r->choice, now, t);
    change_at(r, now);
    bound_work(r, NS_TO_TIME);
}

/* The one that is asked took too much, and the other one cannot begin here. */
static int goes_on_unbounded(ns_run *r) {
    r->at_work->most_work = 0;
    ns_march_choice_stuck(&r->choice, ns_march_run_work(r), 0);
    return 1;
}

int ns_march_run_hand_over(ns_run *r, double t, ns_until until, double *reached, int *status) {
    if (*status == NS_E_LIMIT && !r->choice.asks && ns_engine_is_over(r->at_work)) {
        ask_in_trial(r, t);
        return 1;
    }
    if (r->chooses && r->choice.asks && *status != NS_E_MEMORY) {
        const int is_over = ns_engine_is_over(r->at_work);
        if (fail_and_change(r, until, reached) || (is_over && goes_on_unbounded(r)))
            return 1;
    }
    if (ns_march_run_sparse_failed(r, *status)) {
        *status = ns_march_run_leave_sparse(r);
        return *status == NS_OK;
    }
    if (r->kind != NS_RUN_DENSE)
        return 0;
    if (!ns_march_dense_hands_over(r->at_work)) /* not if sparse failed a short while ago */
        return r->back_at == INFINITY && ns_march_leaves_dense(&r->options, *status) &&
               fail_and_change(r, until, reached);
    if (!fail_and_change(r, until, reached))
        ns_march_dense_let_hand_over(r->at_work, NS_HANDS_OVER_NEVER);
    return 1;
}
