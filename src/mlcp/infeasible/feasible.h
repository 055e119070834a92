/* src/mlcp/infeasible/feasible.h - are linear equations and bounds consistent?  The simplex method on y = W
 * lambda + q.
 */
#ifndef NS_MLCP_FEASIBLE_H
#define NS_MLCP_FEASIBLE_H

#include "mlcp/mlcp_internal.h"

/* 2m variables in units in which W's entries are about 1: lambda_j is j, y_i is m+i, each between lo and hi.
 * basic = T (nonbasic, 1).  In the solver's workspace: W in A, T, lo and hi in xs, value in unit, q in blo,
 * price in beta, proof in ray, weight in cover, and rowvar, colvar, where, r, c. */
typedef struct ns_simplex {
    int m;
    double *W, *q;        /* m*m, m: scaled */
    double *T;            /* m*(m+1) */
    double *lo, *hi;      /* 2m */
    double *value;        /* 2m */
    double *price, *v;    /* m */
    double *weight;       /* m: how much the proofs so far rested on each row */
    int *rowvar, *colvar; /* m */
    int *where;           /* 2m: row, or -1-column */
    int since;            /* exchanges since T was made */
    int shift;            /* q and all values are in units of 2^shift */
} ns_simplex;

/* From s->now, the bounds those that each pair has whatever its mode; all y basic. */
void ns_mlcp_simplex_start(ns_mlcp_solver *s, ns_simplex *p);

/* Puts pair i into a mode: its bounds become those of that mode. */
void ns_mlcp_simplex_fix(const ns_mlcp_solver *s, ns_simplex *p, int i, ns_mode mode);

/* Gives it back the bounds of ns_mlcp_simplex_start(). */
void ns_mlcp_simplex_release(const ns_mlcp_solver *s, ns_simplex *p, int i);

/* OK: value is within the bounds (up to rounding).  INFEASIBLE: there is no such value; p->v (m) proves it
 * from W and q.  LIMIT: neither could be shown. */
int ns_mlcp_simplex_run(ns_mlcp_solver *s, ns_simplex *p);

#endif
