/* src/mlcp/optional/scaled.c - a problem in units in which the iterative methods work, and the way back from
 * there.
 *
 * Rows and columns of W are scaled by powers of two (equilibrate.h), and q by one more, so that the size of
 * y at the start is 1.  A pair's law does not care: lambda and y may each have a unit of its own.
 */
#include "scaled.h"

#include <float.h>
#include <math.h>

#include "mlcp/verify/residual.h"

enum { CORRECTIONS = 5 };
static const double FAR = 1e12;   /* of a lambda, in units in which q and W are about 1 */
static const double NEAR = 1e-10; /* of an y that should be 0 */
static const double RIDGE = 1e-8; /* of entries of about 1: half of the digits */

int ns_mlcp_scaled_law(const ns_scaled *z, int i) {
    if (z->l[i] == z->u[i])
        return NS_LAW_FIXED;
    if (isinf(z->l[i]))
        return isinf(z->u[i]) ? NS_LAW_FREE : NS_LAW_UPPER;
    return isinf(z->u[i]) ? NS_LAW_LOWER : NS_LAW_BOX;
}

void ns_mlcp_scaled_product(ns_scaled *z) {
    ns_linalg_copy((size_t)z->m, z->q, z->y);
    ns_linalg_matvec_add(z->m, z->m, z->W, z->x, z->y);
}

static void share_out(ns_mlcp_solver *s, ns_scaled *z) {
    size_t m = (size_t)s->m;
    double **in_xs[] = {&z->q, &z->l, &z->u, &z->x, &z->y, &z->work[0]};
    for (size_t k = 0; k < sizeof in_xs / sizeof *in_xs; k++)
        *in_xs[k] = s->xs + k * m;
    z->m = s->m;
    z->W = s->tab.T;
    z->rs = s->tab.lo;
    z->cs = s->tab.hi;
    z->work[1] = s->tab.beta;
    z->work[2] = s->tab.cover;
    z->work[3] = s->ray;
    z->work[4] = s->tab.unit;
    z->work[5] = s->tab.unit + m;
}

/* l, u, x in units of cs. */
static void scale_bounds(const ns_mlcp_solver *s, ns_scaled *z) {
    for (int i = 0; i < z->m; i++) {
        double l = s->p->l[i], u = s->p->u[i];
        int fixed = l == u;
        z->l[i] = fixed ? 0.0 : l / z->cs[i];
        z->u[i] = fixed ? 0.0 : u / z->cs[i];
        z->x[i] = fmin(fmax(0.0, z->l[i]), z->u[i]);
    }
}

void ns_mlcp_scaled_load(ns_mlcp_solver *s, ns_scaled *z) {
    int m = s->m;
    double *rs = s->tab.lo, *cs = s->tab.hi, size = 0.0;
    share_out(s, z);
    ns_linalg_equilibrate(m, s->W, m, s->elim.row_exp, s->elim.col_exp, s->elim.e);
    for (int i = 0; i < m; i++) {
        rs[i] = ldexp(1.0, s->elim.row_exp[i]);
        cs[i] = ldexp(1.0, s->elim.col_exp[i]);
        z->q[i] = rs[i] * s->q[i];
    }
    for (int j = 0; j < m; j++)
        for (int i = 0; i < m; i++) {
            size_t k = (size_t)i + (size_t)j * (size_t)m;
            z->W[k] = s->W[k] * rs[i] * cs[j];
        }
    scale_bounds(s, z);
    ns_mlcp_scaled_product(z);
    for (int i = 0; i < m; i++)
        size = fmax(size, fabs(z->y[i]));
    if (!(size > 0.0))
        return;
    int e;
    (void)frexp(size, &e);
    for (int i = 0; i < m; i++) { /* W as it is; q, x and y in units of size */
        rs[i] = ldexp(rs[i], -e);
        cs[i] = ldexp(cs[i], e);
        z->q[i] = ldexp(z->q[i], -e);
    }
    scale_bounds(s, z);
    ns_mlcp_scaled_product(z);
}

int ns_mlcp_scaled_start(ns_mlcp_solver *s, ns_scaled *z) {
    const double sound = 1e-10; /* a start that has lost more digits is no better than none */
    double rcond;
    if (ns_mlcp_basis_factor(s, &rcond) != NS_OK || rcond < sound)
        return 0;
    ns_mlcp_basis_values(s, 0);
    for (int i = 0; i < z->m; i++) {
        if (!isfinite(s->lambda[i]))
            return 0;
        z->x[i] = fmin(fmax(s->lambda[i] / z->cs[i], z->l[i]), z->u[i]);
    }
    ns_mlcp_scaled_product(z);
    return 1;
}

