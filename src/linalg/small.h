/* src/linalg/small.h - what LAPACK does, of matrices so small that its calls take longer than the sums. */
#ifndef NS_LINALG_SMALL_H
#define NS_LINALG_SMALL_H

/* Up to this many rows: as auto takes the dense engines (march/select.c).  Zeros are passed over, which
 * LAPACK does not: maps of a twelve-pulse rectifier, 40 to 52 rows, take 0.66 times as many instructions. */
enum { NS_SMALL = 64 };

/* LU factors with row exchanges in place of a (n*n), laid out as dgetrf's; 0, or the first pivot that is
 * zero, counted from 1. */
int ns_linalg_small_factor(int n, double *a, int *piv);

/* The rows of what is not zero in the factors, column by column (n each): those below the diagonal, up to
 * count[0] of the column, then those above it, up to count[1]. */
void ns_linalg_small_pattern(int n, const double *a, short *row, int *count);

/* Solves with these factors, in place of b (n*nrhs; row, nonzeros: that pattern, of which one right-hand side
 * needs none); with the transposed matrix, in place of b (n). */
void ns_linalg_small_solve(int n, const double *a, const int *piv, const short *row, const int *nonzeros,
                           int nrhs, double *b);
void ns_linalg_small_solve_transposed(int n, const double *a, const int *piv, double *b);

/* The eigenvalues of a (n*n, n = 1 or 2): re, im; 0 if they are out of range on the way. */
int ns_linalg_small_eigenvalues(int n, const double *a, double *re, double *im);

#endif
