/* src/mlcp/glance.h - an upper bound of ns_mlcp_residual(). */
#ifndef NS_GLANCE_H
#define NS_GLANCE_H

#include "nonsmooth/mlcp.h"

/* y (m) gets W lambda + q, size (m) the sums of the sizes of their terms.  Rows as residual.c has them: one
 * whose lambda is at the bound that the sign of y asks for counts 0, any other |y_i| / size_i (the projection
 * does not expand, and Y_i is not below size_i).  lambda is within its bounds. */
double ns_mlcp_glance(const ns_mlcp *p, const double *lambda, double *restrict y, double *restrict size);

#endif
