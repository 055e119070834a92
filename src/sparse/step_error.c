/* src/sparse/step_error.c - the stages of a step, as many as are needed, and its error against what is
 * allowed. */
#include "guards.h"
#include "largest.h"
#include "linalg/simd.h"
#include "step.h"

#include <float.h>
#include <math.h>

/* The scale of a charge or flux is at least this fraction of the largest one. */
static const double least_scale = 1e-3;
/* Where w contradicts the algebraic equations one more Euler step leaves this fraction of D^8 w, or less. */
static const double wiped_out = 1e-2;
/* No further stages where they would add less than this fraction of the error allowed; with all stages, ten
 * times that. */
static const double stages_fraction = 0.1, all_stages_fraction = 0.1;
/* What has a finite rate is less than this fraction of itself after D. */
static const double decays = 0.7;
/* What jumps stays as large as this after D, or larger; so does what needs steps shorter by 2^4. */
static const double stays = 0.95;
/* D^i w up to this multiple of what rounding does to one solution is rounding: D^i w has that of i solutions,
 * and leaves b_i of it in the w that the next step begins with; the sum of i |b_i| at the end of a step. */
static const double most_noise = 56;
/* Inputs may have this fraction of the error. */
static const double inputs_fraction = 0.1;
/* The largest |b_9| in a step; longer steps are taken where they promise this fraction of the error allowed.
 */
#define ERROR 1.3
#define GROWTH 0.3
enum { FEWEST_STAGES = 2 };

/* The scale of w_i, where the largest of all is `largest` units; 0: row i is algebraic. */
static double scale_of(const ns_sparse *m, size_t i, double largest) {
    return m->f->algebraic[i] ? 0 : ns_higher(least_scale * largest * m->unit[i], m->largest.w[i]);
}

static void set_inverse_scales(ns_sparse *m, double largest) {
    for (size_t i = 0; i < (size_t)m->f->n; i++) {
        const double scale = scale_of(m, i, largest);
        m->inverse_scale[i] = scale > 0 ? 1 / scale : 0;
    }
}

/* The part of the error over the full length of a step that counts if the step ends after `room` s: the error
 * of w grows with time, but x and lambda are off by D^8 x, D^8 lambda as soon as the step begins. */
static double part_of(const ns_dense_step *step, double room) {
    static const double least = 1e-2;
    return fmin(1, fmax(least, room / step->g / ERROR));
}

/* The size of D^p w, in scales. */
static double size_of_power(const ns_sparse *m, const ns_dense_step *step, int p) {
    const double *d = step->powers + (size_t)p * (size_t)m->f->n;
    double size = 0, no_number = 0;
    for (int i = 0; i < m->f->n; i++) {
        size = ns_higher(fabs(d[i]) * m->inverse_scale[i], size);
        no_number += d[i] - d[i];
    }
    return size + no_number;
}

/* 1 if what stages p, p+1, ... would add up to this fraction of the step is well below the error allowed, of
 * the state, inputs and guards: no stiff part is excited, it would show as large in these stages. */
static int are_enough(const ns_sparse *m, const ns_dense_step *step, int p, double fraction, double size) {
    const double allowed = stages_fraction * m->o.reltol / (ERROR * fraction);
    return (size <= allowed) && ns_inputs_stages_error(m->in, step->g, p) <= inputs_fraction * allowed &&
           ns_sparse_guard_enough(m, step, p);
}

int ns_sparse_step_stages(ns_sparse *m, ns_dense_step *step, double room) {
    const ns_cached_factors *k;
    const double fraction = part_of(step, room);
    double before = INFINITY;
    int status = ns_sparse_factors_factor(m->q, step->g, m->mode, 0, &k), i = 0;
    step->converged = 0;
    while (i < NS_ORDER && status == NS_OK && !step->converged) {
        status = ns_sparse_step_stage(m, step, k, i);
        if (i++ == 0 && status == NS_OK && !(room < step->g)) {
            set_inverse_scales(m, ns_sparse_largest_w(m, step));
            ns_sparse_largest_guards(m, step->images, step->length_exponent);
        }
        if (i < FEWEST_STAGES || status != NS_OK)
            continue;
        if (i == FEWEST_STAGES && room < step->g)
            set_inverse_scales(m, ns_sparse_largest_part(m, step, room));
        const double size = size_of_power(m, step, i);
        step->converged =
            are_enough(m, step, i, i < NS_ORDER ? fraction : all_stages_fraction * fraction, size);
        if (m->predict.trying && !step->converged &&
            (m->predict.trying == NS_FIRST_PREDICTION ? size > decays * before
                                                      : i == NS_ORDER && size > stays * before))
            status = NS_E_LIMIT;
        before = size;
    }
    step->stages = step->shown = i;
    return status;
}

/* The rounding of D^8 w in row i: each stage leaves some of that of w. */
static double rounding_of(const ns_sparse *m, const ns_dense_step *step, size_t i) {
    return 16 * DBL_EPSILON *
           (fabs(step->powers[i]) + ns_linalg_csc_size(&m->f->Mt, (int)i, step->images) +
            step->g * ns_linalg_csc_size(&m->f->At, (int)i, step->images));
}

