/* src/sparse/transient.c - a transient in which events crowd: pairs change one after another within a time
 * far shorter than steps are, as where charges spread along a pump through the resistance of its diodes.
 *
 * No event in it is located.  Implicit Euler steps with (P1) go through it: each stretch of length G three
 * times, by one step of G, two of G/2 and four of G/4, which are extrapolated (Deuflhard and Bornemann,
 * Scientific Computing with Ordinary Differential Equations, 4.3):
 *
 *     T22 = 2 T21 - T11,   T32 = 2 T31 - T21,   T33 = T32 + (T32 - T22)/3.
 *
 * A mode that changes on the way leaves errors of order G^2, which T32 - T22 shows: G is as long as T33 - T32
 * is within the error allowed.  What has died within G is damped, so that a transient that moves charges by
 * less than that error takes one G however many events are in it, and the mode that follows is that of (P1).
 * Charges and fluxes are conserved by each Euler step.  The stretch is one step of the engine; x and lambda
 * are shown as straight lines, from the values right after the transient had died.
 */
#include "guards.h"
#include "largest.h"
#include "linalg/simd.h"
#include "step.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Events crowd where a step that resolves a transient, shorter than the usual one by this, has one; a stretch
 * ends where it is as long as that, shorter by the other. */
static const double crowded = 0x1p-14, long_enough = 1.0 / 64;
/* The first G, in steps between two events. */
static const double first_length = 4, least = 0x1p-24;
/* Steps G and those that fail, of one stretch; so many in which no mode changed end it. */
enum { MOST = 48, MOST_FAILED = 8, QUIET = 4 };
/* G grows by at most 2^MOST_DOUBLINGS, as the errors promise this fraction of what is allowed. */
enum { MOST_DOUBLINGS = 2 };
/* Straight lines go on for so many halves of the last G. */
static const double most_on = 4;
/* A value that is shown may have the wrong sign by up to `little` times the largest one. */
static const double little = 1e-6;
static const double promised = 0.3;

typedef struct stretch {
    double t, room;  /* it begins at t and may last so long, s */
    double shortest; /* Euler steps below that cannot tell lambda from rounding, s */
    double length;   /* so far, s */
    int exponent;    /* G is a g of steps of h 2^-exponent */
    int quiet;       /* steps in which no mode changed, up to now */
    int steps;       /* G that were taken, */
    int failed;      /* and that failed */
    double last_g;   /* of the last of them, s */
    int mode_is_old; /* the mode was the same over the last G */
} stretch;

int ns_sparse_transient_create(ns_sparse *m) {
    const size_t n = (size_t)m->f->n, size = (size_t)m->f->size;
    ns_sparse_transient *k = &m->transient;
    k->w[0] = calloc(4 * n + 3 * size + 1, sizeof(double));
    k->mode = calloc(2 * (size_t)m->f->m + 1, 1);
    if (!k->w[0] || !k->mode)
        return NS_E_MEMORY;
    for (int i = 1; i < 4; i++)
        k->w[i] = k->w[i - 1] + n;
    k->v = k->w[3] + n;
    k->middle = k->v + size;
    k->end = k->middle + size;
    k->mode_middle = k->mode + m->f->m;
    return NS_OK;
}

void ns_sparse_transient_free(ns_sparse *m) {
    free(m->transient.w[0]);
    free(m->transient.mode);
}

/* The time in which the rounding of charges is a small part of the largest lambda. */
static double shortest_step(const ns_sparse *m, const double *v) {
    double most = 0;
    for (int i = 0; i < m->f->n; i++)
        if (!m->f->algebraic[i])
            most = ns_higher(ns_linalg_csc_size(&m->f->Mt, i, v), most);
    return 64 * DBL_EPSILON * most / (little * m->largest.lambda);
}

/* At a start always, as all charges are small there; else where ordinary steps fail, or rounding decides the
 * signs that they find.  Not where the state commands switches: a control that a switch itself moves is not
 * followed here. */
int ns_sparse_transient_is_due(const ns_sparse *m, const ns_dense_step *step) {
    if (m->f->gx.start[m->f->nc] > 0 || !step->at_event || step->is_euler || step->pair < 0 ||
        !(ldexp(m->o.h, -step->length_exponent) < crowded * step->usual_length))
        return 0;
    return step == m->trial.step || step->failures > 1 || step->length < shortest_step(m, step->images);
}

