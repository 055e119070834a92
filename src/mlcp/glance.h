/* src/mlcp/glance.h - an upper bound of ns_mlcp_residual(), in one pass over W. */
#ifndef NS_GLANCE_H
#define NS_GLANCE_H

#include "nonsmooth/mlcp.h"

/* y (m) gets W lambda + q, size (m) the sums of the sizes of their terms. */
void ns_mlcp_terms(const ns_mlcp *p, const double *lambda, double *restrict y, double *restrict size);

/* From these: rows as residual.c has them; one whose lambda is at the bound that the sign of y asks for
 * counts 0, any other |y_i| / size_i (the projection does not expand, and Y_i is not below size_i).  lambda
 * is within its bounds.  NAN where terms are beyond a double. */
double ns_mlcp_bound_residual(const ns_mlcp *p, const double *lambda, const double *y, const double *size);

/* Both. */
double ns_mlcp_glance(const ns_mlcp *p, const double *lambda, double *restrict y, double *restrict size);

#endif
