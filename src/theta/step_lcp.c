/* src/theta/step_lcp.c - the complementarity problem of a step, x and lambda together.
 *
 * Unreduced (P1): unknowns (x, lambda), x with equality rows (bounds -inf, inf):
 *
 *     [ 0 ]   [ W  -h gamma B ] [ x      ]   [ eta + h theta (b + E z) ]
 *     [ y ] = [ C   D         ] [ lambda ] - [ -(F z + e)              ]
 *
 * Reduced to lambda this is y = W_mlcp lambda + q.  Whole, it can be solved where W is singular.
 */
#include "floating_dc.h"
#include "name_fault.h"
#include "regularise.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void form_lcp(ns_theta *s, const double *M, double ht, double hg, const double *z, int size) {
    const int n = s->s->n, m = s->s->m, nz = s->s->nz;
    for (int j = 0; j < size; j++) {
        double *col = s->K + (size_t)j * (size_t)size;
        for (int i = 0; i < size; i++)
            col[i] = 0;
        for (int i = 0; i < n && j < n; i++)
            col[i] = i < s->r && M ? M[i + j * n] - ht * s->A[i + j * n] : -s->A[i + j * n]; /* (T1) */
        for (int i = 0; i < n && j >= n && j < n + m; i++)
            col[i] = -(i < s->r && M ? hg : 1) * s->B[i + (j - n) * n];
        for (int i = 0; i < m && j < n + m; i++)
            col[n + i] = j < n ? s->s->C[i + j * m] : s->s->D[i + (j - n) * m];
    }
    for (int i = 0; i < n; i++) {
        double f = s->b[i];
        for (int k = 0; k < nz; k++)
            f += s->E[i + k * n] * z[k];
        s->rhs[i] = -(i < s->r && M ? ht : 1) * f;
    }
    for (int i = 0; i < m; i++) {
        s->rhs[n + i] = s->s->e[i];
        for (int k = 0; k < nz; k++)
            s->rhs[n + i] += s->s->F[i + k * m] * z[k];
    }
    for (int i = 0; i < size; i++) {
        const int pair = i >= n && i < n + m;
        s->bl[i] = pair ? s->l[i - n] : -INFINITY;
        s->bu[i] = pair ? s->u[i - n] : INFINITY;
        s->lcp_mode[i] = NS_INSIDE;
    }
}

/* h: the length of the step, 1 at the operating point. */
static int solve_lcp(ns_theta *s, double h, int size, ns_mode *mode) {
    const int n = s->s->n, m = s->s->m;
    const ns_mlcp p = {.m = size, .W = s->K, .q = s->rhs, .l = s->bl, .u = s->bu};
    ns_mlcp_info info;
    memset(&info, 0, sizeof info);
    memcpy(s->lcp_mode + n, mode, (size_t)m);
    (void)ns_mlcp_limit(s->mlcp, s->search_left);
    const int status = ns_mlcp_solve(s->mlcp, &p, s->lcp_mode, s->sol, s->resid, &info);
    s->counts.problems++;
    s->counts.pivots += info.pivots;
    s->counts.factors += info.factors;
    s->passing_factors += info.factors;
    s->searched += info.searched;
    s->search_left = info.cut_off ? 0 : s->search_left - info.searched;
    if (status == NS_OK)
        memcpy(mode, s->lcp_mode + n, (size_t)m);
    else
        ns_theta_name_fault(&(ns_fault_context){n, m, s->r, s->T, h}, &p, s->mlcp, &info.fault, s->lu,
                            &s->fault);
    s->fault.status = (ns_status)status;
    return status;
}

/* The same problem with a leak across each pair and a resistance in series with it: lambda is replaced by
 * lambda - g (y - y0), y by y + rho (lambda - lambda0), where y0 and lambda0 are those of the solution in
 * s->resid and s->sol, or those without any voltage (y: vf) and current. */
