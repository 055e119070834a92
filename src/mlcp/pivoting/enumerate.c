/* src/mlcp/pivoting/enumerate.c - every mode in turn: the oracle.
 *
 * For every set of pairs that are inside, in an order in which one pair changes at a time (Gray), the
 * equations are factored once.  Of the other pairs those with two bounds are taken through all combinations
 * of them, again one at a time: lambda and y change by a column each.  A mode whose equations are singular
 * may have solutions all the same, which this does not see: those are left to branch_and_bound.c, as are
 * problems too large for this.
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "mlcp/infeasible/branch_and_bound.h"

static const double RCOND = 1e-12; /* equations worse than this are looked at, but count as singular */
static const double WORST =
    1e-15; /* and worse than this they are not looked at: anything would seem an answer */
static const double LOOSE = 1e-8; /* guards broken by more, against the largest terms there are, are broken */
static const double GOOD = 1e-12; /* an answer as good as this ends the search */
static const double COSTLY = 1e9; /* multiplications: some two seconds */

typedef struct tally {
    double best;  /* residual of the best answer so far */
    double qtop;  /* largest |q_i| / rowmax_i */
    int doubtful; /* sets of pairs whose equations are singular, or nearly; modes whose numbers no double
                     holds, too large or too small */
} tally;

static int two_bounds(const ns_mlcp_solver *s, int i) {
    return isfinite(s->p->l[i]) && isfinite(s->p->u[i]);
}

/* 0 if a guard is broken by more than rounding could do.  Sizes are estimated from above, which
 * is cheap: |W_ij lambda_j| <= rowmax_i |lambda_j| / colunit_j. */
static int is_plausible(const ns_mlcp_solver *s, double qtop) {
    double norm = 0.0;
    for (int j = 0; j < s->m; j++)
        norm = fmax(norm, fabs(s->lambda[j]) / s->units.column[j]);
    norm *= s->m;
    for (int a = 0; a < s->np; a++) {
        int i = s->pair[a];
        double x = s->lambda[i], y = s->mode[i] == NS_LOWER ? -s->y[i] : s->y[i];
        double broken = s->mode[i] == NS_INSIDE ? fmax(s->p->l[i] - x, x - s->p->u[i]) : y;
        double unit = s->mode[i] == NS_INSIDE ? s->units.column[i] * (qtop + norm)
                                              : fabs(s->q[i]) + norm * s->units.rowmax[i];
        if (!(broken <= LOOSE * unit))
            return 0;
    }
    return 1;
}

/* What is left of the equations may be there for lambda that underflowed. */
static int has_underflow(const ns_mlcp_solver *s) {
    int found = 0;
    for (int c = 0; c < s->k; c++) {
        const double *col = s->W + (size_t)s->cols[c] * (size_t)s->m;
        if (fabs(s->lambda[s->cols[c]]) >= DBL_MIN)
            continue;
        for (int r = 0; r < s->k; r++) {
            const double left = fabs(s->y[s->rows[r]]);
            found |= left > 0.0 && left <= fabs(col[s->rows[r]]) * DBL_MIN;
        }
    }
    return found;
}

/* The mode at hand has numbers: nothing else can be told of it. */
static int is_finite(const ns_mlcp_solver *s) {
    return ns_linalg_finite((size_t)s->m, s->lambda) && ns_linalg_finite((size_t)s->m, s->y);
}

/* Judges the mode at hand, whose G is factored; 1 if that ends the search. */
static int judge_mode(ns_mlcp_solver *s, tally *t, double rcond) {
    double residual;
    (void)ns_mlcp_mode_answer(s, &residual);
    if (residual < t->best) {
        t->best = residual;
        memcpy(s->tab.cover, s->lambda, (size_t)s->m * sizeof *s->tab.cover);
        memcpy(s->tab.at_upper, s->mode, (size_t)s->m);
    }
    return residual <= NS_MLCP_ACCEPT && (residual <= GOOD || rcond >= RCOND);
}

/* What lambda and y change by when pair i goes from l to u, into columns c of T and mag. */
static void step_columns(ns_mlcp_solver *s, int i, int c) {
    size_t m = (size_t)s->m;
    double *dx = s->tab.T + (size_t)c * m, *dy = s->elim.mag + (size_t)c * m;
    memset(dx, 0, m * sizeof *dx);
    memset(dy, 0, m * sizeof *dy);
    dx[i] = s->p->u[i] - s->p->l[i];
    ns_linalg_matvec_add(s->m, 1, s->W + (size_t)i * m, &dx[i], dy);
    for (int r = 0; r < s->k; r++)
        s->rhs[r] = -dy[s->rows[r]];
    ns_linalg_lu_solve(s->lu, 1, s->rhs);
    for (int r = 0; r < s->k; r++) {
        dx[s->cols[r]] = s->rhs[r];
        ns_linalg_matvec_add(s->m, 1, s->W + (size_t)s->cols[r] * m, &s->rhs[r], dy);
    }
}

