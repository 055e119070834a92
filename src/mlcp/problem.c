/* src/mlcp/problem.c - reading a problem: what is refused, which index is what. */
#include "mlcp_internal.h"

#include <math.h>
#include <string.h>

/* 0 times a finite number is 0, times NaN or infinity NaN. */
static int finite_all(size_t n, const double *a) {
    double s = 0.0;
    for (size_t i = 0; i < n; i++)
        s += 0.0 * a[i];
    return s == 0.0;
}

/* s->given: *p, its columns written down where they are on demand. */
static int take(ns_mlcp_solver *s, const ns_mlcp *p) {
    size_t m = (size_t)p->m;
    s->given = *p;
    if (p->W || m == 0)
        return NS_OK;
    for (int j = 0; j < p->m; j++)
        if (p->column(p->data, j, s->columns + (size_t)j * m) != 0)
            return NS_E_NUMBER;
    s->given.W = s->columns;
    return NS_OK;
}

int ns_mlcp_check(ns_mlcp_solver *s, const ns_mlcp *p) {
    if (p->m < 0 || p->m > s->cap)
        return NS_E_SIZE;
    size_t m = (size_t)p->m;
    if (m > 0 && ((!p->W && !p->column) || !p->q || !p->l || !p->u))
        return NS_E_NULL;
    for (size_t i = 0; i < m; i++) {
        if (isnan(p->l[i]) || isnan(p->u[i]))
            return NS_E_NUMBER;
        if (p->l[i] > p->u[i])
            return NS_E_BOUNDS;
        if (p->l[i] == p->u[i] && isinf(p->l[i]))
            return NS_E_BOUNDS;
    }
    if (!finite_all(m, p->q) || take(s, p) != NS_OK || !finite_all(m * m, s->given.W))
        return NS_E_NUMBER;
    return NS_OK;
}

ns_mode ns_mlcp_mend(const ns_mlcp_solver *s, int i, ns_mode mode) {
    double l = s->p->l[i], u = s->p->u[i];
    if (l == u)
        return NS_LOWER;
    if (isinf(l) && isinf(u))
        return NS_INSIDE;
    if (mode == NS_INSIDE)
        return NS_INSIDE;
    if (mode == NS_UPPER)
        return isinf(u) ? NS_LOWER : NS_UPPER;
    return isinf(l) ? NS_UPPER : NS_LOWER;
}

double ns_mlcp_bound(const ns_mlcp_solver *s, int i, ns_mode mode) {
    return mode == NS_UPPER ? s->p->u[i] : s->p->l[i];
}

/* rowmax and colunit: the units in which floors of sizes are taken (basis.c). */
static void units(ns_mlcp_solver *s) {
    int m = s->m;
    memset(s->rowmax, 0, (size_t)m * sizeof *s->rowmax);
    for (int j = 0; j < m; j++) {
        const double *col = s->p->W + (size_t)j * (size_t)m;
        for (int i = 0; i < m; i++) {
            double a = fabs(col[i]);
            s->rowmax[i] = a > s->rowmax[i] ? a : s->rowmax[i];
        }
    }
    for (int i = 0; i < m; i++) /* as reciprocals for the loop below */
        s->g[i] = s->rowmax[i] > 0.0 ? 1.0 / s->rowmax[i] : 0.0;
    for (int j = 0; j < m; j++) {
        const double *col = s->p->W + (size_t)j * (size_t)m;
        double top = 0.0;
        for (int i = 0; i < m; i++) {
            double a = fabs(col[i]) * s->g[i];
            top = a > top ? a : top;
        }
        s->colunit[j] = top > 0.0 ? 1.0 / top : 1.0;
    }
}

void ns_mlcp_fold(ns_mlcp_solver *s) {
    size_t m = (size_t)s->m;
    s->W = s->now.W;
    if (m > 0)
        memcpy(s->q, s->now.q, m * sizeof *s->q);
    for (int k = 0; k < s->nx; k++) {
        double v = s->p->l[s->fixed[k]];
        if (v != 0.0)
            ns_matvec_add(s->m, 1, s->W + (size_t)s->fixed[k] * m, &v, s->q);
    }
}

void ns_mlcp_given(ns_mlcp_solver *s) {
    s->now = *s->p;
    ns_mlcp_fold(s);
}

void ns_mlcp_restart(ns_mlcp_solver *s, const ns_mode *mode) {
    for (int i = 0; i < s->m; i++)
        s->mode[i] = ns_mlcp_mend(s, i, mode ? mode[i] : NS_LOWER);
}

void ns_mlcp_sort(ns_mlcp_solver *s, const ns_mlcp *p) {
    s->p = p;
    s->m = p->m;
    s->nf = s->np = s->nx = s->nstuck = 0;
    for (int i = 0; i < p->m; i++)
        if (p->l[i] == p->u[i])
            s->fixed[s->nx++] = i;
        else if (isinf(p->l[i]) && isinf(p->u[i]))
            s->free[s->nf++] = i;
        else
            s->pair[s->np++] = i;
    ns_mlcp_given(s);
    units(s);
}
