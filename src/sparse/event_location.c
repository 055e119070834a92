/* src/sparse/event_location.c - the first guard that breaks in a step, and when.
 *
 * In a step a guard is a polynomial (E1).  For most of them a bound by its coefficients shows that it holds;
 * of the others the first root is searched for (bernstein_root.h).
 */
#include "events/ties.h"
#include "guards.h"
#include "linalg/simd.h"
#include "modes/bernstein_root.h"
#include "modes/multiple.h"
#include "step.h"

#include <math.h>
#include <string.h>

/* In the error of an instant, w moves by no more than this fraction of the error allowed. */
static const double instant_fraction = 0.1;
/* Guards may be below zero by this fraction of the error allowed, and of that of the row that tells most of
 * lambda.  If the first were larger, pairs below zero would gather and change together at the next event. */
static const double below = 0.1, below_in_row = 1;
/* A guard below zero by less than this fraction of the largest unknown: perhaps by rounding. */
static const double shallow = 1e-7;
/* A threshold is met where the control is so many of its roundings from it. */
static const double met = 16;
/* Another threshold is where this one is if it is so many of them from it. */
static const double beside = 1e4;
/* The end of a step is no farther from its event than this fraction of the step. */
static const double furthest_off = 1e-6;
/* A transient that dies far within the step has coefficients 1, -1, 1, ...; (E1) turns it into values down
 * to -2.69, the least sum of eight or nine of Laguerre's polynomials. */
static const double unresolved = 2.7;
/* At the start of a step the error of a guard may be this multiple of the estimate. */
static const double rise_cut = 4;

/* 1 if a bound by the coefficients of guard k of pair j shows that it holds. */
static int surely_holds(const ns_sparse *m, const ns_dense_step *step, int j, int k) {
    const size_t size = (size_t)m->f->size, nz = (size_t)m->f->nz,
                 stages = step->stages < NS_ORDER ? (size_t)step->stages : NS_ORDER;
    double least;
    if (m->mode[j] == NS_INSIDE) {
        const double *lambda = step->images + m->f->n + j;
        least = is_upper(m, j, k) ? m->u[j] - lambda[0] : lambda[0] - m->l[j];
        for (size_t i = 1; i < stages && least > 0; i++)
            least -= ns_modes_laguerre_max[i] * fabs(lambda[i * size]);
        return least > 0;
    }
    least = guard(m, j, k, step->images, step->z, 1);
    for (size_t i = 1; i < stages && least > 0; i++)
        least -=
            ns_modes_laguerre_max[i] * fabs(guard(m, j, k, step->images + i * size, step->z + i * nz, 0));
    return least > 0;
}

static double size_of(const ns_sparse *m, const ns_dense_step *step, int j) {
    return ns_sparse_guard_size(m, j, step->images, step->powers, step->g);
}

static void find_coefficients(const ns_sparse *m, const ns_dense_step *step, int terms, int pair, int k,
                              int command, double *G) {
    const size_t size = (size_t)m->f->size, nz = (size_t)m->f->nz;
    for (int i = 0; i < terms; i++) {
        const double *v = step->images + (size_t)i * size, *z = step->z + (size_t)i * nz;
        G[i] = pair >= 0 ? guard(m, pair, k, v, z, i == 0) : margin(m, command, v, z, i == 0);
    }
}

typedef struct found {
    double at; /* fraction of the step */
    int pair, k, command;
    double rounding;
    int perturbed; /* m->work.v is what rounding may do to unknowns of the step; -1: it could not be found */
} found;

/* The error of a guard: the next coefficient, estimated from the last two, times unresolved. */
static double cut_off(const double *G, int terms) {
    const double last = fabs(G[terms - 1]), before = fabs(G[terms - 2]);
    return unresolved * (last < before ? last * (last / before) : last);
}

/* At the start of a step a guard that is below zero by no more than its error there holds if it rises; right
 * after an event, by no more than events are located to, or are apart that are one: the fraction of a curve
 * at which it has risen to zero; NAN: it does not. */
static double find_rise(const ns_sparse *m, const ns_dense_step *step, const found *f, const ns_curve *c,
                        double cut) {
    const double terms = f->pair >= 0 ? size_of(m, step, f->pair)
                                      : ns_sparse_guard_control_terms(m, f->command, step->images, step->z);
    ns_curve below_zero = {.terms = c->terms};
    const double apart = f->pair >= 0 ? 0 : m->apart[f->command];
    const double located = step->after_event ? fmax(ns_sparse_guard_located(m, terms), apart) : 0;
    if (!(ns_modes_curve_slope(c, 0) > 0) || !(c->p[0] >= -(rise_cut * cut + located)))
        return NAN;
    for (int k = 0; k < c->terms; k++)
        below_zero.p[k] = -c->p[k];
    return ns_modes_curve_below(&below_zero, 0);
}

