/* src/mlcp/problem.c - reading a problem: what is refused, which index is what. */
#include "mlcp_internal.h"

#include <math.h>
#include <string.h>

#include "linalg/column_scaling.h"

int ns_mlcp_check_bounds(const ns_mlcp *p) {
    int status = NS_OK;
    for (int i = 0; i < p->m; i++) {
        if (isnan(p->l[i]) || isnan(p->u[i]))
            return NS_E_NUMBER;
        if (p->l[i] > p->u[i] || (p->l[i] == p->u[i] && isinf(p->l[i])))
            status = NS_E_BOUNDS;
    }
    return status;
}

/* Which index is what, from s->given. */
static void sort_indices(ns_mlcp_solver *s) {
    const ns_mlcp *p = &s->given;
    s->m = p->m;
    s->nf = s->np = s->nx = 0;
    s->at_zero = 1;
    s->p = p;
    for (int i = 0; i < p->m; i++) {
        s->at_zero &= (p->l[i] == 0.0 || isinf(p->l[i])) && (p->u[i] == 0.0 || isinf(p->u[i]));
        s->lowest[i] = ns_mlcp_fit_mode(s, i, NS_LOWER);
        if (p->l[i] == p->u[i])
            s->fixed[s->nx++] = i;
        else if (isinf(p->l[i]) && isinf(p->u[i]))
            s->free[s->nf++] = i;
        else
            s->pair[s->np++] = i;
    }
}

static int same_bounds(const ns_mlcp_solver *s, const ns_mlcp *p) {
    const size_t m = (size_t)p->m;
    return memcmp(p->l, s->own.l, m * sizeof *p->l) == 0 && memcmp(p->u, s->own.u, m * sizeof *p->u) == 0;
}

/* Whether W, l and u are those of the last problem: promised, or seen. */
static int is_known(const ns_mlcp_solver *s, const ns_mlcp *p) {
    const size_t m = (size_t)p->m;
    if (!s->own.known || p->m != s->m || (!p->W) != s->own.on_demand)
        return 0;
    if (s->same)
        return 1;
    return p->W && same_bounds(s, p) && memcmp(p->W, s->own.W, m * m * sizeof *p->W) == 0;
}

/* Keeps l and u. */
static int copy_bounds(ns_mlcp_solver *s, const ns_mlcp *p) {
    const size_t m = (size_t)p->m;
    const int status = ns_mlcp_check_bounds(p);
    if (status != NS_OK)
        return status;
    memcpy(s->own.l, p->l, m * sizeof *p->l);
    memcpy(s->own.u, p->u, m * sizeof *p->u);
    s->given.m = p->m;
    sort_indices(s);
    return NS_OK;
}

/* Keeps W, l and u. */
static int copy_problem(ns_mlcp_solver *s, const ns_mlcp *p) {
    const size_t m = (size_t)p->m;
    const int alike = s->own.known && p->m == s->m, sorted = alike && same_bounds(s, p);
    s->own.known = s->units.valid = s->scale.valid = s->transform.valid = s->transform.settled =
        s->factored.valid = 0;
    const int status = sorted ? NS_OK : copy_bounds(s, p);
    if (status != NS_OK)
        return status;
    s->own.on_demand = !p->W;
    s->own.nonzeros.few &= alike && p->W;
    if (p->W) {
        if (!ns_linalg_finite(m * m, p->W))
            return NS_E_NUMBER;
        if (!s->own.nonzeros.few || !ns_mlcp_nonzeros_fit(p->m, p->W, &s->own.nonzeros))
            ns_mlcp_nonzeros_find(p->m, p->W, &s->own.nonzeros);
        memcpy(s->own.W, p->W, m * m * sizeof *p->W);
    }
    memset(s->own.have, p->W != NULL, m);
    s->own.missing = p->W ? 0 : p->m;
    s->own.known = 1;
    return NS_OK;
}

int ns_mlcp_load(ns_mlcp_solver *s, const ns_mlcp *p) {
    s->proof.found = 0;
    if (p->m < 0 || p->m > s->cap)
        return NS_E_SIZE;
    size_t m = (size_t)p->m;
    if (m > 0 && ((!p->W && !p->column) || !p->q || !p->l || !p->u))
        return NS_E_NULL;
    if (!ns_linalg_finite(m, p->q))
        return NS_E_NUMBER;
    s->given = (ns_mlcp){p->m, s->own.W, m > 0 ? p->q : s->q, s->own.l, s->own.u, p->column, p->data};
    int status = m == 0 || is_known(s, p) ? NS_OK : copy_problem(s, p);
    s->m = p->m;
    if (m == 0)
        s->own.known = s->transform.settled = s->nf = s->np = s->nx = 0;
    return status;
}

