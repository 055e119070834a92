/* src/mlcp/infeasible/phase1.h - phase 1 of the simplex method on the linear constraints of a problem. */
#ifndef NS_MLCP_PHASE1_H
#define NS_MLCP_PHASE1_H

#include "certificate.h"
#include "mlcp/mlcp_internal.h"

/* basic = value + A nonbasic, in units of s->r, s->c.  The arrays are those of the solver: A, mag, rowvar,
 * colvar (lambda_j is 2j, y_j is 2j+1), blo and bhi (m: bounds of lambda_j), at_upper (m); work in xs. */
typedef struct ns_phase1 {
    ns_mlcp_solver *s;
    int boxes; /* y of boxes have rows */
    ns_mode *
        mode; /* m: that pair i is put into, or NS_OPEN: its bounds are those that it has whatever its mode */
    int rows, cols;
    double *value, *size; /* rows: of the basic variables, and of the terms they were summed from */
    double *side;         /* rows: -1 below the lower bound, 1 above the upper, 0 */
    double *cost;         /* cols: sum of side[r] A[r,c] */
    double least;         /* sizes count as at least this */
    double most;          /* s->searched may come to that, INFINITY: to anything */
    int pivots;           /* since the tableau was made from W and q */
} ns_phase1;

/* Of s->q and *s->p, all pairs open.  boxes: pairs of two bounds may be put into modes.  Amounts are judged
 * against the terms they come from, which count as at least `floor` times the largest of the start; what is
 * outside by less than 1e-12 of them is inside. */
void ns_mlcp_phase1_start(ns_phase1 *z, ns_mlcp_solver *s, int boxes, double floor);

/* Puts pair i into a mode: lambda_i is at that bound and y_i has the sign of it, or y_i is 0.  NS_OPEN: into
 * none. */
void ns_mlcp_phase1_put(ns_phase1 *z, int i, ns_mode mode);

/* OK: the constraints are met.  INFEASIBLE: they cannot be, z holds the point where the violation is least.
 * LIMIT: it was not found out; s->cut_off: for it would take more than z->most. */
int ns_mlcp_phase1_run(ns_phase1 *z);

/* value (2m): of all variables; basic (2m): whether it is. */
void ns_mlcp_phase1_read(const ns_phase1 *z, double *value, int *basic);

/* farkas.c: whether v (m), from the costs and sides of a run that ended INFEASIBLE, proves that there is no
 * solution in the modes of z.  Uses ray and g. */
int ns_mlcp_farkas_proves(const ns_phase1 *z, double *v);

#endif
