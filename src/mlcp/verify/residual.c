/* src/mlcp/verify/residual.c - how well a lambda solves a problem, judged from the problem alone.
 *
 * Natural residual, row by row, with y and lambda each in units of its own size:
 *
 *     res_i = | lambda_i - proj_[l,u]( lambda_i - y_i ) |,   y_i in units of Y_i, lambda_i of L_i
 *
 *     Y_i = |q_i| + sum_j |W_ij lambda_j|     the terms that were summed: rounding leaves 1e-16 of them
 *     L_i = min_j Y_j / |W_ji|                the change of lambda_i that changes some y_j by its whole size
 *
 * Both follow the units of rows and columns, so that a problem in mA and kV gets the same residual.
 * A row of which every term is itself rounding noise (the current of a branch in which nothing flows) would
 * be compared with noise; so where that leaves doubt, Y_i is at least FLOOR times the largest term that any
 * lambda could make in row i, each lambda in the unit of its column (Curtis and Reid's, which follows the
 * units in which the problem is written).  Any lambda of the same part, that is: rows and columns that no
 * entry joins have no unit in common.  (Arioli, Demmel and Duff, "Solving sparse linear systems with
 * sparse backward error", treat vanishing denominators alike.)
 */
#include "residual.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "linalg/column_scaling.h"
#include "linalg/simd.h"
#include "nonsmooth/mlcp.h"

/* 1e-6: noise of 1e-16 of the largest term counts as 1e-10; smaller true currents are still told apart
 * down to 1e-16 of the largest. */
static const double FLOOR = 1e-6;
static const double NO_DOUBT = 1e-13; /* no floor is looked for */

int ns_mlcp_unsound(const ns_mlcp *p, const double *lambda) {
    if (!p || p->m < 0)
        return 1;
    if (p->m > 0 && ((!p->W && !p->column) || !p->q || !p->l || !p->u || !lambda))
        return 1;
    for (int i = 0; i < p->m; i++)
        if (!isfinite(lambda[i]) || !isfinite(p->q[i]) || !(p->l[i] <= p->u[i]))
            return 1;
    return 0;
}

/* y = W lambda + q, the sums of sizes. */
static void sum_rows(const ns_mlcp *p, const double *lambda, double *y, double *size) {
    size_t m = (size_t)p->m;
    for (size_t i = 0; i < m; i++) {
        y[i] = p->q[i];
        size[i] = fabs(p->q[i]);
    }
    for (size_t j = 0; j < m; j++) {
        const double *col = p->W + j * m, v = lambda[j];
        if (v == 0.0)
            continue;
        for (size_t i = 0; i < m; i++) {
            double term = col[i] * v;
            y[i] += term;
            size[i] += fabs(term);
        }
    }
}

/* Raises sizes to their floor.  unit, top: m each; work: NS_UNITS_WORK*m. */
static void raise_to_floor(const ns_mlcp *p, const double *lambda, int together, double *size, double *unit,
                           double *top, double *work) {
    double *norm = work + p->m;
    ns_linalg_column_scaling(p->m, p->W, unit, work);
    memset(top, 0, (size_t)p->m * sizeof *top);
    for (int j = 0; j < p->m; j++) {
        const double *col = p->W + (size_t)j * (size_t)p->m;
        for (int i = 0; i < p->m; i++)
            top[i] = ns_higher(fabs(col[i]) * unit[j], top[i]);
    }
    for (int i = 0; i < p->m; i++)
        work[i] = top[i] > 0.0 ? 1.0 / top[i] : 0.0;
    memset(norm, 0, (size_t)p->m * sizeof *norm);
    for (int j = 0; j < p->m; j++) {
        const double *col = p->W + (size_t)j * (size_t)p->m;
        const double v = lambda[j] != 0.0 ? fabs(lambda[j]) * ns_weighted_max(p->m, col, work) : 0.0;
        for (int i = 0; i < p->m && v > 0.0; i++)
            norm[i] = together || col[i] != 0.0 ? ns_higher(norm[i], v) : norm[i];
    }
    if (!together)
        ns_linalg_spread(p->m, p->W, norm, norm + p->m);
    for (int i = 0; i < p->m; i++)
        size[i] = ns_higher(FLOOR * norm[i] * top[i], size[i]);
}

