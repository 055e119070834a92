/* src/mlcp/pivoting/basis.c - one basis: its equations, their solution, its guards.
 *
 *   y_rows = W[rows,cols] lambda_cols + W[rows,rest] lambda_rest + q = 0,      lambda_rest at bounds
 *
 * Sizes: ysize_i is the sum of the sizes of the terms of y_i; lsize_i the change of lambda_i that changes
 * some y_j by ysize_j.  They follow the units of rows and columns, so guards are read in them and
 * the tableau is written in them.
 */
#include "linalg/simd.h"
#include "mlcp/mlcp_internal.h"

#include <math.h>
#include <string.h>

/* Rows whose terms are all rounding noise must not be compared with themselves: a size is at least this
 * part of the largest term the solution makes anywhere in its part of W (see residual.c, which decides in the
 * end). */
static const double FLOOR = 1e-6;

void ns_mlcp_basis_pick(ns_mlcp_solver *s) {
    int k = 0;
    for (int f = 0; f < s->nf; f++)
        s->rows[k++] = s->free[f];
    for (int a = 0; a < s->np; a++)
        if (s->mode[s->pair[a]] == NS_INSIDE)
            s->rows[k++] = s->pair[a];
    memcpy(s->cols, s->rows, (size_t)k * sizeof *s->cols);
    s->k = k;
}

/* out (k): entries `rows` of col (m). */
static void gather_rows(const ns_mlcp_solver *s, const double *col, double *out) {
    for (int i = 0; i < s->k; i++)
        out[i] = col[s->rows[i]];
}

void ns_mlcp_basis_gather(ns_mlcp_solver *s) {
    for (int j = 0; j < s->k; j++)
        gather_rows(s, s->W + (size_t)s->cols[j] * (size_t)s->m, s->G + (size_t)j * (size_t)s->k);
}

int ns_mlcp_basis_factor_of(ns_mlcp_solver *s, int n, const double *A, double *rcond) {
    s->factored.valid = 0;
    s->factors++;
    return ns_linalg_lu_factor(s->lu, n, A, rcond);
}

int ns_mlcp_basis_factor(ns_mlcp_solver *s, double *rcond) {
    ns_mlcp_basis_pick(s);
    ns_mlcp_basis_gather(s);
    return ns_mlcp_basis_factor_of(s, s->k, s->G, rcond);
}

/* y = W lambda + q for the present lambda; fixed ones are in q already. */
static void evaluate_y(ns_mlcp_solver *s) {
    size_t m = (size_t)s->m;
    memcpy(s->y, s->q, m * sizeof *s->y);
    for (int j = 0; j < s->m; j++)
        s->g[j] = s->lambda[j];
    for (int k = 0; k < s->nx; k++)
        s->g[s->fixed[k]] = 0.0;
    ns_linalg_matvec_add(s->m, s->m, s->W, s->g, s->y);
}

/* lambda of the basis less G^-1 y; y is that of lambda, before and after. */
static void correct_lambda(ns_mlcp_solver *s) {
    gather_rows(s, s->y, s->rhs);
    ns_linalg_lu_solve(s->lu, 1, s->rhs);
    for (int j = 0; j < s->k; j++)
        s->lambda[s->cols[j]] -= s->rhs[j];
    evaluate_y(s);
}

void ns_mlcp_basis_values(ns_mlcp_solver *s, int refinements) {
    for (int i = 0; i < s->m; i++)
        s->lambda[i] = s->mode[i] == NS_INSIDE ? 0.0 : ns_mlcp_bound(s, i, s->mode[i]);
    evaluate_y(s);
    for (int pass = 0; pass <= refinements && s->k > 0; pass++)
        correct_lambda(s);
}

void ns_mlcp_basis_correct(ns_mlcp_solver *s) {
    evaluate_y(s);
    correct_lambda(s);
}

/* The part of W that column j is in; its first row, where it is empty. */
int ns_mlcp_part_of(const ns_mlcp_solver *s, int j) {
    const double *col = s->p->W + (size_t)j * (size_t)s->m;
    int i = 0;
    while (i < s->m - 1 && col[i] == 0.0)
        i++;
    return s->units.part[col[i] != 0.0 ? i : 0];
}

void ns_mlcp_basis_floor_sizes(ns_mlcp_solver *s) {
    double *norm = s->rhs; /* of a part */
    memset(norm, 0, (size_t)s->m * sizeof *norm);
    for (int j = 0; j < s->m; j++) {
        if (s->lambda[j] == 0.0)
            continue;
        const int part = s->alike ? 0 : ns_mlcp_part_of(s, j);
        norm[part] = fmax(norm[part], fabs(s->lambda[j]) / s->units.column[j]);
    }
    for (int i = 0; i < s->m; i++) {
        s->ysize[i] = fmax(s->ysize[i], FLOOR * norm[s->alike ? 0 : s->units.part[i]] * s->units.rowmax[i]);
        if (!(s->ysize[i] > 0.0))
            s->ysize[i] = s->units.rowmax[i] > 0.0 ? s->units.rowmax[i] : 1.0;
        s->g[i] = 1.0 / s->ysize[i];
    }
}