/* The fraction of a curve at which a guard breaks by more than tol; NAN: it does not. */
static double find_fall(const ns_sparse *m, const ns_dense_step *step, const found *f, const ns_curve *c,
                        double cut, double tol) {
    const double at = ns_modes_curve_below(c, tol), from = at == 0 ? find_rise(m, step, f, c, cut) : NAN;
    ns_curve rest;
    if (isnan(from))
        return at;
    ns_modes_curve_rest(c, from, &rest);
    return from + (1 - from) * ns_modes_curve_below(&rest, tol);
}

/* By how much pair j may be.  A voltage drives a current through the resistance of a pair that closes, which
 * may be off by no more than others: in a chain of pairs about to close those below zero by more would
 * gather, and open each other without end. */
static double may_be_below(const ns_sparse *m, const ns_dense_step *step, int j) {
    const double ron = m->mode[j] == NS_INSIDE ? 0 : ns_sparse_form_resistance(m->f, j),
                 size = size_of(m, step, j),
                 all = below * (ron > 0 ? ns_lower(size, ron * m->largest.lambda) : size);
    return m->o.reltol *
           (m->mode[j] == NS_INSIDE
                ? ns_lower(all, below_in_row * ns_sparse_guard_least_terms(m, j, step->images, step->g))
                : all);
}

/* The fraction of the step, up to the fraction `before`, at which a guard breaks by the coefficients known;
 * NAN: it does not. */
static double find_break(const ns_sparse *m, const ns_dense_step *step, int terms, const found *f,
                         double before, ns_curve *c) {
    double G[NS_STAGES] = {0};
    ns_curve part;
    find_coefficients(m, step, terms, f->pair, f->k, f->command, G);
    ns_modes_curve_of(terms, G, step->length / step->g, c);
    before = before < 1 ? before : 1;
    ns_modes_curve_cut(c, before, &part);
    const double cut = cut_off(G, terms);
    double tol = cut;
    if (ns_modes_curve_holds(&part, tol))
        return NAN;
    tol += f->pair >= 0 ? may_be_below(m, step, f->pair) : 0;
    if (ns_modes_curve_holds(&part, tol))
        return NAN;
    return before *
           find_fall(
               m, step, f, &part, cut,
               tol + f->rounding +
                   (f->pair >= 0
                        ? ns_sparse_guard_least_rounding(m, f->pair, step->images, step->powers, step->g)
                        : ns_sparse_guard_control_rounding(m, f->command, step->images, step->z)));
}

/* A guard that is below zero by so little, beside the largest unknown, may be so by the rounding of other
 * terms than its own: how much that is. */
static void find_rounding(ns_sparse *m, const ns_dense_step *step, const ns_curve *c, found *next, found *f) {
    double largest = 0;
    for (int i = 0; i < m->f->size; i++)
        largest = ns_higher(largest, fabs(step->images[i]));
    if (next->pair < 0)
        return;
    const double rounding = ns_sparse_guard_rounding(m, next->pair, step->images, step->powers, step->g);
    if (!ns_modes_curve_holds(c, ns_higher(shallow * largest, rounding)))
        return;
    if (!f->perturbed)
        f->perturbed = ns_sparse_guard_perturb(m, step->images, step->powers, step->g, 0) == NS_OK &&
                               ns_sparse_step_residue(m, step, m->work.v) == NS_OK
                           ? 1
                           : -1;
    memset(m->work.no_inputs, 0, sizeof(double) * (size_t)m->f->nz);
    if (f->perturbed > 0)
        next->rounding = 16 * fabs(guard(m, next->pair, next->k, m->work.v, m->work.no_inputs, 0));
}

/* The error of the instant, in lengths of the step, as later stages are missing. */
static double instant_error(const ns_sparse *m, const ns_dense_step *step, const found *f,
                            const ns_curve *c) {
    double G[NS_STAGES] = {0};
    find_coefficients(m, step, step->stages, f->pair, f->k, f->command, G);
    return cut_off(G, step->stages) / fabs(ns_modes_curve_slope(c, f->at));
}

/* How far w moves in the step, relative to the largest so far. */
static double moves(const ns_sparse *m, const ns_dense_step *step) {
    double farthest = 0;
    for (int i = 0; i < m->f->n; i++)
        if (fabs(step->powers[m->f->n + i]) > farthest * m->largest.w[i])
            farthest = fabs(step->powers[m->f->n + i]) / m->largest.w[i];
    return farthest * step->length / step->g;
}

/* 1 if Euler steps have proved that the guard holds where the step begins, so that it may be below zero there
 * by its error alone: it breaks where it is below that. */
static int is_proved(const ns_dense_step *step, const found *f) {
    return step->unchanged > 0 && f->pair >= 0;
}

/* Searches for the root of one guard before the first one found so far: by the stages known, then by so many
 * more that the instant is as accurate as the step. */
