/* src/mlcp/verify/residual_bound.h - an upper bound of ns_mlcp_residual(), in one pass over W. */
#ifndef NS_MLCP_RESIDUAL_BOUND_H
#define NS_MLCP_RESIDUAL_BOUND_H

#include <math.h>

#include "nonsmooth/mlcp.h"

enum { NS_QUICK = 64 }; /* the most pairs for which the transform beats factors */

/* The rows of the entries of W that are not 0: those of column j are row[start[j]..start[j+1]-1].  Only where
 * they are few. */
typedef struct ns_nonzeros {
    int few; /* 0: nothing is known */
    short start[NS_QUICK + 1];
    unsigned char row[NS_QUICK * NS_QUICK / 3 + NS_QUICK + 1];
} ns_nonzeros;

void ns_mlcp_nonzeros_find(int m, const double *W, ns_nonzeros *z);
/* Whether z, the few of another W of this size, has all of those of W. */
int ns_mlcp_nonzeros_fit(int m, const double *W, const ns_nonzeros *z);

/* y += col v, size += |col v| over column j. */
static inline void ns_mlcp_nonzeros_add(const ns_nonzeros *z, int j, const double *col, double v,
                                        double *restrict y, double *restrict size) {
    for (int k = z->start[j]; k < z->start[j + 1]; k++) {
        const int i = z->row[k];
        const double term = col[i] * v;
        y[i] += term;
        size[i] += fabs(term);
    }
}

/* y (m) gets W lambda + q, size (m) the sums of the sizes of their terms.  z: of W, or NULL. */
void ns_mlcp_sum_terms(const ns_mlcp *p, const ns_nonzeros *z, const double *lambda, double *restrict y,
                       double *restrict size);

/* From these: rows as residual.c has them; one whose lambda is at the bound that the sign of y asks for
 * counts 0, any other |y_i| / size_i (the projection does not expand, and Y_i is not below size_i).  lambda
 * is within its bounds.  NAN where terms are beyond a double. */
double ns_mlcp_residual_bound_of(const ns_mlcp *p, const double *lambda, const double *y, const double *size);

/* Both. */
double ns_mlcp_residual_bound(const ns_mlcp *p, const double *lambda, double *restrict y,
                              double *restrict size);

#endif
