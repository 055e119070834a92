/* nonsmooth/mlcp.h - (P1): find lambda with  y = W lambda + q,  -y in N_[l,u](lambda).
 *
 * Pair i is at its lower bound (lambda = l, y >= 0), inside (l <= lambda <= u, y = 0) or at its
 * upper bound (lambda = u, y <= 0).  l = 0, u = inf: complementarity.  l = -inf, u = inf: an equality
 * y = 0.  l = u: lambda is given, y free.  Any l <= u is allowed but l = u = -inf and l = u = inf.
 */
#ifndef NONSMOOTH_MLCP_H
#define NONSMOOTH_MLCP_H

#include "nonsmooth/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef signed char ns_mode; /* of one pair */
enum { NS_LOWER = -1, NS_INSIDE = 0, NS_UPPER = 1 };

/* A problem; the arrays belong to the caller. */
typedef struct ns_mlcp {
    int m;           /* pairs, >= 0 */
    const double *W; /* m*m, column by column, finite */
    const double *q; /* m, finite */
    const double *l; /* m, -inf allowed */
    const double *u; /* m, +inf allowed, l <= u */
} ns_mlcp;

/* What a solve did. */
typedef struct ns_mlcp_info {
    long pivots;     /* exchanges of one pair */
    long factors;    /* m*m factorisations */
    double residual; /* ns_mlcp_residual() of the answer */
    ns_fault fault;  /* pair[]: see ns_mlcp_solve(); t is NAN, unknown[] empty */
} ns_mlcp_info;

typedef struct ns_mlcp_solver ns_mlcp_solver; /* workspace for problems of up to m pairs */

/* Makes a workspace.  On failure *out is NULL.  Errors: NULL, SIZE (m < 0), MEMORY. */
int ns_mlcp_create(int m, ns_mlcp_solver **out);

/* Frees a workspace; NULL is allowed. */
void ns_mlcp_free(ns_mlcp_solver *s);

/* Solves p.  mode (m) is read as the mode to start from (any content is allowed: entries that do not
 * fit their bounds are mended) and holds the mode of the answer on success.  lambda (m) and y (m) are
 * written on success.  info may be NULL.  No memory is taken.
 * Method: the starting mode is made a nonsingular basis (where its equations are singular, pairs are
 * exchanged until they are not), its guards are read, and if they hold, no pivot is made; otherwise
 * Lemke's method from that basis with lexicographic ties.  The answer is computed anew from W and q in
 * its mode, refined, and its natural residual is checked before NS_OK.
 * Where equalities are redundant (two closed switches in parallel) the answer is, in what they leave open,
 * the one of least norm, in units of the scaling of W: equal shares for equal switches.
 * info->fault.pair, at most NS_FAULT_MAX: INFEASIBLE: the pairs that the certificate rests on, or whose
 * equations are left unsatisfied, the heaviest first; SINGULAR: the equalities that no basis takes beside the
 * others.  Of other errors it says nothing, of NS_OK it is empty.
 * Errors: NULL, SIZE (p->m larger than the workspace), NUMBER, BOUNDS (l > u, or both the same infinity);
 * SINGULAR (no basis holds all equalities, and no answer of least norm was found), INFEASIBLE (a proof was
 * found, or equations that contradict each other), LIMIT, RESIDUAL. */
int ns_mlcp_solve(ns_mlcp_solver *s, const ns_mlcp *p, ns_mode *mode, double *lambda, double *y,
                  ns_mlcp_info *info);

/* The natural residual  max_i |lambda_i - proj_[l,u](lambda_i - y_i)|  with row i scaled so that it is
 * relative to the sizes of the terms that make it up (1e-16: as good as rounding allows), for
 * y = W lambda + q computed here from the problem.  *worst (may be NULL) gets the row.
 * Shares nothing with the solver.  Returns NAN for bad input. */
double ns_mlcp_residual(const ns_mlcp *p, const double *lambda, int *worst);

#ifdef __cplusplus
}
#endif
#endif