/* Pair i from one of its bounds to the other. */
static void change_bound(ns_mlcp_solver *s, int i, int c) {
    size_t m = (size_t)s->m;
    double by = s->mode[i] == NS_LOWER ? 1.0 : -1.0;
    ns_linalg_matvec_add(s->m, 1, s->tab.T + (size_t)c * m, &by, s->lambda);
    ns_linalg_matvec_add(s->m, 1, s->elim.mag + (size_t)c * m, &by, s->y);
    s->mode[i] = (ns_mode)-s->mode[i];
    s->lambda[i] = ns_mlcp_bound(s, i, s->mode[i]);
}

/* All combinations of bounds of the pairs that are not inside; G is factored. */
static int try_bounds(ns_mlcp_solver *s, tally *t, double rcond) {
    int box[NS_BRANCH_MAX], n = 0;
    for (int a = 0; a < s->np; a++)
        if (s->mode[s->pair[a]] != NS_INSIDE && two_bounds(s, s->pair[a]))
            box[n++] = s->pair[a];
    ns_mlcp_basis_values(s, 0);
    for (int c = 0; c < n; c++)
        step_columns(s, box[c], c);
    for (long k = 0;;) {
        t->doubtful += !is_finite(s) || has_underflow(s);
        if (is_finite(s) && is_plausible(s, t->qtop)) {
            if (judge_mode(s, t, rcond))
                return NS_OK;
            ns_mlcp_basis_values(s, 0);
        }
        if (++k >> n)
            return NS_E_INFEASIBLE;
        int c = 0;
        while (!(k >> c & 1))
            c++;
        change_bound(s, box[c], c);
    }
}

/* The pairs of the set inside, the others at a bound. */
static int try_subset(ns_mlcp_solver *s, unsigned set, tally *t) {
    double rcond;
    for (int a = 0; a < s->np; a++)
        s->mode[s->pair[a]] = ns_mlcp_fit_mode(s, s->pair[a], set >> a & 1 ? NS_INSIDE : NS_LOWER);
    int status = ns_mlcp_basis_factor(s, &rcond), sound = status == NS_OK && rcond >= RCOND;
    t->doubtful += !sound;
    return status == NS_OK && rcond > WORST ? try_bounds(s, t, rcond) : NS_E_INFEASIBLE;
}

/* All sets, the one of the start first.  OK, or INFEASIBLE: nothing seen. */
static int try_all_sets(ns_mlcp_solver *s, tally *t) {
    unsigned start = 0;
    for (int a = 0; a < s->np; a++)
        start |= s->mode[s->pair[a]] == NS_INSIDE ? 1u << a : 0u;
    for (unsigned k = 0; k >> s->np == 0; k++)
        if (try_subset(s, start ^ k ^ k >> 1, t) == NS_OK)
            return NS_OK;
    if (!(t->best <= NS_MLCP_ACCEPT))
        return NS_E_INFEASIBLE;
    memcpy(s->lambda, s->tab.cover, (size_t)s->m * sizeof *s->lambda);
    memcpy(s->mode, s->tab.at_upper, (size_t)s->m);
    return NS_OK;
}

static double multiplications(const ns_mlcp_solver *s) {
    double k = s->nf + 0.5 * s->np, m = s->m, modes = 1.0;
    for (int a = 0; a < s->np; a++)
        modes *= two_bounds(s, s->pair[a]) ? 3.0 : 2.0;
    return ldexp(k * k * (k / 3.0 + 20.0), s->np) + modes * 3.0 * m;
}

int ns_mlcp_enumerate(ns_mlcp_solver *s) {
    tally t = {.best = INFINITY};
    if (s->np > NS_BRANCH_MAX)
        return NS_E_SIZE;
    for (int i = 0; i < s->m; i++)
        if (s->units.rowmax[i] > 0.0)
            t.qtop = fmax(t.qtop, fabs(s->q[i]) / s->units.rowmax[i]);
    int cheap = multiplications(s) <= COSTLY;
    if (cheap && try_all_sets(s, &t) == NS_OK)
        return NS_OK;
    int status = ns_mlcp_branch_and_bound(s);
    return status == NS_E_LIMIT && cheap && t.doubtful == 0 ? NS_E_INFEASIBLE : status;
}
