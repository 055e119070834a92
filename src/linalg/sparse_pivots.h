/* src/linalg/sparse_pivots.h - whether pivots of KLU's factors are but rounding. */
#ifndef NS_LINALG_SPARSE_PIVOTS_H
#define NS_LINALG_SPARSE_PIVOTS_H

#include <suitesparse/klu.h>

/* 1 if one is rounding of the terms that it was summed from: the matrix (n*n, column by column) is as good as
 * singular, in whatever units it is.  0 too where there is no memory to tell. */
int ns_linalg_pivots_vanish(int n, const int *start, const int *row, const double *value,
                            klu_symbolic *symbolic, klu_numeric *numeric, klu_common *common);

/* The largest error of a row in a solution with a right-hand side of random signs, relative to the terms that
 * the row is summed from: large where pivots that were chosen for another matrix are small beside their
 * columns here; infinite where it is no number.  work: room for 3n. */
double ns_linalg_pivots_error(int n, const int *start, const int *row, const double *value,
                              klu_symbolic *symbolic, klu_numeric *numeric, klu_common *common, double *work);

#endif
