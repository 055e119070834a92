/* src/sparse/regularise.h - (P2) where the laws of devices leave it singular: the limit of vanishing leaks.
 */
#ifndef NS_SPARSE_REGULARISE_H
#define NS_SPARSE_REGULARISE_H

#include "assemble.h"
#include "null_space.h"

/* The leak (m) of each pair in this mode: a conductance if it is open, a resistance if it is inside.  value:
 * of K; scale, unit (size): what brings its rows, and unknowns, near 1.  Errors: MEMORY. */
int ns_sparse_leaks_find(const ns_form *f, const ns_mode *mode, const double *value, double *leak,
                         double *scale, double *unit);

/* What (P2) leaves of r, of the terms of its rows, or, given the scale (or NULL), of the largest of all in
 * units; seen (size, or NULL): how large unknowns were of late.  rest (size) = r - K v. */
double ns_sparse_leaks_left(const ns_form *f, double g, const ns_mode *mode, const double *scale,
                            const double *r, const double *v, const double *seen, double *rest);

/* The null space of K, found when it is first needed. */
typedef struct ns_null_known {
    ns_null_search **search; /* NULL in there: to be made */
    ns_null_space *space;    /* NULL: it was not found */
    int sought;              /* 1: it was searched for */
} ns_null_known;

/* K v = r; rest: work (size).  residual: 1 if r is what rounding left of another right-hand side: what
 * contradicts the equations in it is rounding too.  Errors: SINGULAR (the equations contradict each other: v
 * is then the answer with leaks, whose largest currents are in the contradiction), MEMORY. */
int ns_sparse_leaks_solve(const ns_sparse_leaks *k, ns_null_known *null, int residual, const double *r,
                          double *v, double *rest);

#endif
