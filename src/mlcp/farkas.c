/* src/mlcp/farkas.c - is a ray of Lemke's method a proof that there is no solution?
 *
 * Complementarity left aside, a solution satisfies the linear constraints
 *     y = W lambda + q,  l <= lambda <= u,  y_i = 0 (free),  y_i >= 0 (u = inf),  y_i <= 0 (l = -inf)
 * The tableau in which Lemke's method stopped satisfies them but for t > 0.  From it t is made as small as
 * they allow by the primal simplex method.  If the smallest t is positive, the row of t says
 *     t = beta + sum T[t,c] nonbasic_c,   beta > 0 and no term can be negative,
 * which is Farkas' certificate: no lambda satisfies the constraints, so no solution exists.  Its multipliers
 * are then taken to W and q themselves, so that what is proved (up to rounding, for any W) does not rest on
 * the tableau.  If t reaches 0 nothing is proved - unless W is monotone: then a feasible problem is
 * solvable and Lemke's method would not have ended in a ray.
 */
#include "mlcp_internal.h"

#include <math.h>
#include <string.h>

static const double SMALL = 1e-9;   /* t, in sizes, and sums against their terms: 0 in a proof */
static const double CANCEL = 1e-12; /* coefficients that cancel this far are 0 */

static double lower(const ns_mlcp_solver *s, int var) {
    if (var == 2 * s->np)
        return 0.0;
    if (var % 2 == 0)
        return s->blo[var / 2];
    return isinf(s->bhi[var / 2]) ? 0.0 : -INFINITY;
}

static double upper(const ns_mlcp_solver *s, int var) {
    if (var == 2 * s->np)
        return INFINITY;
    if (var % 2 == 0)
        return s->bhi[var / 2];
    return isinf(s->blo[var / 2]) ? 0.0 : INFINITY;
}

/* The column by which t falls fastest, -1 if there is none; *dir gets the direction. */
static int price(const ns_mlcp_solver *s, int row, double *dir) {
    int best = -1;
    double most = 0.0;
    for (int c = 0; c < s->ncol; c++) {
        int var = s->colvar[c];
        double g = s->T[row + c * s->np];
        if (var == 2 * s->np || !(fabs(g) > most))
            continue;
        int y = var % 2 == 1, fixed_up = !y && s->at_upper[var / 2];
        int may_rise = y ? upper(s, var) > 0.0 : !fixed_up;
        int may_fall = y ? lower(s, var) < 0.0 : fixed_up;
        if ((g < 0.0 && may_rise) || (g > 0.0 && may_fall)) {
            best = c;
            most = fabs(g);
            *dir = g < 0.0 ? 1.0 : -1.0;
        }
    }
    return best;
}

/* The row that stops column col; -1 if its own other bound does. */
static int stop(const ns_mlcp_solver *s, int col, double dir, double *step) {
    int var = s->colvar[col], best = -1;
    const double *e = s->T + (size_t)col * (size_t)s->np;
    *step = var % 2 == 0 ? upper(s, var) - lower(s, var) : INFINITY;
    for (int r = 0; r < s->np; r++) {
        double rate = dir * e[r], bound = rate < 0.0 ? lower(s, s->rowvar[r]) : upper(s, s->rowvar[r]);
        if (rate == 0.0 || isinf(bound))
            continue;
        double at = fmax((bound - s->beta[r]) / rate, 0.0);
        int tie = best >= 0 && at == *step && s->rowvar[r] < s->rowvar[best];
        if (at < *step || tie) {
            *step = at;
            best = r;
        }
    }
    return best;
}

static void step_along(ns_mlcp_solver *s, int col, double dir) {
    double step;
    int var = s->colvar[col], row = stop(s, col, dir, &step);
    const double *e = s->T + (size_t)col * (size_t)s->np;
    double rest = var % 2 == 1 ? 0.0 : s->at_upper[var / 2] ? s->bhi[var / 2] : s->blo[var / 2];
    double rate = row >= 0 ? dir * e[row] : 0.0;
    for (int r = 0; r < s->np; r++)
        s->beta[r] += dir * step * e[r];
    if (row < 0) {
        s->at_upper[var / 2] = (signed char)!s->at_upper[var / 2];
        return;
    }
    int out = s->rowvar[row];
    ns_tableau_exchange(s, row, col);
    s->beta[row] = rest + dir * step;
    if (out % 2 == 0 && out != 2 * s->np)
        s->at_upper[out / 2] = rate > 0.0;
}

