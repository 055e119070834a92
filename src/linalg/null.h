/* src/linalg/null.h - what a singular matrix leaves open. */
#ifndef NS_LINALG_NULL_H
#define NS_LINALG_NULL_H

/* weight (n): how far, of 1, unknown j lies in the null space of a (n*n), whose entry (i,j) times rows[i]
 * units[j] is about 1 or less; all 0 where a is regular.  Errors: MEMORY, NUMBER (weight is 0 then). */
int ns_linalg_null_weights(int n, const double *a, const double *rows, const double *units, double *weight);

#endif