void ns_mlcp_scaled_mode(ns_mlcp_solver *s, const ns_scaled *z, const double *x, const double *y) {
    for (int i = 0; i < z->m; i++) {
        ns_mode mode = NS_INSIDE;
        if (x[i] - z->l[i] < y[i])
            mode = NS_LOWER;
        else if (z->u[i] - x[i] < -y[i])
            mode = NS_UPPER;
        s->mode[i] = ns_mlcp_fit_mode(s, i, mode);
    }
}

/* s->lambda in s->mode: at its bound, or from x. */
static void lambda_of(ns_mlcp_solver *s, const ns_scaled *z, const double *x) {
    for (int i = 0; i < z->m; i++)
        if (s->mode[i] == NS_INSIDE)
            s->lambda[i] = fmin(fmax(x[i] * z->cs[i], s->p->l[i]), s->p->u[i]);
        else
            s->lambda[i] = ns_mlcp_bound(s, i, s->mode[i]);
}

/* rhs = y of s->lambda, scaled. */
static void residual_scaled(ns_mlcp_solver *s, const ns_scaled *z) {
    ns_linalg_copy((size_t)z->m, s->q, s->rhs);
    for (int i = 0; i < z->m; i++)
        s->g[i] = z->l[i] == z->u[i] ? 0.0 : s->lambda[i];
    ns_linalg_matvec_add(z->m, z->m, s->W, s->g, s->rhs);
    for (int i = 0; i < z->m; i++)
        s->rhs[i] *= z->rs[i];
}

/* 1 if y of the equations is small only beside a lambda that ran away: equations that contradict do that to
 * an iteration that regularises them.  q is about 1. */
static int ran_away(ns_mlcp_solver *s, const ns_scaled *z) {
    double top = 0.0, most = 0.0;
    residual_scaled(s, z);
    for (int i = 0; i < z->m; i++) {
        if (z->l[i] == z->u[i])
            continue;
        top = fmax(top, fabs(s->lambda[i] / z->cs[i]));
        most = fmax(most, s->mode[i] == NS_INSIDE ? fabs(s->rhs[i]) : 0.0);
    }
    return !(top < FAR) || most > fmax(NEAR, 1e2 * DBL_EPSILON * top);
}

/* Natural residual of s->lambda; infinite where it is not to be believed. */
static double measure_scaled(ns_mlcp_solver *s, const ns_scaled *z) {
    if (ran_away(s, z))
        return INFINITY;
    return ns_mlcp_measure(&s->now, s->lambda, s->alike, s->rhs, NULL);
}

/* W of the lambda inside + ridge I into G, the other rows those of I; its factors. */
static int factor_ridged(ns_mlcp_solver *s, const ns_scaled *z) {
    size_t m = (size_t)z->m;
    for (size_t j = 0; j < m; j++)
        for (size_t i = 0; i < m; i++) {
            int inside = s->mode[i] == NS_INSIDE && s->mode[j] == NS_INSIDE;
            s->G[i + j * m] = (inside ? z->W[i + j * m] : 0.0) + (i == j ? (inside ? RIDGE : 1.0) : 0.0);
        }
    return ns_mlcp_basis_factor_of(s, z->m, s->G, NULL);
}

/* lambda less (W + ridge)^-1 y: a step of the proximal point method, which redundant equations do not
 * disturb. */
static void correct_proximal(ns_mlcp_solver *s, const ns_scaled *z) {
    residual_scaled(s, z);
    for (int i = 0; i < z->m; i++)
        s->rhs[i] *= s->mode[i] == NS_INSIDE ? 1.0 : 0.0;
    ns_linalg_lu_solve(s->lu, 1, s->rhs);
    for (int i = 0; i < z->m; i++)
        if (s->mode[i] == NS_INSIDE)
            s->lambda[i] = fmin(fmax(s->lambda[i] - s->rhs[i] * z->cs[i], s->p->l[i]), s->p->u[i]);
}

/* s->lambda and s->mode are those of x, or near it. */
static int finish_at_lambda(ns_mlcp_solver *s, const ns_scaled *z, int status) {
    double now = measure_scaled(s, z);
    if (now <= NS_MLCP_ACCEPT || status != NS_E_SINGULAR || factor_ridged(s, z) != NS_OK)
        return now <= NS_MLCP_ACCEPT ? NS_OK : status;
    for (int k = 0; k < CORRECTIONS; k++) {
        correct_proximal(s, z);
        if (measure_scaled(s, z) <= NS_MLCP_ACCEPT)
            return NS_OK;
    }
    return status;
}

int ns_mlcp_scaled_finish(ns_mlcp_solver *s, const ns_scaled *z, const double *x, const double *y) {
    ns_mlcp_scaled_mode(s, z, x, y);
    int status = ns_mlcp_crossover(s);
    if (status == NS_OK)
        return NS_OK;
    ns_mlcp_scaled_mode(s, z, x, y);
    lambda_of(s, z, x);
    status = finish_at_lambda(s, z, status);
    if (status != NS_OK)
        ns_mlcp_zeros_note(s);
    return status;
}