/* 1 if the rounding of the currents around pair j makes its lambda at the end of a step. */
static int is_rounding(const ns_sparse *m, const ns_dense_step *step, int j, double lambda) {
    double *v = m->transient.v;
    ns_sparse_step_point(m, step, step->length, v);
    return fabs(lambda) <= ns_sparse_guard_least_rounding(m, j, v, step->powers, step->g);
}

/* 1 if all charges and fluxes so far are rounding: signs of the currents say nothing. */
static int nothing_flows(const ns_sparse *m) {
    return ns_sparse_largest_size(m) <= ns_sparse_largest_rounding(m);
}

/* 1 if a conducting pair has the wrong sign at the end of a step, by more than a point that is shown may
 * have: what a series leaves there of a transient that it does not resolve.  It is passed by Euler steps. */
int ns_sparse_transient_is_left(const ns_sparse *m, const ns_dense_step *step) {
    double c[NS_STAGES];
    const size_t size = (size_t)m->f->size;
    if (m->f->gx.start[m->f->nc] > 0 || step->is_euler || !(step->length > 0))
        return 0;
    ns_modes_laguerre(step->length / step->g, NS_STAGES, c);
    for (int j = 0; j < m->f->m; j++) {
        double lambda = 0;
        if (step->mode[j] != NS_INSIDE)
            continue;
        for (int i = step->stages - 1; i >= 0; i--)
            lambda += c[i] * step->images[(size_t)i * size + (size_t)(m->f->n + j)];
        if (has_wrong_sign(m, j, lambda) && !is_rounding(m, step, j, lambda))
            return !nothing_flows(m);
    }
    return 0;
}

static double length_of(const ns_sparse *m, int exponent) {
    return ldexp(m->o.h, -exponent) / NS_POLE;
}

/* So many Euler steps from w (n) and the mode at the begin of G; 0: one is refused, or the engine has done as
 * much as it may. */
static int euler_steps(ns_sparse *m, double t, double G, int count, double *w) {
    ns_sparse_transient *k = &m->transient;
    const double g = G / count;
    ns_sparse_guard_set_mode(m, k->mode);
    memcpy(w, m->w, sizeof *w * (size_t)m->f->n);
    for (int i = 0; i < count; i++) {
        if (ns_engine_is_over(&m->engine) ||
            ns_sparse_event_consistent(m, t + i * g, g, w, k->v, NULL) != NS_OK)
            return 0;
        for (int r = 0; r < m->f->n; r++)
            w[r] = m->f->algebraic[r] ? 0 : ns_linalg_csc_dot(&m->f->Mt, r, k->v);
        if (2 * (i + 1) == count) {
            memcpy(k->middle, k->v, sizeof *k->v * (size_t)m->f->size);
            memcpy(k->mode_middle, m->mode, (size_t)m->f->m);
        }
    }
    return 1;
}

/* T33 to w[3], from T11, T21, T31 in w[0 ... 2]; the size of T33 - T32, of what is allowed. */
static double extrapolate(const ns_sparse *m) {
    const ns_sparse_transient *k = &m->transient;
    double worst = 0, no_number = 0;
    for (int i = 0; i < m->f->n; i++) {
        const double t22 = 2 * k->w[1][i] - k->w[0][i], t32 = 2 * k->w[2][i] - k->w[1][i],
                     by = (t32 - t22) / 3;
        k->w[3][i] = t32 + by;
        worst = ns_higher(fabs(by) * m->inverse_scale[i], worst);
        no_number += by - by;
    }
    return worst / m->o.reltol + no_number;
}

/* One step G from m->w and the mode kept: 1 if it is right; *error, of what is allowed. */
static int try_long_step(ns_sparse *m, const stretch *s, double G, double *error) {
    ns_sparse_transient *k = &m->transient;
    const double t = s->t + s->length;
    *error = INFINITY;
    if (!euler_steps(m, t, G, 1, k->w[0]) || !euler_steps(m, t, G, 2, k->w[1]) ||
        !euler_steps(m, t, G, 4, k->w[2]))
        return 0;
    *error = extrapolate(m);
    return *error <= 1;
}

/* By how many powers of two the next G may be longer; negative: shorter. */
static int doublings(double error) {
    const double by = floor(log2(promised / fmax(error, 1e-9)) / 3);
    return (int)fmax(-4, fmin(by, MOST_DOUBLINGS));
}