/* The error of the step over its full length, as a multiple of what is allowed: b_9 D^9 w, extrapolated from
 * D^7 w and D^8 w, with half of the decay that they show.  *ratio: the fraction of D^7 w that is left in D^8
 * w, at most 1. Where w contradicts the algebraic equations (D = -1) a step of any length removes that: not
 * counted, but *jump is by how much the error would be larger, and *time how long it lasts, in g. */
static double error_of(const ns_sparse *m, const ns_dense_step *step, double *ratio, double *jump,
                       double *time) {
    const size_t n = (size_t)m->f->n;
    const double *d8 = step->powers + (size_t)step->stages * n, *d7 = d8 - n,
                 largest = ns_sparse_largest_size(m);
    const double little = m->o.reltol * ldexp(GROWTH / ERROR, -(NS_ORDER + 1));
    double before = 0, all = 0, held = 0;
    for (size_t i = 0; i < n; i++) {
        const double scale = scale_of(m, i, largest);
        if (!(scale > 0))
            continue;
        double by = fabs(d8[i]);
        if (by > little * scale) /* it counts, unless it is rounding */
            by = ns_higher(by - rounding_of(m, step, i), 0);
        if (!(by < INFINITY))
            return INFINITY;
        all = ns_higher(by / scale, all);
        held = ns_higher(fabs(d7[i] + d8[i]) / scale, held);
        before = ns_higher(fabs(d7[i]) / scale, before);
    }
    double last = held < wiped_out * all ? held : all; /* held: E D^7 w */
    *ratio = last < before ? last / before : 1;
    if (step->stages < NS_ORDER) /* had there been all */
        last *= pow(*ratio, NS_ORDER - step->stages);
    *jump = ERROR * (all - last) / m->o.reltol;
    *time = held / all; /* read where there is a jump: all > 0 */
    const double error = ERROR * last * sqrt(*ratio) / m->o.reltol;
    if (error <= 1 && *jump <= 1)
        return error;
    if (largest > ns_sparse_largest_rounding(m) &&
        (error <= 1 || !ns_sparse_project_is_rounding(m, step->g, step->images, largest)))
        return error;
    *jump = 0;
    return 0; /* all of w is rounding */
}

int ns_sparse_step_doublings(double error, double d, int most) {
    int k = 0;
    while (k < most && (error *= pow(2 / (1 + d), NS_ORDER + 1)) < GROWTH) {
        d = 2 * d / (1 + d);
        k++;
    }
    return k;
}

double ns_sparse_step_inputs_error(const ns_sparse *m, int length_exponent) {
    return ERROR *
           ns_inputs_stages_error(m->in, ns_sparse_step_length(m, length_exponent) / NS_POLE, NS_ORDER) /
           (inputs_fraction * m->o.reltol);
}

/* What looks like a fast transient may be lost digits: the stages of all orders with corrected solutions.  So
 * they are in the steps that follow until none are lost: what a step loses is a transient for the next one.
 */
static int refine_stages(ns_sparse *m, ns_dense_step *step, double fraction) {
    const int status = ns_sparse_step_refine(m, step);
    if (status == NS_OK && step->stages == NS_ORDER)
        step->converged =
            are_enough(m, step, NS_ORDER, all_stages_fraction * fraction, size_of_power(m, step, NS_ORDER));
    return status;
}

/* 1 if the last D^i w are what rounding of w and of the terms of (P2) may do to them: one solution shows how
 * much that is.  A capacitor between nodes at high voltages carries the rounding of these, over the step. */
static int are_rounding(ns_sparse *m, const ns_dense_step *step) {
    double noise = 0;
    if (ns_sparse_guard_perturb(m, step->images, step->powers, step->g, 0) != NS_OK)
        return 0;
    for (int i = 0; i < m->f->n; i++)
        if (!m->f->algebraic[i])
            noise = ns_higher(noise, step->g * fabs(ns_linalg_csc_dot(&m->f->At, i, m->work.v)) *
                                         m->inverse_scale[i]);
    return size_of_power(m, step, step->stages) <= most_noise * noise;
}

int ns_sparse_step_measure(ns_sparse *m, ns_dense_step *step, double room, ns_step_error *e) {
    const double part = part_of(step, room);
    const int all_stages = step->stages == NS_ORDER;
    *e = (ns_step_error){.ratio = 1};
    e->whole = error_of(m, step, &e->ratio, &e->jump, &e->time);
    if (m->digits_lost || (all_stages && (e->jump > 1 || (e->whole * part > 1 && e->ratio > decays))))
        m->digits_lost = ns_sparse_step_digits_lost(m, step);
    if (m->digits_lost) {
        const int status = refine_stages(m, step, part);
        if (status != NS_OK)
            return status;
        e->whole = error_of(m, step, &e->ratio, &e->jump, &e->time);
    }
    if (all_stages &&
        (e->jump > 1 || (e->ratio > decays && ns_sparse_step_doublings(e->whole * part, e->ratio, 1) == 0)) &&
        are_rounding(m, step))
        e->whole = e->jump = 0;
    e->until_room = e->whole * part;
    return NS_OK;
}
