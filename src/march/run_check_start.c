/* src/march/run_check_start.c - a start is judged as an event is: from the charges and fluxes that it is
 * given to its first point. */
#include "run_internal.h"

static int start_is_right(ns_run *r, double t, const double *w) {
    ns_run_check *k = &r->check;
    const size_t n = (size_t)r->s->n;
    double now;
    k->found = 0;
    if (ns_engine_read(r->at_work, &now, k->here, k->here + n, k->y) != NS_OK ||
        ns_engine_impulse(r->at_work, k->impulse, k->impulse + n) != NS_OK)
        return 1; /* it says so when it is asked */
    ns_verify_left_charges(k->verify, t, w);
    return ns_march_check_shown(r, now, NS_RIGHT, k->y) && ns_march_check_event(r);
}

static int operating_point_is_right(ns_run *r, const ns_run_start *s) {
    ns_run_check *k = &r->check;
    ns_system_charges(r->s, s->x, k->before);
    if (start_is_right(r, s->t, k->before))
        k->found = !ns_verify_operating_point(k->verify, s->x, s->nhold, s->hold, s->hold_x, &k->finding);
    return !k->found;
}

int ns_march_check_start(ns_run *r, const ns_run_start *s) {
    ns_verify_start_switches(r->check.verify, s->t, s->closed);
    ns_march_check_scale_start(r);
    const int right = s->is_dc ? operating_point_is_right(r, s) : start_is_right(r, s->t, s->w);
    ns_march_check_scale(r);
    r->check.credit = 0; /* each start is judged, whatever that costs */
    return right;
}