/* Lower end of v y over y's sign (lo or hi may be infinite). */
static double least(double v, double lo, double hi) {
    if (v == 0.0)
        return 0.0;
    return v > 0.0 ? v * lo : v * hi;
}

/* s_j = sum_i v_i W_ij; 0 where it is rounding of its terms. */
static double combine(const ns_mlcp_solver *s, const double *v, int j) {
    const double *col = s->W + (size_t)j * (size_t)s->m;
    double sum = 0.0, size = 0.0;
    for (int i = 0; i < s->m; i++) {
        sum += v[i] * col[i];
        size += fabs(v[i] * col[i]);
    }
    return fabs(sum) <= CANCEL * size ? 0.0 : sum;
}

/* The row of t as multipliers v of the equations, and these on their own, from W and q:
 *     0 = sum_i v_i (y_i - q_i) - sum_j s_j lambda_j,   s = W' v
 * cannot hold if the least value of the right-hand side over all allowed y and lambda is positive. */
static int certified(ns_mlcp_solver *s) {
    double *v = s->g, sum = 0.0, size = 0.0;
    for (int i = 0; i < s->k; i++)
        s->rhs[i] = i == s->k - 1 ? 1.0 : 0.0; /* t is the last unknown of G */
    ns_lu_solve_transposed(s->lu, 1, s->rhs);
    memset(v, 0, (size_t)s->m * sizeof *v);
    for (int i = 0; i < s->k; i++)
        v[s->rows[i]] = s->rhs[i];
    for (int a = 0; a < s->np; a++) { /* any v will do: what has the wrong sign is left out */
        int i = s->pair[a];
        if (isinf(least(v[i], lower(s, 2 * a + 1), upper(s, 2 * a + 1))))
            v[i] = 0.0;
    }
    for (int i = 0; i < s->m; i++) {
        sum -= v[i] * s->q[i];
        size += fabs(v[i] * s->q[i]);
    }
    for (int f = 0; f < s->nf; f++)
        if (combine(s, v, s->free[f]) != 0.0)
            return 0;
    for (int a = 0; a < s->np; a++) {
        int j = s->pair[a];
        double part = least(-combine(s, v, j), s->p->l[j], s->p->u[j]);
        sum += part;
        size += fabs(part);
    }
    if (!(sum > SMALL * size))
        return 0;
    memcpy(s->proof, v, (size_t)s->m * sizeof *v);
    return 1;
}

int ns_farkas(ns_mlcp_solver *s) {
    int n = s->np, fresh = 0;
    for (int it = 0; it < PIVOTS_FLAT + PIVOTS_PER_PAIR * n; it++) {
        int row = s->where[2 * n];
        if (row < 0 || s->beta[row] <= SMALL)
            return 0;
        double dir = 1.0;
        int col = price(s, row, &dir);
        if (col >= 0) {
            step_along(s, col, dir);
            fresh = 0;
            continue;
        }
        if (!fresh) { /* on a tableau made anew, refined */
            fresh = s->careful = 1;
            if (ns_tableau_refresh(s) != NS_OK)
                return 0;
            continue;
        }
        if (!certified(s))
            return 0;
        for (int a = 0; a < n; a++)
            s->ray[a] = 0.0;
        for (int c = 0; c < s->ncol; c++)
            if (s->colvar[c] != 2 * n)
                s->ray[s->colvar[c] / 2] = fmax(s->ray[s->colvar[c] / 2], fabs(s->T[row + c * n]));
        ns_mlcp_name(s, s->ray, n, s->pair);
        return 1;
    }
    return 0;
}
