/* src/linalg/row_split.h - the elimination behind ns_system_split(), for any square matrix. */
#ifndef NS_LINALG_ROW_SPLIT_H
#define NS_LINALG_ROW_SPLIT_H

/* As ns_system_split(), for M (n*n) alone.  Errors: NULL, MEMORY. */
int ns_linalg_row_split(int n, const double *M, double *T, int *rank);

/* The same; of rows whose pivots are about as good the differential ones are those in which little flows:
 * flow (n), the sizes of all other terms of a row.  NULL: not known. */
int ns_linalg_row_split_quiet(int n, const double *M, const double *flow, double *T, int *rank);

/* The same for M whose entries were summed from terms of these sizes (n*n; M itself where
 * they are given numbers), of which 64 eps may be rounding.  Errors: MEMORY. */
int ns_linalg_row_split_rows(int n, const double *M, const double *size, double *T, int *rank);

/* to = T from, both with n rows; what cancels to rounding is zero. */
void ns_linalg_row_split_apply(int n, int columns, const double *T, const double *from, double *to);

#endif
