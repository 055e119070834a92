/* src/linalg/leakage.h - leakage fluxes of closely coupled coils in place of fluxes of single coils. */
#ifndef NS_LINALG_LEAKAGE_H
#define NS_LINALG_LEAKAGE_H

/* M (n*n); T, rank: of ns_linalg_row_split(), TM (n*n): T M, each with n rows.  Changes some of the first
 * `rank` rows of T and of TM: where other rows that M joins to row i leave less than half of its
 * diagonal entry, multiples of these are subtracted from row i.  Rows of networks of capacitors stay, and
 * those that are not unit rows of T.  Errors: MEMORY.
 */
int ns_linalg_leakage(int n, const double *M, int rank, double *T, double *TM);

#endif
