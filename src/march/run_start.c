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

static int start_by(ns_run *r, ns_run_kind kind, const ns_run_start *s) {
    ns_engine *was = r->at_work, *other;
    const ns_run_kind was_kind = r->kind;
    if (ns_march_run_make(r, kind, &other) != NS_OK)
        return 0;
    ns_march_run_put_to_work(r, other, kind);
    if (start_judged(r, s) == NS_OK) {
        ns_march_run_dismiss(r, was);
        return 1;
    }
    ns_march_run_put_to_work(r, was, was_kind);
    other->table->free(other);
    return 0;
}

/* A start that was found wrong; a small error that no engine is without is that of the problem. */
static int start_again(ns_run *r, const ns_run_start *s) {
    const ns_verify_finding first = r->check.finding;
    const ns_run_kind own = r->kind;
    r->check.retries++;
    for (int kind = NS_RUN_DENSE; kind <= NS_RUN_SCHEME; kind++)
        if (kind != (int)own && start_by(r, (ns_run_kind)kind, s)) {
            ns_march_run_leave_for_the_start(r, s->t, own);
            return NS_OK;
        }
    if (ns_march_run_allows(r, &first) && start_judged(r, s) == NS_OK)
        return NS_OK;
    return ns_march_run_refuse(r, &first);
}

int ns_march_run_start(ns_run *r, const ns_run_start *asked) {
    ns_run_start s = *asked;
    s.x = s.x ? s.x : r->check.nodes;
    r->refused = r->trial_is_start = 0;
    ns_march_check_reset(r);
    int status = start_judged(r, &s);
    if (!r->check.found && ns_march_run_sparse_failed(r, status) &&
        (status = ns_march_run_use_dense(r, s.t)) == NS_OK)
        status = start_judged(r, &s);
    if (r->check.found)
        status =
            ns_march_sliding_is_cause(r) ? ns_march_run_refuse(r, &r->check.finding) : start_again(r, &s);
    r->check.found = 0;
    return status;
}
