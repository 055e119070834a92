/* src/mlcp/infeasible/certificate.h - ns_mlcp_certify() where pairs are put into modes. */
#ifndef NS_MLCP_CERTIFICATE_H
#define NS_MLCP_CERTIFICATE_H

#include <math.h>

#include "nonsmooth/mlcp.h"

enum { NS_OPEN = 2 }; /* beside the modes of a pair: it may be in any */

/* Bounds of y_i, 0 or infinite, if pair i is in a mode, or open. */
static inline double ns_mlcp_least_y(const ns_mlcp *p, int i, int mode) {
    return mode == NS_LOWER || mode == NS_INSIDE || (mode == NS_OPEN && isinf(p->u[i])) ? 0.0 : -INFINITY;
}

static inline double ns_mlcp_most_y(const ns_mlcp *p, int i, int mode) {
    return mode == NS_UPPER || mode == NS_INSIDE || (mode == NS_OPEN && isinf(p->l[i])) ? 0.0 : INFINITY;
}

/* By how much v (m) proves that there is no solution in these modes (m; NULL: all open). */
double ns_mlcp_certify_modes(const ns_mlcp *p, const ns_mode *mode, const double *v);

#endif
