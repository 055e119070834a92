/* src/linalg/residual.h - what an equation leaves over, with twice the digits. */
#ifndef NS_LINALG_RESIDUAL_H
#define NS_LINALG_RESIDUAL_H

#include <stddef.h>

/* b - sum of row[at stride] x[at], at = list[0], ..., list[count-1]: rounded once, of a sum that has twice
 * the digits of a double.  A residual summed up in doubles is rounding once x is a solution to some digits;
 * this one shows the error of x, for matrices with a condition up to 1e16. */
double ns_linalg_residual(double b, int count, const int *list, const double *row, size_t stride,
                          const double *x);

#endif