static int search_guard(ns_sparse *m, ns_dense_step *step, found next, found *f) {
    ns_curve c;
    if (next.pair >= 0 && surely_holds(m, step, next.pair, next.k))
        return NS_OK;
    const int terms = step->stages < NS_ORDER ? step->stages : NS_ORDER;
    if (!(find_break(m, step, terms, &next, f->at, &c) < f->at))
        return NS_OK;
    find_rounding(m, step, &c, &next, f);
    if (next.rounding > 0 && !(find_break(m, step, terms, &next, f->at, &c) < f->at))
        return NS_OK;
    do {
        const int status = ns_sparse_step_more(m, step);
        if (status != NS_OK)
            return status;
        next.at = find_break(m, step, step->stages, &next, 1, &c);
        if (next.at > 0 && !(is_proved(step, &next) && c.p[0] < 0))
            next.at = ns_modes_curve_root(&c, next.at);
    } while (step->stages < NS_STAGES &&
             !(instant_error(m, step, &next, &c) * moves(m, step) <= instant_fraction * m->o.reltol));
    next.perturbed = f->perturbed;
    if (next.at < f->at)
        *f = next;
    return NS_OK;
}

/* Guard coefficients G as a curve over the step, and its value at the end. */
static double value_at_end(const ns_dense_step *step, const double *G, ns_curve *curve) {
    double at_end = 0;
    ns_modes_curve_of(step->stages, G, step->length / step->g, curve);
    for (int k = curve->terms - 1; k >= 0; k--)
        at_end += curve->p[k];
    return at_end;
}

/* How far the end of the step may be from the instant of its event, in lengths of the step: the event was
 * located before stages were added for other guards, with which its own is no longer zero there. */
static double instant_is_off(const ns_sparse *m, const ns_dense_step *step) {
    double G[NS_STAGES] = {0};
    ns_curve curve;
    if (step->pair < 0 && step->command < 0)
        return 0;
    find_coefficients(m, step, step->stages, step->pair, step->guard, step->command, G);
    const double at_end = value_at_end(step, G, &curve), slope = ns_modes_curve_slope(&curve, 1);
    return slope < 0 ? fmin(fabs(at_end / slope), furthest_off) : 0;
}

int ns_sparse_location_is_rough(const ns_sparse *m, const ns_dense_step *step) {
    double G[NS_STAGES] = {0};
    ns_curve curve;
    if (!step->at_event || step->pair < 0 || step->converged)
        return 0;
    find_coefficients(m, step, step->stages, step->pair, step->guard, step->command, G);
    return value_at_end(step, G, &curve) < -ns_sparse_guard_all_stages(m, step->pair);
}

int ns_sparse_location_meets(const ns_sparse *m, const ns_dense_step *step, int c, double *apart) {
    double G[NS_STAGES] = {0};
    ns_curve curve;
    *apart = 0;
    find_coefficients(m, step, step->stages, -1, 0, c, G);
    const double at_end = value_at_end(step, G, &curve), slope = ns_modes_curve_slope(&curve, 1),
                 late = ns_system_signal_time_error(step->end_t, step->end_t) / step->length +
                        instant_is_off(m, step);
    if (!(slope < 0) ||
        at_end > met * ns_sparse_guard_control_rounding(m, c, step->images, step->z) - slope * late)
        return 0;
    *apart = fmax(at_end, 0) - slope * late; /* inputs are known as well as the instant */
    return 1;
}

int ns_sparse_location_is_same(const ns_sparse *m, const ns_dense_step *step, int c, double *apart) {
    double a[NS_STAGES] = {0}, b[NS_STAGES] = {0};
    ns_curve curve;
    *apart = 0;
    if (step->command < 0)
        return 0;
    find_coefficients(m, step, step->stages, -1, 0, c, a);
    find_coefficients(m, step, step->stages, -1, 0, step->command, b);
    const double at_end = value_at_end(step, a, &curve),
                 rate = ns_modes_curve_slope(&curve, 1) / step->length,
                 delay = ns_events_delay(at_end, rate, m->o.h);
    const int follows = at_end > 0 && fmin(m->in->corner, m->in->first) > step->end_t + delay &&
                        at_end <= beside * ns_sparse_guard_control_rounding(m, c, step->images, step->z);
    a[0] -= follows ? at_end : 0;
    if (!ns_modes_is_multiple(step->stages, a, b, NULL))
        return 0;
    *apart = follows ? at_end * ns_events_beyond_delay : 0;
    return 1;
}

int ns_sparse_location_first(ns_sparse *m, ns_dense_step *step) {
    found f = {INFINITY, -1, 0, -1, 0, 0};
    int status = NS_OK;
    for (int j = 0; j < m->f->m; j++) {
        const int guards = guards_of(m, j);
        for (int k = 0; k < guards && status == NS_OK; k++)
            status = search_guard(m, step, (found){NAN, j, k, -1, 0, 0}, &f);
    }
    for (int c = 0; c < m->s->nc && status == NS_OK; c++)
        if (of_state(m, c))
            status = search_guard(m, step, (found){NAN, -1, 0, c, 0, 0}, &f);
    if (status != NS_OK || !(f.at <= 1))
        return status;
    step->at_event = 1;
    step->pair = f.pair;
    step->command = f.command;
    step->guard = f.k;
    if (f.at < 1) {
        step->length *= f.at;
        step->end_t = ns_lower(step->end_t, ns_higher(step->t, step->t + (step->time_lost + step->length)));
    }
    return status;
}
