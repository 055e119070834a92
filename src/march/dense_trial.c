/* src/march/dense_trial.c - the trial of the dense engines: failed, dropped, accepted. */
#include "dense_internal.h"

#include <math.h>
#include <string.h>

int ns_march_dense_fail(ns_dense_run *r, int status) {
    const ns_fault *from = ns_theta_fault(r->step);
    const int pair = r->ladder ? ns_ladder_contradiction(r->ladder) : -1;
    r->fault = *from;
    if (status != (int)from->status)
        r->fault.npairs = r->fault.nunknowns = 0;
    if (status == NS_E_LIMIT && pair >= 0) {
        r->fault.npairs = 1;
        r->fault.pair[0] = pair;
    }
    r->fault.status = (ns_status)status;
    r->fault.t = r->trial.now.t;
    return status;
}

void ns_march_dense_clear_instant(ns_dense_run *r) {
    ns_instant_clear(&r->instant);
    r->carries = r->carries == 1;
}

void ns_march_dense_bound_search(ns_dense_run *r, double most) {
    if (r->engine.most_work > 0)
        most = fmax(0, fmin(most, r->engine.most_work - ns_engine_work(&r->engine).all));
    ns_theta_bound_search(r->step, most);
}

static void copy_point(ns_dense_point *to, const ns_dense_point *from, size_t nc) {
    unsigned char *flip = to->flip;
    memcpy(flip, from->flip, nc);
    *to = *from;
    to->flip = flip;
}

void ns_march_dense_drop(ns_dense_run *r) {
    if (r->moved) {
        ns_theta_restore(r->step, r->past);
        copy_point(&r->trial, &r->accepted, (size_t)r->s->nc);
        ns_ladder_drop(r->ladder);
        if (r->exact)
            ns_exact_drop(r->exact);
    }
    r->moved = r->has_trial = 0;
}

int ns_march_dense_accept(ns_dense_run *r) {
    if (!r->has_trial)
        return NS_E_STATE;
    r->engine.way_from = r->trial.now.t;
    ns_theta_save(r->step, r->past);
    copy_point(&r->accepted, &r->trial, (size_t)r->s->nc);
    ns_ladder_accept(r->ladder);
    if (r->exact)
        ns_exact_accept(r->exact);
    r->carries *= 2;
    r->moved = r->has_trial = 0;
    return NS_OK;
}
