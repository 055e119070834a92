/* src/linalg/cut_sets.h - charges of parts of a network of capacitors in place of those of single nodes. */
#ifndef NS_LINALG_CUT_SETS_H
#define NS_LINALG_CUT_SETS_H

/* M (n*n); T, rank: of ns_linalg_row_split(), TM (n*n): T M, each with n rows.  Changes some of the first
 * `rank` rows of T and of TM: in place of row i of M, the sum of row i and of those of nodes that capacitors
 * 1000 times as large join to node i.  Rows that are none of a network of capacitors stay.  Errors: MEMORY.
 */
int ns_linalg_cut_sets(int n, const double *M, int rank, double *T, double *TM);

/* To row (n): `first`, and all rows that entries of M (n*n) join to it; returns how many.  reached (n): not 0
 * where a row was found, by this or by former calls; these are passed over. */
int ns_linalg_cut_sets_part(int n, const double *M, int first, int *row, int *reached);

#endif
