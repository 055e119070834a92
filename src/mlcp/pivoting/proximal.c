/* src/mlcp/pivoting/proximal.c - equations that are redundant, and unknowns that are open: no basis holds
 * all.
 *
 * (Two closed ideal switches in parallel: y = 0 twice, and only the sum of the currents is determined.)
 * Proximal point method: solve, for k = 0, 1, ... and x the lambda,
 *
 *     y = W x_k+1 + q + eps E (x_k+1 - x_k),     x_0 = 0
 *
 * which is nonsingular; where the equations are consistent, x_k converges to a solution of the given
 * problem, in its undetermined directions the one nearest to 0 in E's measure: equal shares for
 * equal switches.  E acts on free indices: first the diagonal (in scaled units), and where that does not make
 * the problem nonsingular, the rows and columns that elimination left over.  Where they are not consistent,
 * x_k runs away, and what remains of the residual shows the rows that contradict.
 */
#include "mlcp/mlcp_internal.h"

#include <math.h>
#include <string.h>

#include "mlcp/verify/residual.h"

enum { EPS = -20, STEPS = 8, HALVINGS = 44 }; /* 2^-43: NS_MLCP_GOOD */

/* eps E as a list of entries; kind 0: diagonal, 1: left-over rows and columns. */
static int choose_entries(ns_mlcp_solver *s, int kind) {
    int n = kind == 0 ? s->nf : s->elim.nstuck;
    for (int k = 0; k < n; k++) {
        s->regularised.row[k] = kind == 0 ? s->free[k] : s->elim.stuck_row[k];
        s->regularised.col[k] = kind == 0 ? s->free[k] : s->elim.stuck_col[k];
        s->regularised.value[k] =
            ldexp(1.0, EPS - s->elim.row_exp[s->regularised.row[k]] - s->elim.col_exp[s->regularised.col[k]]);
    }
    return n;
}

/* The problem with eps E added, x_k = lambda where from != 0, else 0. */
static void regularise(ns_mlcp_solver *s, int n, int from) {
    size_t m = (size_t)s->m;
    memcpy(s->regularised.W, s->p->W, m * m * sizeof *s->regularised.W);
    memcpy(s->regularised.q, s->p->q, m * sizeof *s->regularised.q);
    for (int k = 0; k < n; k++) {
        s->regularised.W[(size_t)s->regularised.row[k] + (size_t)s->regularised.col[k] * m] +=
            s->regularised.value[k];
        if (from)
            s->regularised.q[s->regularised.row[k]] -=
                s->regularised.value[k] * s->lambda[s->regularised.col[k]];
    }
    s->elim.nstuck = 0; /* nothing is known of the new matrix */
    s->now.W = s->regularised.W;
    s->now.q = s->regularised.q;
    ns_mlcp_fold(s);
}

/* Further proximal steps in the mode found, each as a correction of x_k by the residual of the given problem,
 * which rounds much less than solving for x_k+1 anew.  Keeps the best; returns its residual. */
static double refine_answer(ns_mlcp_solver *s) {
    double best = INFINITY;
    ns_mlcp_take_given(s);
    for (int k = 0; k < HALVINGS; k++) {
        double now = ns_mlcp_measure(s->p, s->lambda, s->alike, s->rhs, NULL), before = best;
        if (now < best) {
            best = now;
            ns_mlcp_save(s, &s->kept);
        }
        if (best <= NS_MLCP_GOOD || !(now <= 0.5 * before))
            break;
        ns_mlcp_basis_correct(s);
        ns_mlcp_basis_clamp(s);
        ns_mlcp_basis_zero_undriven(s);
    }
    ns_mlcp_restore(s, &s->kept);
    return best;
}

/* The iteration with one E; INFEASIBLE: it ran away. */
static int iterate_points(ns_mlcp_solver *s, const ns_mode *mode, int n, double *residual) {
    double before = INFINITY;
    for (int k = 0; k < STEPS; k++) {
        regularise(s, n, k > 0);
        int status = ns_mlcp_lemke_starts(s, k == 0 ? mode : s->mode, residual);
        if (status != NS_OK)
            return status;
        *residual = refine_answer(s);
        if (*residual <= NS_MLCP_ACCEPT)
            return NS_OK;
        ns_mlcp_zeros_note(s);
        if (k >= 2 && !(*residual <= 0.5 * before))
            break;
        before = *residual;
    }
    return NS_E_INFEASIBLE;
}

int ns_mlcp_proximal(ns_mlcp_solver *s, const ns_mode *mode, double *residual) {
    int first = NS_E_SINGULAR;
    ns_mlcp_list(s, s->elim.nstuck, s->elim.stuck_row);
    ns_fault fault = s->fault;
    for (int kind = 0; kind < 2; kind++) {
        ns_mlcp_take_given(s); /* scaling and left-over rows of the given problem */
        ns_mlcp_start_from(s, mode);
        (void)ns_mlcp_reveal(s);
        int status = iterate_points(s, mode, choose_entries(s, kind), residual);
        if (status == NS_OK)
            return NS_OK;
        if (first == NS_E_SINGULAR && status != NS_E_SINGULAR) {
            first = status;
            fault = s->fault;
        }
    }
    s->fault = fault;
    return first;
}
