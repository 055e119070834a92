/* src/newton/linearised_lcp.c - the linearised problem of one Newton iteration.
 *
 * Unreduced, with x as rows of equalities (dx = x+ - x, dl = lambda+ - lambda, and fraction = 1 for a full
 * step):
 *
 *     0       = W dx - h gamma B dl + fraction R
 *     y+      = C dx +         D dl + y - fraction Ry,       -y+ in N_[l,u](lambda+)
 *
 * Where W is regular it is reduced to the pairs by (T3), (T4), (T5): with V = W^-1 h gamma B
 *
 *     x_p     = x - W^-1 fraction R - V lambda
 *     y+      = y - fraction Ry + C (x_p - x) - D lambda + (D + C V) lambda+
 *
 * which is the form of the documents, for R + h gamma B lambda is the bracket of (T3) and y - Ry is h.  In
 * circuits whose devices all block W is singular and the whole is not.  Fractions below 1 are points on the
 * way to the full step on which (S4) holds and the residuals are the rest, 1-fraction, to first order
 * (Ralph's path search): kinks on the way do not show.
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "linalg/column_scaling.h"
#include "newton_internal.h"
#include "theta/name_fault.h"

/* Below, W is not inverted: the unreduced problem loses fewer digits. */
static const double rcond_min = 1e-6;
/* Terms below this part of what the largest unknown could make of a row count as that: 1e-12 of it, the
 * tolerance, is then some eps of the largest unknown, which is what rounding leaves of one that is zero. */
static const double floor_fraction = 1e-3;

void ns_newton_form(ns_newton *s) {
    const int n = s->n, m = s->m, all = n + m;
    for (int j = 0; j < n; j++) {
        double *col = s->G + (size_t)j * (size_t)all;
        for (int i = 0; i < n; i++) {
            const double a = s->A[i + j * n], k = s->K[i + j * n];
            const double w = i < s->rank ? s->M[i + j * n] - s->ht * a - s->hk * k : -s->cx * (a + k);
            s->W[i + j * n] = col[i] = w; /* (T1) */
        }
        for (int i = 0; i < m; i++)
            col[n + i] = s->cx * s->C[i + j * m];
    }
    for (int j = 0; j < m; j++) {
        double *col = s->G + (size_t)(n + j) * (size_t)all;
        for (int i = 0; i < n; i++)
            col[i] = -(i < s->rank ? s->hg : 1) * s->B[i + j * n];
        memcpy(col + n, s->D + (size_t)j * (size_t)m, sizeof(double) * (size_t)m);
    }
}

/* The terms that are no unknown's: of R and of Ry. */
static void find_other_terms(ns_newton *s, const ns_iterate *at) {
    const int n = s->n;
    for (int i = 0; i < n; i++) {
        const int d = i < s->rank;
        double sum = (d ? s->ht : 1) * fabs(at->f[i]) + (d ? s->hg : 1) * fabs(at->g[i]);
        for (int j = 0; j < n && d; j++)
            sum += fabs(s->M[i + j * n] * s->from[j]);
        s->ext[i] = sum + (d ? fabs(s->past[i]) : 0);
    }
    for (int i = 0; i < s->m; i++)
        s->ext[n + i] = fabs(at->y[i]) + fabs(at->h[i]);
}

static double value_of(const ns_newton *s, const ns_iterate *at, int j) {
    return j < s->n ? at->x[j] : at->lambda[j - s->n];
}

static double start_value(const ns_newton *s, int j) {
    return j < s->n ? s->guess[j] : s->lk[j - s->n];
}

/* largest (n+m): of a row, what the largest unknown of its part of the system is there, a part being the rows
 * and columns that entries of G join: the units of another part say nothing.  Or of the whole system. */
static void find_largest_terms(const ns_newton *s, int whole, const double *size_of, const double *top,
                               double *largest) {
    const int all = s->n + s->m;
    memset(largest, 0, sizeof(double) * (size_t)all);
    for (int j = 0; j < all; j++) {
        const double *col = s->G + (size_t)j * (size_t)all;
        double fraction = 0;
        int in = 0;
        for (int i = 0; i < all; i++)
            if (fabs(col[i]) > fraction * top[i]) {
                fraction = fabs(col[i]) / top[i];
                in = i;
            }
        largest[in] = fmax(largest[in], fraction * size_of[j]);
    }
    if (!whole)
        ns_linalg_spread(all, s->G, largest, s->bu);
    for (int i = 1; i < all && whole; i++)
        largest[0] = fmax(largest[0], largest[i]);
    for (int i = 1; i < all && whole; i++)
        largest[i] = largest[0];
}

void ns_newton_sizes(ns_newton *s, const ns_iterate *at, double of_start, int whole) {
    const int all = s->n + s->m;
    double *top = s->other, *size_of = s->sol, *largest = s->bl;
    find_other_terms(s, at);
    for (int j = 0; j < all; j++)
        size_of[j] = fmax(fabs(value_of(s, at, j)), of_start * fabs(start_value(s, j)));
    for (int i = 0; i < all; i++) {
        s->size[i] = s->ext[i];
        top[i] = 0;
        for (int j = 0; j < all; j++) {
            const double entry = fabs(s->G[i + j * all]);
            s->size[i] += entry * size_of[j];
            top[i] = fmax(top[i], entry);
        }
    }
    find_largest_terms(s, whole, size_of, top, largest);
    for (int i = 0; i < all; i++) /* never infinite: all is small beside that */
        s->size[i] = fmin(fmax(s->size[i], floor_fraction * largest[i] * top[i]), DBL_MAX);
}

