/* src/linalg/terms.h - a product with the sizes of what it was summed from. */
#ifndef NS_TERMS_H
#define NS_TERMS_H

/* y += A x,  size += |A| |x|;  A is p*q with leading dimension ld.  Where x is 0 nothing is read. */
void ns_terms_add(int p, int q, int ld, const double *A, const double *x, double *restrict y,
                  double *restrict size);

#endif
