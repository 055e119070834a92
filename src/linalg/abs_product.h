/* src/linalg/abs_product.h - a product with the sizes of what it was summed from. */
#ifndef NS_LINALG_ABS_PRODUCT_H
#define NS_LINALG_ABS_PRODUCT_H

/* y += A x,  size += |A| |x|;  A is p*q with leading dimension ld.  Where x is 0 nothing is read. */
void ns_linalg_abs_product_add(int p, int q, int ld, const double *A, const double *x, double *restrict y,
                               double *restrict size);

#endif
