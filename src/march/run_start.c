/* src/march/run_start.c - a start by the engine at work, or where that is judged wrong by the other engines.
 */
#include "run_internal.h"

/* Errors: RESIDUAL (it is wrong), those of the engine. */
static int start_judged(ns_run *r, const ns_run_start *s) {
    const ns_engine_table *by = r->at_work->table;
    r->check.found = 0;
    const int status = s->is_dc ? by->start_dc(r->at_work, s->t, s->nhold, s->hold, s->hold_x, s->x)
                                : by->start(r->at_work, s->t, s->w, s->closed);
    return status != NS_OK || ns_march_check_start(r, s) ? status : NS_E_RESIDUAL;
}

static int begin(ns_run *r, const void *data) {
    return start_judged(r, data);
}

static int is_judged_right(ns_run *r, const void *data) {
    return start_judged(r, data) == NS_OK;
}

/* Signs that are wrong for a moment are excused. */
static int start_excused(ns_run *r, const ns_run_start *s) {
    return is_judged_right(r, s) || (r->check.found && ns_march_run_goes_excused(r, is_judged_right, s));
}

static int begin_excused(ns_run *r, const void *data) {
    return start_excused(r, data) ? NS_OK : NS_E_RESIDUAL;
}

/* By an engine other than `own`. */
static int start_by_others(ns_run *r, ns_run_kind own, const ns_run_change *how) {
    for (int kind = NS_RUN_DENSE; kind <= NS_RUN_SCHEME; kind++)
        if (kind != (int)own && ns_march_run_change(r, (ns_run_kind)kind, how) == NS_OK)
            return 1;
    return 0;
}

/* After a start that was found wrong: the other engines start.  If none of them is right, signs that are
 * wrong for a moment are excused.  If the error was small, it is taken for rounding in the circuit's own
 * numbers: the first engine starts again, and this kind of error may be larger from then on. */
static int start_again(ns_run *r, const ns_run_start *s) {
    const ns_verify_finding first = r->check.finding;
    const ns_run_kind own = r->kind;
    const ns_run_change how = {begin, s, 0}, excused = {begin_excused, s, 0};
    r->check.retries++;
    int by_another = start_by_others(r, own, &how), right = by_another || start_excused(r, s);
    if (!right)
        right = by_another = start_by_others(r, own, &excused);
    if (by_another)
        ns_march_run_leave_for_the_start(r, s->t, own);
    right = right || (ns_march_run_allows(r, &first) && start_judged(r, s) == NS_OK);
    return right ? NS_OK : ns_march_run_refuse(r, &first);
}

/* Branch and bound in a start of auto may take as much work as the run does before its first question
 * (choice.h).  If that is not enough, sparse starts, which may find the mode at once; if sparse fails too,
 * the start is made again without a bound. */
static int start_bounded(ns_run *r, const ns_run_start *s) {
    const ns_run_change how = {begin, s, 0};
    if (!r->chooses || r->kind != NS_RUN_DENSE)
        return start_judged(r, s);
    r->at_work->most_work = ns_engine_work(r->at_work).all + ns_march_first_question(r->s, 1);
    const int status = start_judged(r, s);
    r->at_work->most_work = 0;
    if (status == NS_OK || r->check.found || !ns_march_dense_was_cut_off(r->at_work))
        return status;
    const int changed = ns_march_run_change(r, NS_RUN_SPARSE, &how) == NS_OK;
    r->check.found = 0;
    return changed ? NS_OK : start_judged(r, s);
}

/* If method "sparse" was asked for and its start is singular (capacitors alone connect a part to the rest, so
 * that the part's voltage is not determined), the dense engines start.  Else, or if they fail: status. */
static int start_by_dense(ns_run *r, const ns_run_start *s, int status) {
    const ns_run_change how = {begin, s, 0};
    if (status != NS_E_SINGULAR || r->kind != NS_RUN_SPARSE || ns_march_too_large(r->s))
        return status;
    const int changed = ns_march_run_change(r, NS_RUN_DENSE, &how) == NS_OK;
    r->check.found = 0;
    if (!changed)
        return status;
    ns_march_run_leave_for_the_start(r, s->t, NS_RUN_SPARSE);
    return NS_OK;
}

int ns_march_run_start(ns_run *r, const ns_run_start *asked) {
    ns_run_start s = *asked;
    s.x = s.x ? s.x : r->check.nodes;
    r->refused = r->trial_is_start = 0;
    r->at_work->way_from = s.t;
    ns_march_check_reset(r);
    int status = start_bounded(r, &s);
    if (!r->check.found && ns_march_run_sparse_failed(r, status) &&
        (status = ns_march_run_use_dense(r, s.t)) == NS_OK)
        status = start_judged(r, &s);
    if (!r->check.found)
        status = start_by_dense(r, &s, status);
    if (r->check.found)
        status =
            ns_march_sliding_is_cause(r) ? ns_march_run_refuse(r, &r->check.finding) : start_again(r, &s);
    r->check.found = 0;
    if (status == NS_OK)
        ns_march_run_begin_choice(r, s.t);
    return status;
}
