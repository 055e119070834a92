/* src/sparse/step_control.c - how long a step is, and how many stages it takes: its error against what is
 * allowed. */
#include "guards.h"
#include "largest.h"
#include "linalg/simd.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* The scale of a charge or flux is at least this fraction of the largest one. */
static const double least_scale = 1e-3;
/* Where w contradicts the algebraic equations one more Euler step leaves this fraction of D^8 w, or less. */
static const double wiped_out = 1e-2;
/* No further stages where they would add less than this fraction of the error allowed; with all stages, ten
 * times that. */
static const double stages_fraction = 0.1, all_stages_fraction = 0.1;
/* What has a finite rate is less than this fraction of itself after D. */
static const double decays = 0.7;
/* D^i w up to this multiple of what rounding does to one solution is rounding: D^i w has that of i solutions,
 * and leaves b_i of it in the w that the next step begins with; the sum of i |b_i| at the end of a step. */
static const double most_noise = 56;
/* Inputs may have this fraction of the error. */
static const double inputs_fraction = 0.1;
/* The largest |b_9| in a step; longer steps are taken where they promise this fraction of the error allowed.
 */
#define ERROR 1.3
#define GROWTH 0.3
/* The next step is at most 2^MOST_DOUBLINGS times as long; the fewest stages of a step. */
enum { MOST_DOUBLINGS = 4, FEWEST_STAGES = 2 };
/* A step so short that its matrix holds no digit of what it couples is made so many times as long, so often:
 * 2^-8 of the step that follows still takes no time in it. */
static const double much_longer = 16;
/* An edge of a source goes on beyond its end in the stages of a longer step, at most to this multiple of
 * itself. */
static const double too_steep = 256;
enum { LONGER = 2 };
/* So many steps resolve a transient that is over in the shortest usual one; more of them follow rounding. */
enum { MOST_STEEP = 64 };

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

/* As many stages as are needed until room, at most NS_ORDER.  Errors: LIMIT (a prediction is tried, and w
 * jumps). */
