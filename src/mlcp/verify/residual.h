/* src/mlcp/verify/residual.h - ns_mlcp_residual() without its checks, with room from the caller. */
#ifndef NS_MLCP_RESIDUAL_H
#define NS_MLCP_RESIDUAL_H

#include "linalg/column_scaling.h"
#include "nonsmooth/mlcp.h"

enum { NS_MEASURE_WORK = 5 + NS_UNITS_WORK };

/* work: NS_MEASURE_WORK*m; gets y and, after it, 1/Y.  p and lambda are finite.  together: rounding of any
 * lambda may stand in any row, joined with it or not. */
double ns_mlcp_measure(const ns_mlcp *p, const double *lambda, int together, double *work, int *worst);

/* 1 if p or an array is NULL, or a number but those of W is none: not to be measured. */
int ns_mlcp_unsound(const ns_mlcp *p, const double *lambda);

#endif
