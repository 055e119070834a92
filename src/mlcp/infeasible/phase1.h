/* src/mlcp/infeasible/phase1.h - phase 1 of the simplex method on the linear constraints of a problem. */
#ifndef NS_MLCP_PHASE1_H
#define NS_MLCP_PHASE1_H

#include "mlcp/mlcp_internal.h"

/* basic = value + A nonbasic, in units of s->r, s->c.  The arrays are those of the solver: A, mag, rowvar,
 * colvar (lambda_j is 2j, y_j is 2j+1), blo and bhi (m: bounds of lambda_j), at_upper (m); work in xs. */
typedef struct ns_phase1 {
    ns_mlcp_solver *s;
    int rows, cols;
    double *value, *size; /* rows: of the basic variables, and of the terms they were summed from */
    double *side;         /* rows: -1 below the lower bound, 1 above the upper, 0 */
    double *cost;         /* cols: sum of side[r] A[r,c] */
    double least;         /* sizes count as at least this */
    double near;          /* of a size: inside the bounds */
    int pivots;           /* since the tableau was made from W and q */
} ns_phase1;

/* 1: the constraints cannot be met, z holds the point where the violation is least; 0: they can, or it was
 * not found out.  Works on s->q and *s->p, whatever the mode.  Amounts are judged against the terms they come
 * from, which count as at least `floor` times the largest of the start; what is outside by less than `near`
 * of them is inside. */
int ns_mlcp_phase1_run(ns_phase1 *z, ns_mlcp_solver *s, double floor, double near);

/* Basic variable of row p and nonbasic variable of column c change places; values and sides stay. */
void ns_mlcp_phase1_exchange(ns_phase1 *z, int p, int c);

#endif
