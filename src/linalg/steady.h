/* src/linalg/steady.h - factors of matrices that share one pattern, with pivots chosen once for all of them.
 *
 * What one matrix has in common with the last one keeps its factors: only rows that differ are gone through
 * again, and rows that these reach, as far as their numbers change at all.
 */
#ifndef NS_STEADY_H
#define NS_STEADY_H

#include "sweep.h"

typedef struct ns_steady ns_steady;

/* Pivots as in t; start (n+1), row (start[n]): the places of all matrices, column by column.  NULL: no
 * memory. NULL may be freed, after the factors. */
ns_steady *ns_steady_create(const ns_triangles *t, const int *start, const int *row);
void ns_steady_free(ns_steady *s);

/* *sweep: NULL, or factors that this made before of another matrix; becomes those of the matrix of these
 * values.  Errors: SINGULAR (the pivots are not good enough for it), MEMORY; then *sweep is freed, and NULL.
 */
int ns_steady_factor(ns_steady *s, const double *value, ns_sweep **sweep);

/* The same of a matrix that differs from the last one in these rows alone.  0: they are not good enough. */
int ns_steady_change(ns_steady *s, const double *value, int rows, const int *row, ns_sweep **sweep);

size_t ns_steady_bytes(const ns_steady *s); /* of factors */

#endif
