/* src/linalg/small.h - what LAPACK does, of matrices of which a part is zero, and of small ones. */
#ifndef NS_LINALG_SMALL_H
#define NS_LINALG_SMALL_H

/* Up to this many rows.  Zeros are passed over, which LAPACK does not: matrices of circuits take 0.4 (178
 * rows) to 0.6 (40 rows) of the time of its own BLAS, full ones 0.6 of it; OpenBLAS is faster from 70 rows
 * on. */
enum { NS_SMALL = 256 };

/* LU factors with row exchanges in place of a (n*n), laid out as dgetrf's; 0, or the first pivot that is
 * zero, counted from 1. */
int ns_linalg_small_factor(int n, double *a, int *piv);

/* The rows of what is not zero in the factors, column by column (n each): those below the diagonal, up to
 * count[0] of the column, then those above it, up to count[1]. */
void ns_linalg_small_pattern(int n, const double *a, short *row, int *count);

/* Solves with these factors, in place of b (n*nrhs; row, nonzeros: that pattern, which one right-hand side
 * may be without: NULL); with the transposed matrix, in place of b (n). */
void ns_linalg_small_solve(int n, const double *a, const int *piv, const short *row, const int *nonzeros,
                           int nrhs, double *b);
void ns_linalg_small_solve_transposed(int n, const double *a, const int *piv, double *b);

/* The eigenvalues of a (n*n, n = 1 or 2): re, im; 0 if they are out of range on the way. */
int ns_linalg_small_eigenvalues(int n, const double *a, double *re, double *im);

#endif
