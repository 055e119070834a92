/* src/verify/flow.c - between events: charges and fluxes are the integral of what charges them.
 *
 * Lobatto's rule of five points, exact for polynomials of degree 7; its error is estimated by what
 * Simpson's rule, of three of them, differs from it.
 */
#include "verify_internal.h"

#include <math.h>
#include <string.h>

/* Abramowitz and Stegun, 25.4.32, on [-1, 1]: sqrt(3/7). */
static const double inner = 0.65465367070797714;
static const double lobatto[NS_VERIFY_NODES] = {0.1, 49.0 / 90, 32.0 / 45, 49.0 / 90, 0.1};
static const double simpson[NS_VERIFY_NODES] = {1.0 / 3, 0, 4.0 / 3, 0, 1.0 / 3};

/* What integrals may be off by, of the terms that are integrated. */
static const double of_terms = 1e-8;

void ns_verify_flow_times(double a, double b, double *t) {
    const double middle = (a + b) / 2, half = (b - a) / 2;
    t[0] = a;
    t[1] = middle - half * inner;
    t[2] = middle;
    t[3] = middle + half * inner;
    t[4] = b;
}

/* Row i over the time from the first node to the last, 2 half; *off: what that may be off by. */
static double integral(const ns_verify *v, int i, double half, double *off) {
    const size_t all = ns_verify_columns(v->s);
    double sum = 0, other = 0, size = 0;
    for (int k = 0; k < NS_VERIFY_NODES; k++) {
        const ns_verify_sum s = ns_verify_row(&v->law, i, v->v + (size_t)k * all);
        sum += lobatto[k] * s.sum;
        other += simpson[k] * s.sum;
        size += lobatto[k] * s.size;
    }
    const double rounding = of_terms * size + 2 * ns_verify_sizes_leak(v, &v->law, i);
    *off = half * (fabs(sum - other) + v->times * v->times_row[i] * rounding);
    return half * sum;
}

static void judge_row(ns_verify *v, int i, double half, ns_verify_finding *worst) {
    const size_t all = ns_verify_columns(v->s);
    const ns_verify_sum from = ns_verify_row(&v->charge, i, v->v),
                        to = ns_verify_row(&v->charge, i, v->v + (NS_VERIFY_NODES - 1) * all);
    double off;
    const double charged = integral(v, i, half, &off), rest = fabs(to.sum - from.sum - charged);
    ns_verify_sizes_charge(v, i, ns_verify_larger(from.size, to.size));
    off += ns_verify_sizes_charge_off(v, i);
    if (!(rest <= off))
        ns_verify_note(worst, NS_VERIFY_FLOW, -1, i, rest / off);
}

int ns_verify_flow(ns_verify *v, const double *t, const double *xl, ns_verify_finding *worst) {
    const size_t n = (size_t)v->s->n, m = (size_t)v->s->m, all = ns_verify_columns(v->s);
    for (size_t k = 0; k < NS_VERIFY_NODES; k++) {
        const double *x = xl + k * (n + m);
        const ns_verify_state at = {t[k], k == 0 ? NS_RIGHT : NS_LEFT, x, x + n, NULL, 0};
        if (!ns_verify_point(v, &at, worst))
            return 0;
        memcpy(v->v + k * all, v->u, sizeof *v->u * all);
    }
    *worst = ns_verify_nothing(t[NS_VERIFY_NODES - 1]);
    for (int k = 0; k < v->storeds; k++)
        judge_row(v, v->stored[k], (t[NS_VERIFY_NODES - 1] - t[0]) / 2, worst);
    return ns_verify_sizes_end(v, worst);
}

/* --- at rest --- */

/* 1 if no source moves right after the point: else currents of capacitors do not vanish there. */
static int inputs_rest(const ns_verify *v) {
    int rest = 1;
    for (int k = 0; k < v->s->nz; k++) {
        const ns_signal *s = &v->s->z[k];
        rest &= ns_signal_value(s, v->t, NS_RIGHT) == ns_signal_value(s, v->t + v->o.instant, NS_LEFT);
    }
    return rest;
}

/* 1 if a switch depends on the state: a comparator that oscillates has no operating point. */
static int any_control_by_state(const ns_verify *v) {
    int any = 0;
    for (int k = 0; k < v->control.start[v->s->nc]; k++)
        any |= v->control.column[k] < v->s->n + v->s->m;
    return any;
}

static void judge_rest(ns_verify *v, ns_verify_finding *worst) {
    for (int k = 0; k < v->storeds; k++) {
        const int i = v->stored[k];
        const ns_verify_sum s = ns_verify_row(&v->law, i, v->u);
        ns_verify_grow(v, &v->most_law[i], s.size);
        const double off = ns_verify_sizes_law_off(v, i) + ns_verify_sizes_leak(v, &v->law, i);
        if (!(fabs(s.sum) <= off))
            ns_verify_note(worst, NS_VERIFY_FLOW, -1, i, fabs(s.sum) / off);
    }
}

int ns_verify_operating_point(ns_verify *v, const double *x, int nhold, const int *hold, const double *hold_x,
                              ns_verify_finding *worst) {
    *worst = ns_verify_nothing(v->t);
    for (int k = 0; k < nhold; k++) {
        const double off = ns_verify_sizes_held_off(v, hold_x[k]), differs = fabs(x[hold[k]] - hold_x[k]);
        if (!(differs <= off))
            ns_verify_note(worst, NS_VERIFY_ROW, -1, hold[k], differs / off);
    }
    if (nhold == 0 && inputs_rest(v) && !any_control_by_state(v))
        judge_rest(v, worst);
    return ns_verify_sizes_end(v, worst);
}
