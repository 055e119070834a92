/* src/linalg/dense.h - the few dense kernels we need, LAPACK behind them (column by column). */
#ifndef NS_LINALG_DENSE_H
#define NS_LINALG_DENSE_H

#include <stddef.h>

/* LU factors of an equilibrated n*n matrix: rows and columns scaled by powers of two first, so that the
 * pivot choice and rcond do not depend on the units of the unknowns. */
typedef struct ns_lu ns_lu;

/* Room for factors of matrices up to n*n.  Errors: SIZE, MEMORY (*out is NULL then). */
int ns_linalg_lu_create(int n, ns_lu **out);
void ns_linalg_lu_free(ns_lu *f); /* NULL is allowed */

/* Factors a (n*n, n at most that of create; left alone).  *rcond (may be NULL) gets the reciprocal
 * condition estimate of the equilibrated matrix.  Errors: NUMBER (NaN or inf inside), SINGULAR: an exactly
 * zero pivot or rcond below 1e-300. */
int ns_linalg_lu_factor(ns_lu *f, int n, const double *a, double *rcond);

/* Of the last matrix factored, with NS_OK: the estimate of its reciprocal condition (that costs as much as
 * small factors); the smallest pivot as a share of the largest. */
double ns_linalg_lu_rcond(ns_lu *f);
double ns_linalg_lu_pivots(const ns_lu *f);

/* The same, scaled by largest entries of rows and columns instead of by the permutation with the largest
 * product: for large matrices, whose search costs more than the factors.  c (n): exponents of units in which
 * the unknowns are alike. */
int ns_linalg_lu_factor_quickly(ns_lu *f, int n, const double *a, const int *c, double *rcond);

/* Solves for nrhs right-hand sides in place: b is n*nrhs. */
void ns_linalg_lu_solve(const ns_lu *f, int nrhs, double *b);

/* The same with the transposed matrix. */
void ns_linalg_lu_solve_transposed(const ns_lu *f, int nrhs, double *b);

/* The scaling of ns_linalg_lu_factor() alone: there are no factors then, of this matrix or one before.
 * Errors: NUMBER. */
int ns_linalg_lu_scale(ns_lu *f, int n, const double *a);

/* The scaling of the last matrix given to one of these, known even if it was singular (n powers of
 * two each): its entry (i,j) times rows[i] units[j] is about 1 or less.  The units are those in which the
 * unknowns are alike. */
const double *ns_linalg_lu_rows(const ns_lu *f);
const double *ns_linalg_lu_units(const ns_lu *f);

/* The largest entry of x (n), in those units. */
double ns_linalg_lu_largest(const ns_lu *f, const double *x);

/* count numbers, all 0, to be freed by free(); never NULL for a count of 0.  Sets *failed where memory is
 * short (NULL), and leaves it alone where it is not. */
double *ns_linalg_vector(size_t count, int *failed);

/* y = x; both may be NULL where n is 0. */
void ns_linalg_copy(size_t n, const double *x, double *y);

/* 1 if no entry of x (n) is NaN or infinite. */
int ns_linalg_finite(size_t n, const double *x);

/* The eigenvalues of a (n*n, overwritten): re, im (n each).  Errors: MEMORY, NUMBER (NaN inside, or no
 * convergence). */
int ns_linalg_eigenvalues(int n, double *a, double *re, double *im);

/* The same with left and right eigenvectors (n*n each), the real and the imaginary part of a pair in two
 * columns: u conjugated times a is the eigenvalue times u conjugated. */
int ns_linalg_eigenvectors(int n, double *a, double *re, double *im, double *left, double *right);

/* y = T x, p*q with leading dimension p, solved for x_col in its row: the table after y_row and x_col have
 * changed places.  A sum within cancelled of its first term becomes 0. */
void ns_linalg_exchange(int p, int q, double *T, int row, int col, double cancelled);

/* y = A x, y += A x;  A is p*q with leading dimension p, NULL (as x) where it is empty. */
void ns_linalg_matvec(int p, int q, const double *a, const double *x, double *y);
void ns_linalg_matvec_add(int p, int q, const double *a, const double *x, double *y);
/* y = A (x, z), A p*(q+qz), summed up over z first: x may be waited for. */
void ns_linalg_matvec_two(int p, int q, const double *x, int qz, const double *z, const double *a, double *y);

#endif