static int solve_stages(ns_sparse *m, ns_dense_step *step, double room) {
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
        if (m->predict.trying && !step->converged && size > decays * before &&
            (i == NS_ORDER || m->predict.trying == NS_FIRST_PREDICTION))
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

/* How many times a step may be doubled: with its length D grows from d < 1 to 2 d / (1 + d). */
static int count_doublings(double error, double d, int most) {
    int k = 0;
    while (k < most && (error *= pow(2 / (1 + d), NS_ORDER + 1)) < GROWTH) {
        d = 2 * d / (1 + d);
        k++;
    }
    return k;
}

static double length_of(const ns_sparse *m, int length_exponent) {
    return ldexp(m->o.h, -length_exponent);
}

/* The error of inputs, on which guards depend more than the state, as a multiple of what is allowed. */
static double inputs_error(const ns_sparse *m, int length_exponent) {
    return ERROR * ns_inputs_stages_error(m->in, length_of(m, length_exponent) / NS_POLE, NS_ORDER) /
           (inputs_fraction * m->o.reltol);
}

/* How many times a step may be doubled by the errors of the state, and of inputs in steps that are so many
 * times as long as the one that was tried first. */
static int allowed_doublings(const ns_sparse *m, int length_exponent, int first_exponent, double error,
                             double d) {
    int k = count_doublings(error, d, length_exponent < MOST_DOUBLINGS ? length_exponent : MOST_DOUBLINGS);
    while (k > 0 && inputs_error(m, first_exponent - k) > 1)
        k--;
    return k;
}

/* What looks like a fast transient may be lost digits: the stages of all orders with corrected solutions. */
static int refine_stages(ns_sparse *m, ns_dense_step *step, double fraction) {
    const int status = ns_sparse_step_refine(m, step);
    if (status == NS_OK)
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

/* A time that is none for the step. */
static double negligible(const ns_sparse *m, const ns_dense_step *step, double room) {
    return ns_sparse_step_negligible(length_of(m, step->length_exponent + NS_SHORT_EXPONENT),
                                     ns_sparse_finest(m), room);
}

/* 1 if the mode of the step does not hold at the end of an Euler step of length g, which takes away what
 * jumps: it was found by shorter ones, so this is a transient amid which other pairs change. */
static int changes_mode(ns_sparse *m, const ns_dense_step *step, double g) {
    return g > ns_sparse_finest(m) && ns_sparse_project_breaks(m, step->t, g, step->powers);
}

/* 1 if steps so short have a matrix of which no digit is left, or none of their solutions. */
static int is_too_short(int status) {
    return status == NS_E_SINGULAR || status == NS_E_RESIDUAL;
}

/* w at the beginning of the step made consistent with its mode by steps of length g, if pairs of the mode can
 * carry the impulses; else the worst of them is marked to break there. */
static int remove_jump(ns_sparse *m, ns_dense_step *step, double g) {
    const size_t bytes = sizeof(double) * (size_t)m->f->n;
    ns_jump_kind jumped = NS_NO_JUMP;
    int status = ns_sparse_project_consistent(m, step->t, g, NULL, &jumped);
    for (int longer = 0; longer < LONGER && is_too_short(status); longer++) {
        memcpy(m->w, step->powers, bytes);
        g *= much_longer;
        status = ns_sparse_project_consistent(m, step->t, g, NULL, &jumped);
    }
    if (status == NS_OK && jumped == NS_JUMPS && changes_mode(m, step, g)) {
        memcpy(m->w, step->powers, bytes);
        return status;
    }
    if (status == NS_OK && jumped == NS_JUMPS)
        status = ns_sparse_instant_misfit(m, step->t, g, &step->pair, &step->guard);
    if (status == NS_OK && step->pair >= 0) {
        memcpy(m->w, step->powers, bytes);
        return status;
    }
    if (status == NS_OK && jumped == NS_JUMPS)
        status = ns_sparse_instant_add(m, g, &m->instant);
    memcpy(step->powers, m->w, bytes);
    return status;
}

/* A length for which the error until room is small enough, with its stages; the length of the next step.  If
 * pair >= 0 the mode does not hold where it begins. */
static int choose_length(ns_sparse *m, ns_dense_step *step, double room) {
    int consistent = 0, regular = -1, /* the shortest length with which (P2) was */
        shortest = ns_sparse_least_exponent(m) + (m->steep_steps < MOST_STEEP ? NS_STEEPEST : 0);
    step->length_exponent = step->length_exponent < shortest ? step->length_exponent : shortest;
    while (step->length_exponent < ns_sparse_least_exponent(m) &&
           ns_inputs_stages_steepest(m->in, length_of(m, step->length_exponent) / NS_POLE) > too_steep)
        step->length_exponent++;
    while (step->length_exponent < ns_sparse_least_exponent(m) && inputs_error(m, step->length_exponent) > 1)
        step->length_exponent++;
    const int first_exponent = step->length_exponent;
    for (int tries = 0;; tries++) {
        const double h = length_of(m, step->length_exponent);
        step->g = h / NS_POLE;
        int status = solve_stages(m, step, room);
        if (status == NS_E_SINGULAR && step->length_exponent > ns_sparse_least_exponent(m)) {
            step->length_exponent = shortest = ns_sparse_least_exponent(m);
            continue;
        }
        if (status == NS_E_SINGULAR && regular >= 0 && regular < step->length_exponent) {
            step->length_exponent = shortest = regular; /* digits do not suffice for shorter ones */
            continue;
        }
        if (status != NS_OK)
            return status;
        regular = step->length_exponent;
        double ratio = 1, jump = 0, time = 0, whole = error_of(m, step, &ratio, &jump, &time);
        const double fraction = part_of(step, room);
        if (step->stages == NS_ORDER && (jump > 1 || (whole * fraction > 1 && ratio > decays)) &&
            ns_sparse_step_digits_lost(m, step)) {
            status = refine_stages(m, step, fraction);
            if (status != NS_OK)
                return status;
            whole = error_of(m, step, &ratio, &jump, &time);
        }
        if (step->stages == NS_ORDER &&
            (jump > 1 || (ratio > decays && count_doublings(whole * fraction, ratio, 1) == 0)) &&
            are_rounding(m, step))
            whole = jump = 0;
        const double error = whole * fraction;
        step->next_exponent = step->length_exponent;
        if (step->stages == NS_ORDER && error <= 1 && jump > 1 && !consistent) {
            consistent = 1;
            status = remove_jump(m, step, negligible(m, step, room));
            if (status != NS_OK || step->pair >= 0)
                return status;
            continue;
        }
        const int least = ns_sparse_least_exponent(m);
        if (step->stages == NS_ORDER && error <= 1 && jump > 1 && step->length_exponent < shortest &&
            time > ldexp(1, step->length_exponent - least)) {
            m->counts.trials++; /* a transient: it is resolved */
            step->length_exponent += (int)fmin(least - step->length_exponent, fmax(1, -log2(time) - 2));
            continue;
        }
        if (step->stages == NS_ORDER && error <= 1 && jump > 1 && consistent == 1) {
            consistent = 2; /* a transient that no step resolves: for the shortest ones it jumps */
            status = remove_jump(m, step, ns_sparse_finest(m));
            if (status != NS_OK || step->pair >= 0)
                return status;
            continue;
        }
        if (error <= 1 || step->length_exponent >= shortest || tries >= shortest) {
            step->next_exponent -= allowed_doublings(m, step->length_exponent, first_exponent, whole, ratio);
            if (whole > 1 && step->next_exponent < shortest)
                step->next_exponent++;
            return whole < INFINITY ? NS_OK : NS_E_OVERFLOW;
        }
        m->counts.trials++;
        const int less =
            error < INFINITY ? (int)fmax(1, fmin(8, ceil(log2(error) / (NS_ORDER + 1) - 0.1))) : 8;
        step->length_exponent =
            step->length_exponent + less < shortest ? step->length_exponent + less : shortest;
    }
}

int ns_sparse_control_step(ns_sparse *m, ns_dense_step *step, double t, double limit) {
    const double room = limit - t - step->time_lost;
    step->t = t;
    step->at_event = 0;
    step->pair = step->command = -1;
    step->is_euler = 0;
    memcpy(step->mode, m->mode, (size_t)m->f->m);
    memcpy(step->powers, m->w, sizeof(double) * (size_t)m->f->n);
    int status = choose_length(m, step, room);
    if (status != NS_OK)
        return status;
    if (step->pair >= 0) {
        step->at_event = 1;
        step->length = 0;
        step->end_t = t;
        return NS_OK;
    }
    m->steep_steps = step->length_exponent > ns_sparse_least_exponent(m) ? m->steep_steps + 1 : 0;
    const double h = length_of(m, step->length_exponent);
    step->length = fmin(h, room);
    step->end_t = h < room * (1 - 1e-9) ? t + (step->time_lost + h) : limit;
    if (step->end_t == limit)
        step->length = room;
    m->counts.steps++;
    status = ns_sparse_location_first(m, step);
    ns_sparse_largest_accept(m, step->length_exponent, step->end_t > t);
    return status;
}
