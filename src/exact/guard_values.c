/* src/exact/guard_values.c - guards at a point, and what their rounding may be. */
#include "exact_internal.h"

#include "linalg/simd.h"

#include <float.h>
#include <math.h>

/* Rounding of a guard, in eps of its terms. */
static const double eps_of_terms = 64 * DBL_EPSILON;

/* And of t, in its eps: what a guard does in that time no step can follow. */
static const double eps_of_time = 4 * DBL_EPSILON;

double ns_exact_guard_rounding_at(const ns_exact *f, const ns_mode_kernel *k, int g, double rate) {
    const double *noise = k->noise + g;
    double size = 0;
    for (int j = 0; j < k->r; j++)
        size += noise[j * k->rows] * f->most[j];
    for (int j = k->r; j < k->q; j++)
        size += noise[j * k->rows] * fabs(f->X[j]);
    return eps_of_terms * size + eps_of_time * fabs(f->t * rate);
}

/* So few numbers are summed up sooner than handed on. */
enum { FEW = 32 };

void ns_exact_guard_values(ns_exact *f, const ns_mode_kernel *k, const double *X, double *value,
                           double *tol) {
    double *rate = value + k->rows, *size = f->ahead;
    if (k->rows * k->q <= FEW) {
        for (int g = 0; g < k->rows; g++) {
            value[g] = ns_exact_guard_of(k, k->value, g, X);
            rate[g] = ns_exact_guard_of(k, k->rate, g, X);
            tol[g] = ns_exact_guard_rounding_at(f, k, g, rate[g]) + fabs(rate[g]) * f->slack;
        }
        return;
    }
    for (int j = 0; j < k->q; j++)
        size[j] = j < k->r ? f->most[j] : fabs(f->X[j]);
    ns_linalg_matvec(2 * k->rows, k->q, k->sight, X, value);
    ns_linalg_matvec(k->rows, k->q, k->noise, size, tol);
    for (int g = 0; g < k->rows; g++)
        tol[g] = eps_of_terms * tol[g] + eps_of_time * fabs(f->t * rate[g]) + fabs(rate[g]) * f->slack;
}

double ns_exact_guard_rounding(const ns_exact *f, const ns_mode_kernel *k, int g) {
    return ns_exact_guard_rounding_at(f, k, g, ns_exact_guard_of(k, k->rate, g, f->X));
}
