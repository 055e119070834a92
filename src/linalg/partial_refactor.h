/* src/linalg/partial_refactor.h - factors of matrices that share one pattern, with pivots chosen once for all
 * of them.
 *
 * What one matrix has in common with the last one keeps its factors: only rows that differ are gone through
 * again, and rows that these reach, as far as their numbers change at all.
 */
#ifndef NS_LINALG_PARTIAL_REFACTOR_H
#define NS_LINALG_PARTIAL_REFACTOR_H

#include "packed_triangular.h"

typedef struct ns_partial_lu ns_partial_lu;

/* Pivots as in t; start (n+1), row (start[n]): the places of all matrices, column by column.  NULL: no
 * memory. NULL may be freed, after the factors. */
ns_partial_lu *ns_linalg_partial_create(const ns_triangles *t, const int *start, const int *row);
void ns_linalg_partial_free(ns_partial_lu *s);

/* *sweep: NULL, or factors that this made before of another matrix; becomes those of the matrix of these
 * values.  Errors: SINGULAR (the pivots are not good enough for it), MEMORY; then *sweep is freed, and NULL.
 */
int ns_linalg_partial_factor(ns_partial_lu *s, const double *value, ns_packed_triangular **sweep);

/* The same of a matrix that differs from the last one in these rows alone.  0: they are not good enough. */
int ns_linalg_partial_change(ns_partial_lu *s, const double *value, int rows, const int *row,
                             ns_packed_triangular **sweep);

size_t ns_linalg_partial_bytes(const ns_partial_lu *s); /* memory of one set of factors */

#endif