static void accept_long_step(ns_sparse *m, stretch *s, double G) {
    ns_sparse_transient *k = &m->transient;
    const size_t pairs = (size_t)m->f->m;
    s->quiet = memcmp(m->mode, k->mode, pairs) == 0 ? s->quiet + 1 : 0;
    s->mode_is_old = memcmp(m->mode, k->mode_middle, pairs) == 0;
    s->length += G;
    s->last_g = G;
    s->steps++;
    memcpy(k->mode, m->mode, pairs);
    memcpy(m->w, k->w[3], sizeof(double) * (size_t)m->f->n);
    memcpy(k->end, k->v, sizeof(double) * (size_t)m->f->size);
}

/* Steps G until the transient has died, or they fail. */
static void go_through(ns_sparse *m, stretch *s, double until) {
    while (s->steps < MOST && s->failed < MOST_FAILED && s->length < until && s->quiet < QUIET) {
        const double G = length_of(m, s->exponent);
        double error = INFINITY;
        if (s->length + G > s->room) {
            s->exponent++;
            s->failed++;
            continue;
        }
        const int right = try_long_step(m, s, G, &error);
        if (right)
            accept_long_step(m, s, G);
        else
            m->counts.trials++;
        s->failed += !right;
        s->exponent -= right ? doublings(error) : error < INFINITY ? (int)fmin(-1, doublings(error)) : -2;
    }
}

/* 1 if all laws hold at v, but for a small part of the largest lambda and y. */
static int all_hold(const ns_sparse *m, const double *v) {
    int all = 1;
    for (int j = 0; j < m->f->m && all; j++) {
        const double allowed = little * (m->mode[j] == NS_INSIDE ? m->largest.lambda : m->largest.y);
        for (int k = guards_of(m, j) - 1; k >= 0; k--)
            all &= guard(m, j, k, v, m->z, 1) >= -allowed;
    }
    return all;
}

/* x and lambda where the stretch begins, by (E1) of a step in m->mode as long as the stretch; 0: there are
 * none that keep all laws.  `step` is overwritten. */
static int find_begin_by_series(ns_sparse *m, const stretch *s, ns_dense_step *step, double *v) {
    const ns_cached_factors *k;
    step->t = s->t;
    step->g = s->length / NS_POLE;
    step->is_euler = 0;
    step->stages = NS_ORDER;
    memcpy(step->powers, m->before_event.w, sizeof(double) * (size_t)m->f->n);
    ns_inputs_stages_at(m->in, s->t);
    int status = ns_sparse_factors_factor(m->q, step->g, m->mode, 0, &k);
    for (int i = 0; i < NS_ORDER && status == NS_OK; i++)
        status = ns_sparse_step_stage(m, step, k, i);
    if (status != NS_OK)
        return 0;
    ns_sparse_step_point(m, step, 0, v);
    ns_system_inputs(m->s, s->t, NS_RIGHT, m->z);
    return all_hold(m, v);
}

/* x and lambda to the right of the event, by an Euler step as short as rounding allows; by the longest one if
 * all break laws by more than a small part of the largest; 0: there are none.  Where rounding allows none
 * that is short beside the stretch, its end may be far from its begin: by the series then, if that keeps all
 * laws.  `step` is overwritten. */
static int find_begin(ns_sparse *m, const stretch *s, ns_dense_step *step, double *v) {
    enum { SHORTEST = 16, LONGEST = 6, LONGER = 5 };
    int found = 0, holds = 0;
    for (int e = SHORTEST; e >= LONGEST && !holds; e -= LONGER) {
        const double g = fmin(fmax(ldexp(s->length, -e), s->shortest), s->length);
        ns_sparse_guard_set_mode(m, m->before_event.mode);
        found = ns_sparse_event_consistent(m, s->t, g, m->before_event.w, v, NULL) == NS_OK;
        holds = found && all_hold(m, v);
    }
    if (found && s->shortest > ldexp(s->length, -LONGEST) && find_begin_by_series(m, s, step, m->work.v))
        memcpy(v, m->work.v, sizeof *v * (size_t)m->f->size);
    ns_sparse_guard_set_mode(m, m->transient.mode);
    return found;
}

/* The difference of w[0] and w[1], of what is allowed. */
static double difference(const ns_sparse *m) {
    double worst = 0;
    for (int i = 0; i < m->f->n; i++)
        worst = ns_higher(fabs(m->transient.w[1][i] - m->transient.w[0][i]) * m->inverse_scale[i], worst);
    return worst / m->o.reltol;
}