/* Column j of Wown.  Errors: NUMBER. */
static int fetch_column(ns_mlcp_solver *s, int j) {
    const size_t m = (size_t)s->m;
    double *w = s->own.W + (size_t)j * m;
    if (s->own.have[j])
        return NS_OK;
    if (s->given.column(s->given.data, j, w) != 0 || !ns_linalg_finite(m, w)) {
        s->own.known = 0;
        return NS_E_NUMBER;
    }
    s->own.have[j] = 1;
    s->own.missing--;
    s->units.valid = s->scale.valid = 0;
    return NS_OK;
}

/* All but those of lambda given as 0, which are needed nowhere. */
int ns_mlcp_fetch_all(ns_mlcp_solver *s) {
    for (int j = 0; j < s->m && s->own.missing > 0; j++)
        if (s->own.l[j] == 0.0 && s->own.u[j] == 0.0)
            memset(s->own.W + (size_t)j * (size_t)s->m, 0, (size_t)s->m * sizeof *s->own.W);
        else if (fetch_column(s, j) != NS_OK)
            return NS_E_NUMBER;
    return NS_OK;
}

/* Which rows are joined. */
static void find_parts(ns_mlcp_solver *s) {
    for (int i = 0; i < s->m; i++)
        s->g[i] = i;
    ns_linalg_spread(s->m, s->p->W, s->g, s->rhs);
    for (int i = 0; i < s->m; i++)
        s->units.part[i] = (int)s->g[i];
}

/* part, rowmax and colunit: the units in which floors of sizes are taken (basis.c). */
void ns_mlcp_units(ns_mlcp_solver *s) {
    int m = s->m;
    if (s->units.valid)
        return;
    s->units.valid = 1;
    find_parts(s);
    memset(s->units.rowmax, 0, (size_t)m * sizeof *s->units.rowmax);
    if (s->alike)
        for (int j = 0; j < m; j++)
            s->units.column[j] = 1.0;
    else
        ns_linalg_column_scaling(m, s->p->W, s->units.column, s->rhs);
    for (int j = 0; j < m; j++) {
        const double *col = s->p->W + (size_t)j * (size_t)m;
        for (int i = 0; i < m; i++) {
            double a = fabs(col[i]) * s->units.column[j];
            s->units.rowmax[i] = a > s->units.rowmax[i] ? a : s->units.rowmax[i];
        }
    }
    for (int i = 0; i < m; i++) /* as reciprocals for the loop below */
        s->g[i] = s->units.rowmax[i] > 0.0 ? 1.0 / s->units.rowmax[i] : 0.0;
    for (int j = 0; j < m; j++) {
        const double *col = s->p->W + (size_t)j * (size_t)m;
        double top = 0.0;
        for (int i = 0; i < m; i++) {
            double a = fabs(col[i]) * s->g[i];
            top = a > top ? a : top;
        }
        s->units.column[j] = top > 0.0 ? 1.0 / top : 1.0;
    }
}

void ns_mlcp_fold(ns_mlcp_solver *s) {
    if (s->now.W != s->own.W)
        s->factored.valid = 0;
    size_t m = (size_t)s->m;
    s->W = s->now.W;
    ns_linalg_copy(m, s->now.q, s->q);
    for (int k = 0; k < s->nx; k++) {
        double v = s->p->l[s->fixed[k]];
        if (v != 0.0)
            ns_linalg_matvec_add(s->m, 1, s->W + (size_t)s->fixed[k] * m, &v, s->q);
    }
}

void ns_mlcp_take_given(ns_mlcp_solver *s) {
    s->now = *s->p;
    ns_mlcp_fold(s);
}

void ns_mlcp_start_from(ns_mlcp_solver *s, const ns_mode *mode) {
    if (!mode || memcmp(mode, s->lowest, (size_t)s->m) == 0) {
        memcpy(s->mode, s->lowest, (size_t)s->m);
        return;
    }
    for (int i = 0; i < s->m; i++)
        s->mode[i] = ns_mlcp_fit_mode(s, i, mode[i]);
}
