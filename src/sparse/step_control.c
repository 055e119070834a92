/* src/sparse/step_control.c - how long a step is, and how many stages it takes: its error against what is
 * allowed. */
#include "linalg/simd.h"
#include "sparse_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Below, a charge or flux of small energy counts as this much of the largest one. */
static const double least_share = 1e-3;
/* Of D^8 w this or less is left by one more Euler step where w contradicts the algebraic equations. */
static const double wiped_out = 1e-2;
/* Where stages left out would add no more than this share of the error allowed, they are. */
static const double stages_share = 0.1;
/* With all stages more may be left, as is what all legs may err by. */
static const double last_share = 0.1;
/* Of what is of finite rate, this or less is left by D. */
static const double decays = 0.7;
/* Inputs are allowed this share of the error. */
static const double inputs_share = 0.1;
/* The largest |b_9| in a step; longer steps are taken where they promise this share of the error allowed. */
#define ERROR 1.3
#define GROWTH 0.3
/* How many times as long, in powers of two, the next leg may be. */
enum { MOST_DOUBLINGS = 4, FEWEST = 2 };

/* Takes account of w and of how it moves in the scales; the largest square root of an energy, or some such.
 */
static double take_scales(ns_sparse *m, const ns_dense_step *leg) {
    const int n = m->f->n;
    double most = 0;
    for (int i = 0; i < n; i++)
        if (!m->f->algebraic[i]) {
            m->scale[i] = ns_higher(fabs(leg->dw[n + i]), ns_higher(fabs(leg->dw[i]), m->scale[i]));
            most = ns_higher(m->scale[i] / m->unit[i], most);
        }
    return most;
}

/* The scale of w_i; 0: nothing is ever there. */
static double scale_of(const ns_sparse *m, size_t i, double most) {
    return m->f->algebraic[i] ? 0 : ns_higher(least_share * most * m->unit[i], m->scale[i]);
}

static void take_shares(ns_sparse *m, double most) {
    for (size_t i = 0; i < (size_t)m->f->n; i++) {
        const double scale = scale_of(m, i, most);
        m->share[i] = scale > 0 ? 1 / scale : 0;
    }
}

/* D^p w, in scales. */
static double size_of_power(const ns_sparse *m, const ns_dense_step *leg, int p) {
    const double *d = leg->dw + (size_t)p * (size_t)m->f->n;
    double size = 0, no_number = 0;
    for (int i = 0; i < m->f->n; i++) {
        size = ns_higher(fabs(d[i]) * m->share[i], size);
        no_number += d[i] - d[i];
    }
    return size + no_number;
}

/* 1 if what stages p, p+1, ... would add before share of the step is well below the error allowed, for the
 * state, inputs and guards: some stiff part is not there, or later stages would show it as large. */
static int enough(const ns_sparse *m, const ns_dense_step *leg, int p, double share, double size) {
    const double allowed = stages_share * m->o.reltol / (ERROR * share);
    return (size <= allowed) && ns_inputs_stages_error(m->in, leg->g, p) <= inputs_share * allowed &&
           ns_sparse_guard_enough(m, leg, p);
}

/* As many as it takes, until room: at most NS_ORDER.  Errors: LIMIT (a guess is tried, and what jumps shows).
 */
static int all_stages(ns_sparse *m, ns_dense_step *leg, double room) {
    const ns_kept_factors *k;
    const double share = fmin(1, room / leg->g / ERROR);
    double before = INFINITY;
    int status = ns_sparse_factors_factor(m->q, leg->g, m->mode, 0, &k), i = 0;
    leg->calm = 0;
    while (i < NS_ORDER && status == NS_OK && !leg->calm) {
        status = ns_sparse_step_stage(m, leg, k, i);
        if (i++ == 0 && status == NS_OK) {
            take_shares(m, take_scales(m, leg));
            ns_sparse_guard_sizes(m, leg->xi, leg->rung);
        }
        if (i < FEWEST || status != NS_OK)
            continue;
        const double size = size_of_power(m, leg, i);
        leg->calm = enough(m, leg, i, i < NS_ORDER ? share : last_share * share, size);
        if (m->guessing && !leg->calm && size > decays * before &&
            (i == NS_ORDER || m->guessing == NS_FIRST_GUESS))
            status = NS_E_LIMIT;
        before = size;
    }
    leg->stages = i;
    return status;
}

/* What is rounding in D^8 w of row i: each stage leaves some of w's. */
static double noise_of(const ns_sparse *m, const ns_dense_step *leg, size_t i) {
    return 16 * DBL_EPSILON *
           (fabs(leg->dw[i]) + ns_linalg_csc_size(&m->f->Mt, (int)i, leg->xi) +
            leg->g * ns_linalg_csc_size(&m->f->At, (int)i, leg->xi));
}

/* The error of the step of the whole length, as a multiple of what is allowed: b_9 D^9 w, guessed from the
 * two before, not quite as small as they promise.  *ratio: how much of D^7 w is left in D^8 w, at most 1.
 * Where w contradicts the algebraic equations (D = -1) the step wipes that out, however long it is: not
 * counted, but *jump is how much more there would be, and *time how long it lasts, of g. */
