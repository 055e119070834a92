/* src/linalg/summed_parts.h - Kirchhoff's current law of a part that resistors and capacitors join, in one
 * exact row. */
#ifndef NS_LINALG_SUMMED_PARTS_H
#define NS_LINALG_SUMMED_PARTS_H

/* A, M (n*n); T, rank: of ns_linalg_row_split() for M.  Changes some rows of T from `rank` on: where the rows
 * that entries of one sign join (i and j: A_ij and A_ji, or M_ij and M_ji) cancel in their own columns of A,
 * and in M, one of them becomes the sum of all, unless each diagonal entry is of one branch alone, which
 * cancels exactly.  Errors: MEMORY. */
int ns_linalg_summed_parts(int n, const double *A, const double *M, int rank, double *T);

#endif