static void add_leaks(ns_theta *s, double ht, int size, double fraction, int around_last) {
    const int n = s->s->n, m = s->s->m;
    (void)ns_linalg_lu_scale(s->lu, size, s->K);
    for (int j = 0; j < m; j++) {
        const double g = ns_theta_leak_across(s, ht, j, fraction);
        const double off = around_last ? s->rhs[n + j] - s->resid[n + j] : 0;
        for (int i = 0; i < n; i++) {
            const double leak = (i < s->r ? ht : 1) * g * s->B[i + j * n];
            for (int k = 0; k < n && leak != 0; k++)
                s->K[i + k * size] += leak * s->s->C[j + k * m];
            for (int k = 0; k < m && leak != 0; k++)
                s->K[i + (n + k) * size] += leak * s->s->D[j + k * m];
            s->rhs[i] += leak * off;
        }
    }
    for (int j = 0; j < m; j++) {
        const double rho = ns_theta_leak_series(s, n + j, fraction);
        s->K[(n + j) * (size + 1)] += rho;
        s->rhs[n + j] -= around_last ? rho * s->sol[n + j] : 0;
    }
}

static void form_step(ns_theta *s, double h, int implicit) {
    form_lcp(s, s->M, implicit ? h : h * s->theta, implicit ? h : h * s->gamma, s->trial.in + s->r,
             s->s->n + s->s->m);
    for (int i = 0; i < s->r; i++)
        s->rhs[i] -= s->trial.in[i]; /* eta of (T6) */
}

static int solve_step(ns_theta *s, double h, int implicit, double fraction, ns_mode *mode) {
    const int size = s->s->n + s->s->m;
    form_step(s, h, implicit);
    if (fraction > 0)
        add_leaks(s, implicit ? h : h * s->theta, size, fraction, 0);
    return solve_lcp(s, h, size, mode);
}

int ns_theta_lcp_solve(ns_theta *s, double h, int implicit, double fraction) {
    return solve_step(s, h, implicit, fraction, s->trial.mode);
}

int ns_theta_lcp_propose(ns_theta *s, double h, double fraction, const double *w, const double *z,
                         const double *slope, ns_mode *mode) {
    memcpy(s->trial.in, w, sizeof(double) * (size_t)s->r);
    for (int k = 0; k < s->s->nz; k++)
        s->trial.in[s->r + k] = z[k] + (slope ? h * slope[k] : 0);
    return solve_step(s, h, 1, fraction, mode);
}

void ns_theta_lcp_keep(ns_theta *s, double h, int implicit) {
    const int size = s->s->n + s->s->m;
    form_step(s, h, implicit);
    s->failure.size = size;
    s->failure.h = h;
}

int ns_theta_problem(const ns_theta *s, ns_mlcp *p, double *h) {
    if (!s || !p)
        return NS_E_NULL;
    if (!s->failure.size)
        return NS_E_STATE;
    *p = (ns_mlcp){.m = s->failure.size, .W = s->K, .q = s->rhs, .l = s->bl, .u = s->bu};
    if (h)
        *h = s->failure.h;
    return NS_OK;
}

/* Holding node voltage x_i takes one more unknown, the current that does it, in x_i's own KCL row. */
static void form_dc(ns_theta *s, const double *z, int nhold, const int *hold, const double *hold_x) {
    const int n = s->s->n, m = s->s->m, size = n + m + nhold;
    form_lcp(s, NULL, 0, 0, z, size);
    for (int k = 0; k < nhold; k++) {
        double *col = s->K + (size_t)(n + m + k) * (size_t)size;
        for (int i = 0; i < n; i++)
            col[i] = -s->T[i + hold[k] * n];
        s->K[(n + m + k) + hold[k] * size] = 1;
        s->rhs[n + m + k] = -hold_x[k];
    }
}

static double residual(const ns_theta *s, int size) {
    const ns_mlcp p = {.m = size, .W = s->K, .q = s->rhs, .l = s->bl, .u = s->bu};
    return ns_mlcp_residual(&p, s->sol, NULL);
}

/* 1 if the answer with leaks is one of the exact problem, if need be after what is rounding beside the
 * largest unknown was set to zero: a row that has nothing else in it allows no rounding. */
static int is_exact(ns_theta *s, int size) {
    static const double good = 1e-12, rounding = 1e-15;
    if (residual(s, size) < good)
        return 1;
    (void)ns_linalg_lu_scale(s->lu, size, s->K);
    const double largest = ns_linalg_lu_largest(s->lu, s->sol), *unit = ns_linalg_lu_units(s->lu);
    for (int i = 0; i < size; i++)
        if (fabs(s->sol[i]) <= rounding * largest * unit[i])
            s->sol[i] = 0;
    return residual(s, size) < good;
}