static double error_of(const ns_sparse *m, const ns_dense_step *leg, double *ratio, double *jump,
                       double *time) {
    const size_t n = (size_t)m->f->n;
    const double *d8 = leg->dw + (size_t)leg->stages * n, *d7 = d8 - n, most = ns_sparse_project_size(m);
    const double little = m->o.reltol * ldexp(GROWTH / ERROR, -(NS_ORDER + 1));
    double before = 0, all = 0, held = 0;
    for (size_t i = 0; i < n; i++) {
        const double scale = scale_of(m, i, most);
        if (!(scale > 0))
            continue;
        double by = fabs(d8[i]);
        if (by > little * scale) /* it matters, unless it is rounding */
            by = ns_higher(by - noise_of(m, leg, i), 0);
        if (!(by < INFINITY))
            return INFINITY;
        all = ns_higher(by / scale, all);
        held = ns_higher(fabs(d7[i] + d8[i]) / scale, held);
        before = ns_higher(fabs(d7[i]) / scale, before);
    }
    double last = held < wiped_out * all ? held : all; /* held: E D^7 w */
    *ratio = last < before ? last / before : 1;
    if (leg->stages < NS_ORDER) /* had there been all */
        last *= pow(*ratio, NS_ORDER - leg->stages);
    *jump = ERROR * (all - last) / m->o.reltol;
    *time = all > 0 ? held / all : 0;
    const double error = ERROR * last * sqrt(*ratio) / m->o.reltol;
    if (error <= 1 || !ns_sparse_project_is_rounding(m, leg->g, leg->xi, most))
        return error;
    *jump = 0;
    return 0; /* of nothing */
}

/* How many times a step may be doubled: D, which is below 1, grows from d to 2 d / (1 + d). */
static int doublings(double error, double d, int most) {
    int k = 0;
    while (k < most && (error *= pow(2 / (1 + d), NS_ORDER + 1)) < GROWTH) {
        d = 2 * d / (1 + d);
        k++;
    }
    return k;
}

static double length(const ns_sparse *m, int rung) {
    return ldexp(m->o.h, -rung);
}

/* That of inputs, of which guards see more than the state, as a multiple of what is allowed. */
static double inputs_error(const ns_sparse *m, int rung) {
    return ERROR * ns_inputs_stages_error(m->in, length(m, rung) / NS_POLE, NS_ORDER) /
           (inputs_share * m->o.reltol);
}

/* Stages such that the error until room is small enough; the length wanted next. */
static int choose_length(ns_sparse *m, ns_dense_step *leg, double room) {
    ns_jump_kind gone = NS_NO_JUMP;
    int consistent = 0, most = MOST_DOUBLINGS;
    while (leg->rung < ns_sparse_least_length(m) && inputs_error(m, leg->rung) > 1)
        leg->rung++;
    while (most > 0 && inputs_error(m, leg->rung - most) > 1)
        most--;
    for (int tries = 0;; tries++) {
        const double h = length(m, leg->rung);
        leg->g = h / NS_POLE;
        int status = all_stages(m, leg, room);
        if (status != NS_OK)
            return status;
        double ratio = 1, jump = 0, time = 0;
        const double whole = error_of(m, leg, &ratio, &jump, &time), share = fmin(1, room / leg->g / ERROR),
                     error = whole * share;
        leg->next_rung = leg->rung;
        if (leg->stages == NS_ORDER && error <= 1 && jump > 1 && !consistent) {
            consistent = 1;
            status =
                ns_sparse_project_consistent(m, leg->t, length(m, leg->rung + NS_SHORT_RUNG), NULL, &gone);
            if (status != NS_OK)
                return status;
            memcpy(leg->dw, m->w, sizeof(double) * (size_t)m->f->n);
            continue;
        }
        const int least = ns_sparse_least_length(m);
        if (leg->stages == NS_ORDER && error <= 1 && jump > 1 && time > ldexp(1, leg->rung - least)) {
            m->counts.trials++; /* a transient */
            leg->rung += (int)fmin(least - leg->rung, fmax(1, -log2(time) - 2));
            continue;
        }
        if (error <= 1 || leg->rung >= ns_sparse_least_length(m) || tries >= ns_sparse_least_length(m)) {
            leg->next_rung -= doublings(whole, ratio, leg->rung < most ? leg->rung : most);
            if (whole > 1 && leg->next_rung < ns_sparse_least_length(m))
                leg->next_rung++;
            return whole < INFINITY ? NS_OK : NS_E_OVERFLOW;
        }
        m->counts.trials++;
        const int less =
            error < INFINITY ? (int)fmax(1, fmin(8, ceil(log2(error) / (NS_ORDER + 1) - 0.1))) : 8;
        leg->rung = leg->rung + less < least ? leg->rung + less : least;
    }
}

int ns_sparse_step_begin(ns_sparse *m, ns_dense_step *leg, double t, double limit) {
    const double room = limit - t - leg->time_lost;
    leg->t = t;
    leg->why = NS_LEG_GOES_ON;
    leg->pair = leg->command = -1;
    leg->euler = 0;
    memcpy(leg->mode, m->mode, (size_t)m->f->m);
    memcpy(leg->dw, m->w, sizeof(double) * (size_t)m->f->n);
    int status = choose_length(m, leg, room);
    if (status != NS_OK)
        return status;
    ns_sparse_guard_keep_sizes(m, leg->rung);
    const double h = length(m, leg->rung);
    leg->end = fmin(h, room);
    leg->end_t = h < room * (1 - 1e-9) ? t + (leg->time_lost + h) : limit;
    if (leg->end_t == limit)
        leg->end = room;
    m->counts.steps++;
    return ns_sparse_guard_first(m, leg);
}
