/* src/exact/guard_values.c - guards at a point, and what their rounding may be. */
#include "exact_internal.h"

#include "guards.h"
#include "linalg/simd.h"

#include <float.h>
#include <math.h>

/* Rounding of a guard, in units of the size of its terms. */
static const double eps_of_terms = 64 * DBL_EPSILON;

/* What a guard changes by in that time cannot be told from rounding. */
double ns_exact_rounding_of_time(const ns_exact *f) {
    return 4 * DBL_EPSILON * fabs(f->state.now.t);
}

double ns_exact_guard_rounding_at(const ns_exact *f, const ns_mode_kernel *k, int g, const double *X,
                                  double rate) {
    const double *noise = k->rounding + g;
    double size = 0;
    for (int j = 0; j < k->r; j++)
        size += noise[j * k->rows] * f->max_abs[j];
    for (int j = k->r; j < k->q; j++)
        size += noise[j * k->rows] * fabs(X[j]);
    return eps_of_terms * size + ns_exact_rounding_of_time(f) * fabs(rate);
}

double ns_exact_guard_lasts(const ns_exact *f, const ns_mode_kernel *k, int g, const double *X, double rate) {
    static const double noise = 64, part = 1.0 / 16;
    const double second = ns_exact_guard_of(k, k->second_rate, g, X);
    const int is_known = k->g * k->g * fabs(second) > noise * ns_exact_guard_rounding_at(f, k, g, X, 0);
    return is_known ? part * fabs(rate / second) : INFINITY;
}

double ns_exact_guard_time_rounding(const ns_exact *f, const ns_mode_kernel *k, int g, const double *X,
                                    double rate) {
    return ns_lower(ns_exact_rounding_of_time(f), ns_exact_guard_lasts(f, k, g, X, rate));
}

/* So few terms are summed faster here than by a call. */
enum { FEW_TERMS = 32 };

void ns_exact_guard_values(ns_exact *f, const ns_mode_kernel *k, const double *X, double *value,
                           double *tol) {
    double *rate = value + k->rows, *size = f->work.max_abs;
    if (k->rows * k->q <= FEW_TERMS) {
        for (int g = 0; g < k->rows; g++) {
            value[g] = ns_exact_guard_of(k, k->value, g, X);
            rate[g] = ns_exact_guard_of(k, k->rate, g, X);
            tol[g] =
                ns_exact_guard_rounding_at(f, k, g, X, rate[g]) + fabs(rate[g]) * f->state.event_time_error;
        }
        return;
    }
    for (int j = 0; j < k->q; j++)
        size[j] = j < k->r ? f->max_abs[j] : fabs(X[j]);
    ns_linalg_matvec(2 * k->rows, k->q, k->guard_values, X, value);
    ns_linalg_matvec(k->rows, k->q, k->rounding, size, tol);
    for (int g = 0; g < k->rows; g++)
        tol[g] = eps_of_terms * tol[g] + ns_exact_rounding_of_time(f) * fabs(rate[g]) +
                 fabs(rate[g]) * f->state.event_time_error;
}

double ns_exact_guard_rounding(const ns_exact *f, const ns_mode_kernel *k, int g) {
    return ns_exact_guard_rounding_at(f, k, g, f->X, ns_exact_guard_of(k, k->rate, g, f->X));
}

/* A: the largest of conducting pairs, or of the terms that it is summed from in `coarse`, as what flows
 * elsewhere counts too. */
static double largest_current(const ns_exact *f, const ns_mode_kernel *fine, const ns_mode_kernel *coarse) {
    double most = 0;
    for (int g = 0; g < fine->pair_rows; g++) {
        if (fine->row[g].to == NS_INSIDE)
            continue;
        most = ns_higher(most, fabs(ns_exact_guard_of(fine, fine->value, g, f->X)));
        most = ns_higher(most, ns_exact_guard_rounding_at(f, coarse, g, f->X, 0) / eps_of_terms);
    }
    return most;
}

static double highest_voltage(const ns_exact *f, const ns_mode_kernel *fine) {
    double most = f->highest;
    for (int g = 0; g < fine->pair_rows; g++)
        if (fine->row[g].to == NS_INSIDE)
            most = ns_higher(most, fabs(ns_exact_guard_of(fine, fine->value, g, f->X)));
    return most;
}

int ns_exact_guards_are_readable(const ns_exact *f, const ns_exact_mode *resolved, const ns_exact_mode *of) {
    static const double part = 1e-3;
    const ns_mode_kernel *fine = resolved->scale[0].kernel, *coarse = of->scale[0].kernel;
    const double volts = part * highest_voltage(f, fine), amperes = part * largest_current(f, fine, coarse);
    for (int g = 0; g < fine->pair_rows; g++)
        if (!(ns_exact_guard_rounding_at(f, fine, g, f->X, 0) <=
              (fine->row[g].to == NS_INSIDE ? volts : amperes)))
            return 0;
    return 1;
}
