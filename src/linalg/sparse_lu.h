/* src/linalg/sparse_lu.h - factors of sparse square matrices that share one pattern; KLU behind it. */
#ifndef NS_LINALG_SPARSE_LU_H
#define NS_LINALG_SPARSE_LU_H

#include <stddef.h>

typedef struct ns_klu ns_klu;         /* the pattern, taken apart once; not for two threads at a time */
typedef struct ns_factors ns_factors; /* of one matrix */

/* For n*n matrices with these places (column by column: start n+1, row start[n]), which stay the caller's and
 * must not change.  Errors: SINGULAR (no choice of values makes it regular), MEMORY. */
int ns_linalg_klu_create(int n, int *start, int *row, ns_klu **out);
void ns_linalg_klu_free(ns_klu *k); /* NULL is allowed; after its factors */

/* Factors the matrix of these values.  *f: NULL, or factors of another, whose memory and pivots are used
 * again where they are good enough.  On failure they are freed, and *f is NULL.  Errors: NUMBER, SINGULAR,
 * MEMORY. */
int ns_linalg_klu_factor(ns_klu *k, double *value, ns_factors **f);
void ns_linalg_factors_free(ns_klu *k, ns_factors *f); /* NULL is allowed */
size_t ns_linalg_factors_bytes(const ns_klu *k, const ns_factors *f);

/* From now on matrices are factored by the pivots of this one, as long as these are good enough for nearly
 * all, or nothing happens: it is singular, or fills up.  Errors: MEMORY.  Whether they are. */
int ns_linalg_klu_partial(ns_klu *k, double *value);
int ns_linalg_klu_is_partial(const ns_klu *k);

/* 1: f, of the pivots for all, now is of the matrix that has these values in these rows, and is the same in
 * all others.  0: it has to be factored as a whole. */
int ns_linalg_klu_change(ns_klu *k, ns_factors *f, const double *value, int rows, const int *row);

/* Right-hand sides are often zero in the rows from this one on: unknowns that they alone determine are left
 * out then. */
void ns_linalg_klu_often_zero(ns_klu *k, int from);

/* b (n) becomes the solution. */
void ns_linalg_klu_solve(ns_klu *k, ns_factors *f, double *b);

/* How many times it factored from scratch, and with old pivots. */
long ns_linalg_klu_fresh(const ns_klu *k);
long ns_linalg_klu_refactor(const ns_klu *k);
/* How many times it solved. */
long ns_linalg_klu_solves(const ns_klu *k);

#endif
