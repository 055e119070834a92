/* src/linalg/sparse_pivots.h - whether pivots of KLU's factors are but rounding. */
#ifndef NS_LINALG_SPARSE_PIVOTS_H
#define NS_LINALG_SPARSE_PIVOTS_H

#include <suitesparse/klu.h>

/* 1 if one is rounding of the terms that it was summed from: the matrix (n*n, column by column) is as good as
 * singular, in whatever units it is.  0 too where there is no memory to tell. */
int ns_linalg_pivots_vanish(int n, const int *start, const int *row, const double *value,
                            klu_symbolic *symbolic, klu_numeric *numeric, klu_common *common);

#endif
