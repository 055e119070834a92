/* src/mlcp/optional/scaled.h - a problem in units in which the iterative methods work, and the way back from
 * there. */
#ifndef NS_MLCP_SCALED_H
#define NS_MLCP_SCALED_H

#include "mlcp/mlcp_internal.h"

/* y = W x + q, -y in N_[l,u](x), all entries of about 1; x of a fixed lambda is 0 (it is folded into q).
 * Everything lies in the solver's workspace: W in T, the vectors in xs, blo, bhi; work in beta, cover, ray,
 * unit.  None of these is touched by basis.c, reveal.c and the functions below but where it says so. */
typedef struct ns_scaled {
    int m;
    double *W;             /* m*m */
    double *q, *l, *u;     /* m */
    double *x, *y;         /* m */
    double *work[6];       /* m each */
    const double *rs, *cs; /* m: lambda_j = cs_j x_j, y_i of the problem = y_i / rs_i */
} ns_scaled;

enum { NS_LAW_FIXED, NS_LAW_FREE, NS_LAW_LOWER, NS_LAW_UPPER, NS_LAW_BOX };

/* Which bounds index i has. */
int ns_mlcp_scaled_law(const ns_scaled *z, int i);

/* From s->now, with x the projection of 0 on the bounds. */
void ns_mlcp_scaled_load(ns_mlcp_solver *s, ns_scaled *z);

/* x of the answer in s->mode, put into its bounds, where that mode has one; returns 0 where it has not. */
int ns_mlcp_scaled_start(ns_mlcp_solver *s, ns_scaled *z);

/* y = W x + q */
void ns_mlcp_scaled_product(ns_scaled *z);

/* s->mode as x and y (m, scaled) suggest it: the smaller of two that should not both be large is 0. */
void ns_mlcp_scaled_mode(ns_mlcp_solver *s, const ns_scaled *z, const double *x, const double *y);

/* Crossover: from s->mode to an answer of a mode near it, by a few flips of all guards that are broken.
 * OK: s->lambda has natural residual <= NS_MLCP_ACCEPT.  Otherwise LIMIT, SINGULAR, and s->lambda, s->mode
 * are anything.  Uses A, mag, G, rhs, g, ysize, lsize, y. */
int ns_mlcp_crossover(ns_mlcp_solver *s);

/* The end of an iteration: crossover from the mode that x and y suggest; if that fails, x itself in
 * that mode; if its equations are redundant, that corrected by proximal steps.  Overwrites what
 * ns_mlcp_crossover() does. */
int ns_mlcp_scaled_finish(ns_mlcp_solver *s, const ns_scaled *z, const double *x, const double *y);

#endif