static int leaves_open(ns_theta *s, int size) {
    static const double least = 1e-13;
    double rcond;
    return ns_linalg_lu_factor(s->lu, size, s->K, &rcond) != NS_OK || rcond < least;
}

/* One round of go_rounds_of_leaks(), with leaks of this fraction.  *open: 1 if the matrix of the first round
 * is singular, so that parts float; later rounds keep that. */
static int go_round_of_leaks(ns_theta *s, const double *z, int nhold, const int *hold, const double *hold_x,
                             ns_floating_parts *parts, double fraction, int first, int *open, ns_mode *mode) {
    const int size = s->s->n + s->s->m + nhold;
    int status = NS_OK;
    form_dc(s, z, nhold, hold, hold_x);
    add_leaks(s, 1, size, fraction, !first);
    if (first)
        *open = leaves_open(s, size);
    if (*open)
        status = ns_theta_floating_dc(s, nhold, hold, parts);
    if (status == NS_OK)
        status = solve_lcp(s, 1, size, mode);
    if (status == NS_OK)
        form_dc(s, z, nhold, hold, hold_x);
    return status;
}

/* At the operating point an inductor is a short: how it shares a current with a closed switch is
 * undetermined, and all of it flows in the inductor when the switch has any resistance.  So the problem is
 * solved again with leaks: around zero, which determines everything, then twice or more around the answer so
 * far, which leaves the square, the cube, and so on, of their fraction on the rest.  Beside 10 Mohm, which
 * alone may hold a part where others are 10 mohm, leaks are no small fraction: rounds go on while they gain,
 * then with smaller leaks, then with none.  What leaks leave open too floats.  If there is no such answer the
 * exact one is kept. */
static int go_rounds_of_leaks(ns_theta *s, const double *z, int nhold, const int *hold, const double *hold_x,
                              ns_floating_parts *parts, ns_mode *mode) {
    enum { LEAST_ROUNDS = 3, USUAL_ROUNDS = 6, MOST_ROUNDS = 24 };
    static const double gain = 0.25, smaller = 1.0 / 1024, least = 1e-10;
    const int size = s->s->n + s->s->m + nhold;
    int open = 0;
    double fraction = 1e-8, last = INFINITY;
    for (int round = 1; round <= MOST_ROUNDS; round++) {
        const int status =
            go_round_of_leaks(s, z, nhold, hold, hold_x, parts, fraction, round == 1, &open, mode);
        if (status != NS_OK)
            return status;
        if (round >= LEAST_ROUNDS && is_exact(s, size))
            return NS_OK;
        const double now = residual(s, size);
        if (round >= USUAL_ROUNDS && !(now < gain * last)) {
            if (fraction == 0)
                break;
            fraction = fraction > least ? smaller * fraction : 0;
        }
        last = now;
    }
    return NS_E_RESIDUAL;
}

static int find_dc_of_leaks(ns_theta *s, const double *z, int nhold, const int *hold, const double *hold_x,
                            ns_mode *mode) {
    ns_floating_parts parts = {0};
    const int status = go_rounds_of_leaks(s, z, nhold, hold, hold_x, &parts, mode);
    free(parts.null);
    return status;
}

int ns_theta_lcp_dc(ns_theta *s, const double *z, int nhold, const int *hold, const double *hold_x,
                    ns_mode *mode, double *x) {
    const int n = s->s->n, size = n + s->s->m + nhold;
    ns_theta_forget_failure(s);
    if (ns_theta_reserve(s, nhold) != NS_OK)
        return NS_E_MEMORY;
    form_dc(s, z, nhold, hold, hold_x);
    const int status = solve_lcp(s, 1, size, mode);
    if (status != NS_OK) {
        s->failure.size = size;
        s->failure.h = 0;
        return status;
    }
    memcpy(x, s->sol, sizeof(double) * (size_t)n);
    memcpy(s->trial.mode, mode, (size_t)s->s->m);
    if (find_dc_of_leaks(s, z, nhold, hold, hold_x, s->trial.mode) == NS_OK) {
        memcpy(x, s->sol, sizeof(double) * (size_t)n);
        memcpy(mode, s->trial.mode, (size_t)s->s->m);
    }
    return NS_OK;
}
