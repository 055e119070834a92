/* src/linalg/matching.h - scaling by the permutation with the largest product. */
#ifndef NS_LINALG_MATCHING_H
#define NS_LINALG_MATCHING_H

/* Finds exponents r (n), c (n) such that all 2^(r_i + c_j) |a_ij| are below 1, and those of a permutation
 * with the largest product between 1/2 and 1: where a pivot should come from, whatever the units and however
 * small the other entries are.  a: n*n, finite; e: n*n, work: 6 (n+1).  Returns 0 if every permutation meets
 * a zero. */
int ns_linalg_match_scale(int n, const double *a, int *r, int *c, short *e, int *work);

#endif