/* Row i; size: its Y; inverse: 1/Y of all rows. */
static double row_residual(const ns_mlcp *p, int i, double lambda, double y, double size,
                           const double *inverse) {
    const double l = p->l[i], u = p->u[i];
    const double ys = isinf(size) ? NAN : size > 0.0 ? y / size : y; /* 1/size may overflow, this does not */
    if ((isinf(l) && isinf(u)) || isnan(ys))                         /* fmin, fmax drop a NAN */
        return fabs(ys);
    double unit = fmin(ns_weighted_max(p->m, p->W + (size_t)i * (size_t)p->m, inverse), DBL_MAX); /* 1/L */
    if (!(unit > 0.0)) /* no row notices lambda_i: its own size must do */
        unit = lambda != 0.0 ? fmin(1.0 / fabs(lambda), DBL_MAX) : 1.0;
    const double up = (lambda - l) * unit, down = (lambda - u) * unit;
    return fabs(l == u ? up : fmin(fmax(ys, down), up)); /* lambda less its projection */
}

/* The largest, with the sizes as they are; inverse (m) gets 1/Y.  NAN where terms are beyond a double. */
static double largest_row_residual(const ns_mlcp *p, const double *lambda, const double *y,
                                   const double *size, double *inverse, int *worst) {
    double most = 0.0;
    for (int i = 0; i < p->m; i++)
        inverse[i] = size[i] > 0.0 ? 1.0 / size[i] : 0.0;
    for (int i = 0; i < p->m; i++) {
        double r = row_residual(p, i, lambda[i], y[i], size[i], inverse);
        if (!(r <= most)) {
            most = r;
            if (worst)
                *worst = i;
        }
        if (isnan(r))
            break;
    }
    return most;
}

double ns_mlcp_measure(const ns_mlcp *p, const double *lambda, int together, double *work, int *worst) {
    size_t m = (size_t)p->m;
    double *y = work, *inverse = work + m, *size = work + 2 * m, *more = work + 3 * m;
    sum_rows(p, lambda, y, size);
    double r = largest_row_residual(p, lambda, y, size, inverse, worst);
    if (r <= NO_DOUBT || isnan(r))
        return r;
    raise_to_floor(p, lambda, together, size, more, more + m, more + 2 * m);
    return largest_row_residual(p, lambda, y, size, inverse, worst);
}

/* The columns of a W on demand; NULL: no memory, or one could not be had. */
static double *gather_columns(const ns_mlcp *p) {
    const size_t m = (size_t)p->m;
    double *W = malloc(m * m * sizeof *W);
    for (int j = 0; W && j < p->m; j++)
        if (p->column(p->data, j, W + (size_t)j * m) != 0) {
            free(W);
            W = NULL;
        }
    return W;
}

double ns_mlcp_residual(const ns_mlcp *p, const double *lambda, int *worst) {
    enum { SMALL = 128 };
    double few[NS_MEASURE_WORK * SMALL], r = NAN;
    if (worst)
        *worst = 0;
    if (ns_mlcp_unsound(p, lambda))
        return NAN;
    if (p->m == 0)
        return 0.0;
    ns_mlcp whole = *p;
    double *own = p->W ? NULL : gather_columns(p);
    double *work = p->m <= SMALL ? few : malloc(NS_MEASURE_WORK * (size_t)p->m * sizeof *work);
    whole.W = own ? own : p->W;
    if (work && whole.W)
        r = ns_mlcp_measure(&whole, lambda, 0, work, worst);
    if (work != few)
        free(work);
    free(own);
    return r;
}
