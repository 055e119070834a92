/* src/linalg/equilibrate.h - powers of two that bring the entries of a matrix close to 1. */
#ifndef NS_LINALG_EQUILIBRATE_H
#define NS_LINALG_EQUILIBRATE_H

/* Finds exponents r (n), c (n) such that 2^(r_i + c_j) a_ij are at most about 1 in size, every row and every
 * column that is not zero has an entry of about 1, and small entries are lifted as far as others
 * allow.  Entries within 12 binary digits of each other get one common factor.  a: n*n with leading dimension
 * ld, finite.  e: room for n*n shorts.  Exact: no entry is rounded. */
void ns_linalg_equilibrate(int n, const double *a, int ld, int *r, int *c, short *e);

#endif