/* Last Euler steps, one or three, short beside G, if they are right: the charges that the next step begins
 * with are those of an x and a lambda that keep the laws, which extrapolated ones over a small resistance
 * need not. */
static void end_consistent(ns_sparse *m, stretch *s) {
    enum { SHORTER = 16, SHORT = 4 };
    ns_sparse_transient *k = &m->transient;
    const double t = s->t + s->length, g = fmax(s->last_g / SHORTER, s->shortest);
    if (g > s->last_g / SHORT || s->length + g > s->room || !euler_steps(m, t, g, 1, k->w[0]) ||
        !euler_steps(m, t, g, 3, k->w[1]) || !(difference(m) <= 1)) {
        ns_sparse_guard_set_mode(m, k->mode);
        return;
    }
    memcpy(m->w, k->w[1], sizeof(double) * (size_t)m->f->n);
    memcpy(k->end, k->v, sizeof *k->v * (size_t)m->f->size);
    memcpy(k->mode, m->mode, (size_t)m->f->m);
    s->mode_is_old = memcmp(k->mode_middle, k->mode, (size_t)m->f->m) == 0;
    s->length += g;
    s->last_g += 2 * g;
}

/* x and lambda at the end of the stretch, and where they come from on a straight line: where the transient
 * died long before the end, from what followed it, else from the right side of the event. */
static void fill_line(ns_sparse *m, const stretch *s, ns_dense_step *step) {
    const ns_sparse_transient *k = &m->transient;
    const size_t size = (size_t)m->f->size;
    double *end = step->images, *begin = end + size;
    const double part = s->length / (0.5 * s->last_g);
    for (size_t i = 0; i < size; i++)
        k->v[i] = k->end[i] - part * (k->end[i] - k->middle[i]);
    if ((!s->mode_is_old || part > most_on || !all_hold(m, k->v)) && !find_begin(m, s, step, k->v))
        memcpy(k->v, k->end, sizeof *end * size);
    memcpy(end, k->end, sizeof *end * size);
    memcpy(begin, k->v, sizeof *begin * size);
}

static int next_exponent(const ns_sparse *m, double length) {
    int e = 0;
    while (e < ns_sparse_least_exponent(m) && ldexp(m->o.h, -e) > 2 * length)
        e++;
    return e;
}

static void fill_step(ns_sparse *m, const stretch *s, const ns_dense_step *before, const double *w,
                      ns_dense_step *step) {
    const size_t n = (size_t)m->f->n;
    fill_line(m, s, step);
    step->t = s->t;
    step->time_lost = before ? ns_sparse_step_time_lost(before) : 0;
    step->g = step->length = s->length;
    step->end_t = s->t + (step->time_lost + s->length);
    step->at_event = step->failures = step->after_event = step->unchanged = 0;
    step->pair = step->command = -1;
    step->is_euler = 1;
    step->stages = step->shown = 2;
    step->converged = 0;
    step->length_exponent = step->next_exponent = next_exponent(m, s->length);
    memcpy(step->powers, w, sizeof *w * n);
    for (size_t i = 0; i < n; i++)
        step->powers[n + i] = m->w[i] - w[i];
    memcpy(step->mode, m->mode, (size_t)m->f->m);
    ns_system_inputs(m->s, step->end_t, NS_LEFT, step->z);
}

int ns_sparse_transient_pass(ns_sparse *m, double t, const ns_dense_step *before, ns_dense_step *step) {
    ns_sparse_transient *k = &m->transient;
    const double limit = ns_sparse_next_limit(m, t), usual = step->usual_length;
    stretch s = {.t = t,
                 .room = (limit - t) * (1 - 1e-9),
                 .shortest = ns_higher(shortest_step(m, step->images), ns_sparse_finest(m))};
    while (s.exponent < ns_sparse_least_exponent(m) &&
           length_of(m, s.exponent) > first_length * fmax(step->length, fmax(least * usual, s.shortest)))
        s.exponent++;
    memcpy(k->mode, m->mode, (size_t)m->f->m);
    ns_sparse_event_save(m);
    k->runs = 1;
    go_through(m, &s, long_enough * usual);
    ns_sparse_guard_set_mode(m, k->mode);
    if (s.steps == 0) {
        k->runs = 0;
        ns_sparse_event_restore(m);
        return 0;
    }
    end_consistent(m, &s);
    m->counts.events++;
    m->counts.steps += s.steps;
    fill_step(m, &s, before, m->before_event.w, step);
    k->runs = 0;
    return 1;
}
