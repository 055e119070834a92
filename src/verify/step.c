/* src/verify/step.c - one step of a scheme of first or second order, which is no integral to any number of
 * digits.
 *
 * With theta from 0 to 1 a step charges by h times a mean of what flows at its ends.  So by how much it errs
 * is at most h times what that changes by, and is known from its ends alone.
 */
#include "verify_internal.h"

#include <math.h>

/* What integrals may be off by, of the terms that are integrated. */
static const double of_terms = 1e-8;

/* What flows of row i at both ends: the least, the most, the largest terms. */
typedef struct flow {
    double least, most, size;
} flow;

static flow flow_of(const ns_verify *v, int i) {
    const ns_verify_sum a = ns_verify_row(&v->law, i, v->u_left), b = ns_verify_row(&v->law, i, v->u);
    return (flow){fmin(a.sum, b.sum), fmax(a.sum, b.sum), ns_verify_larger(a.size, b.size)};
}

/* Steps that end at an event are several, so half of what flows may change by is added at either end. */
static void judge_row(ns_verify *v, int i, double h, ns_verify_finding *worst) {
    const ns_verify_sum from = ns_verify_row(&v->charge, i, v->u_left),
                        to = ns_verify_row(&v->charge, i, v->u);
    const flow f = flow_of(v, i);
    const double more = (f.most - f.least) / 2, charged = to.sum - from.sum;
    const double rest = fmax(charged - h * (f.most + more), h * (f.least - more) - charged);
    ns_verify_sizes_charge(v, i, ns_verify_larger(from.size, to.size));
    const double rounding = v->times_row[i] * of_terms * f.size + ns_verify_sizes_leak(v, &v->law, i);
    const double off = ns_verify_sizes_charge_off(v, i) + h * rounding;
    if (!(rest <= off))
        ns_verify_note(worst, NS_VERIFY_FLOW, -1, i, rest / off);
}

int ns_verify_step(ns_verify *v, const ns_verify_state *from, const ns_verify_state *to,
                   ns_verify_finding *worst) {
    const double times = v->times;
    ns_verify_fill(v, from);
    ns_verify_left(v);
    ns_verify_fill(v, to);
    *worst = ns_verify_nothing(to->t);
    v->times = 1; /* what the scheme errs by is known */
    for (int k = 0; k < v->storeds; k++)
        judge_row(v, v->stored[k], to->t - from->t, worst);
    ns_verify_energy_over(v, to->t - from->t, worst);
    v->times = times;
    return ns_verify_sizes_end(v, worst);
}