double ns_mlcp_basis_lambda_size(const ns_mlcp_solver *s, int i) {
    const double top = ns_weighted_max(s->m, s->W + (size_t)i * (size_t)s->m, s->g);
    return top > 0.0 ? 1.0 / top : 1.0;
}

void ns_mlcp_basis_sizes(ns_mlcp_solver *s) {
    for (int i = 0; i < s->m; i++)
        s->ysize[i] = fabs(s->q[i]);
    for (int j = 0; j < s->m; j++) {
        const double *col = s->W + (size_t)j * (size_t)s->m, v = fabs(s->lambda[j]);
        for (int i = 0; i < s->m && v != 0.0; i++)
            s->ysize[i] += fabs(col[i]) * v;
    }
    ns_mlcp_basis_floor_sizes(s);
    for (int a = 0; a < s->np; a++)
        s->lsize[s->pair[a]] = ns_mlcp_basis_lambda_size(s, s->pair[a]);
}

double ns_mlcp_basis_violation(const ns_mlcp_solver *s) {
    double worst = 0.0;
    for (int a = 0; a < s->np; a++) {
        int i = s->pair[a];
        double v;
        if (s->mode[i] == NS_INSIDE)
            v = fmax(s->p->l[i] - s->lambda[i], s->lambda[i] - s->p->u[i]) / s->lsize[i];
        else
            v = (s->mode[i] == NS_LOWER ? -s->y[i] : s->y[i]) / s->ysize[i];
        if (!(v <= worst))
            worst = v;
        if (isnan(v))
            return INFINITY;
    }
    for (int f = 0; f < s->nf; f++)
        if (!isfinite(s->lambda[s->free[f]]))
            return INFINITY;
    return worst;
}

ns_mode ns_mlcp_basis_wanted(const ns_mlcp_solver *s, int i) {
    if (s->mode[i] != NS_INSIDE) {
        const double out = s->mode[i] == NS_LOWER ? -s->y[i] : s->y[i];
        return out > NS_MLCP_GUARD * s->ysize[i] ? NS_INSIDE : s->mode[i];
    }
    if (s->p->l[i] - s->lambda[i] > NS_MLCP_GUARD * s->lsize[i])
        return NS_LOWER;
    return s->lambda[i] - s->p->u[i] > NS_MLCP_GUARD * s->lsize[i] ? NS_UPPER : NS_INSIDE;
}

void ns_mlcp_basis_clamp(ns_mlcp_solver *s) {
    for (int i = 0; i < s->m; i++) {
        s->lambda[i] = fmin(fmax(s->lambda[i], s->p->l[i]), s->p->u[i]);
        if (s->p->l[i] == s->p->u[i])
            continue;
        if (s->mode[i] == NS_INSIDE)
            s->y[i] = 0.0;
        else
            s->y[i] = s->mode[i] == NS_LOWER ? fmax(s->y[i], 0.0) : fmin(s->y[i], 0.0);
    }
}

/* lambda_j of a part that nothing drives may be 0 whatever the mode is. */
static int is_driven(const ns_mlcp_solver *s, int j) {
    const double l = s->p->l[j], u = s->p->u[j];
    if (l == u) /* it is in q */
        return 0;
    if (s->mode[j] != NS_INSIDE)
        return ns_mlcp_bound(s, j, s->mode[j]) != 0.0;
    return l > 0.0 || u < 0.0;
}

void ns_mlcp_basis_zero_undriven(ns_mlcp_solver *s) {
    double *driven = s->rhs;
    if (s->W != s->p->W) /* a copy whose parts are joined */
        return;
    for (int i = 0; i < s->m; i++)
        driven[i] = 0.0;
    for (int i = 0; i < s->m; i++) {
        if (s->q[i] != 0.0)
            driven[s->units.part[i]] = 1.0;
        if (is_driven(s, i))
            driven[ns_mlcp_part_of(s, i)] = 1.0;
    }
    for (int i = 0; i < s->m; i++) {
        if (driven[s->units.part[i]] == 0.0)
            s->y[i] = 0.0;
        if (s->lambda[i] != 0.0 && s->p->l[i] != s->p->u[i] && driven[ns_mlcp_part_of(s, i)] == 0.0)
            s->lambda[i] = 0.0;
    }
}