int ns_newton_reduce(ns_newton *s) {
    const int n = s->n, m = s->m;
    double rcond = 0;
    s->counts.factors++;
    const int status = ns_linalg_lu_factor(s->lu, n, s->W, &rcond);
    s->reduced = status == NS_OK && rcond >= rcond_min;
    if (status != NS_OK && status != NS_E_SINGULAR)
        return status;
    if (!s->reduced)
        return NS_OK;
    for (int j = 0; j < m; j++)
        for (int i = 0; i < n; i++)
            s->V[i + j * n] = -s->G[i + (n + j) * (n + m)];
    ns_linalg_lu_solve(s->lu, m, s->V);
    memcpy(s->Wm, s->D, sizeof(double) * (size_t)m * (size_t)m);
    for (int j = 0; j < m; j++) {
        for (int i = 0; i < n; i++)
            s->work[i] = s->cx * s->V[i + j * n];
        ns_linalg_matvec_add(m, n, s->C, s->work, s->Wm + (size_t)j * (size_t)m); /* (P1) */
    }
    return NS_OK;
}

/* The solver's indices are pairs, or (x, lambda), where s->lu is free for work. */
static void name_fault(ns_newton *s, const ns_mlcp *p, const ns_fault *from) {
    const ns_fault_context b = {p->m - s->m, s->m, s->rank, s->T, fmax(s->ht, s->hg)};
    ns_theta_name_fault(&b, p, s->mlcp, from, s->lu, &s->fault);
}

static int solve_lcp(ns_newton *s, const ns_mlcp *p, ns_mode *mode, double *lambda, double *y) {
    ns_mlcp_info info;
    memset(&info, 0, sizeof info);
    const int status = ns_mlcp_solve(s->mlcp, p, mode, lambda, y, &info);
    s->counts.problems++;
    s->counts.pivots += info.pivots;
    s->counts.factors += info.factors;
    if (status != NS_OK)
        name_fault(s, p, &info.fault);
    return status;
}

static int solve_reduced(ns_newton *s, double fraction, ns_mode *mode) {
    const int n = s->n, m = s->m;
    const ns_iterate *at = &s->at;
    double *dx = s->work, *moved = s->work + n;
    for (int i = 0; i < n; i++)
        dx[i] = -fraction * at->R[i];
    ns_linalg_lu_solve(s->lu, 1, dx); /* (T3): x_p - x = dx - V lambda */
    for (int i = 0; i < n; i++)
        s->xr[i] = s->cx * dx[i];
    ns_linalg_matvec(m, m, s->Wm, at->lambda, moved);
    for (int i = 0; i < m; i++)
        s->q[i] = at->y[i] - fraction * at->Ry[i] - moved[i];
    ns_linalg_matvec_add(m, n, s->C, s->xr, s->q); /* (T5) */
    const ns_mlcp p = {.m = m, .W = s->Wm, .q = s->q, .l = s->model->l, .u = s->model->u};
    const int status = solve_lcp(s, &p, mode, s->next.lambda, s->next.y);
    if (status != NS_OK)
        return status;
    for (int i = 0; i < m; i++)
        moved[i] = s->next.lambda[i] - at->lambda[i];
    ns_linalg_matvec_add(n, m, s->V, moved, dx);
    for (int i = 0; i < n; i++)
        s->next.x[i] = at->x[i] + dx[i]; /* (T4) */
    return NS_OK;
}

static int solve_whole(ns_newton *s, double fraction, ns_mode *mode) {
    const int n = s->n, m = s->m, all = n + m;
    for (int j = 0; j < all; j++)
        s->other[j] = -value_of(s, &s->at, j);
    ns_linalg_matvec(all, all, s->G, s->other, s->sol);
    for (int i = 0; i < all; i++) {
        const int pair = i >= n;
        s->sol[i] += pair ? s->at.y[i - n] - fraction * s->at.Ry[i - n] : fraction * s->at.R[i];
        s->bl[i] = pair ? s->model->l[i - n] : -INFINITY;
        s->bu[i] = pair ? s->model->u[i - n] : INFINITY;
        s->all_mode[i] = pair ? mode[i - n] : NS_INSIDE;
    }
    const ns_mlcp p = {.m = all, .W = s->G, .q = s->sol, .l = s->bl, .u = s->bu};
    const int status = solve_lcp(s, &p, s->all_mode, s->other, s->ext);
    if (status != NS_OK)
        return status;
    memcpy(s->next.x, s->other, sizeof(double) * (size_t)n);
    memcpy(s->next.lambda, s->other + n, sizeof(double) * (size_t)m);
    memcpy(s->next.y, s->ext + n, sizeof(double) * (size_t)m);
    memcpy(mode, s->all_mode + n, (size_t)m);
    return NS_OK;
}

int ns_newton_solve(ns_newton *s, double fraction, ns_mode *mode) {
    return s->reduced ? solve_reduced(s, fraction, mode) : solve_whole(s, fraction, mode);
}
