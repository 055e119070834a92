/* src/linalg/minnorm.h - consistent equations whose matrix is singular. */
#ifndef NS_MINNORM_H
#define NS_MINNORM_H

/* For n equations A x = b that contradict nowhere but leave something open (two closed switches in parallel,
 * a part that floats): the x of least norm, in units that make the entries of A about 1.  a (n*n) and b
 * (n*nrhs) are left alone, x is n*nrhs.  Errors: SINGULAR (some column of b contradicts A), MEMORY. */
int ns_min_norm(int n, const double *a, int nrhs, const double *b, double *x);

#endif
