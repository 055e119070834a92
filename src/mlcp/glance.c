/* src/mlcp/glance.c - an upper bound of the natural residual, in one pass over W. */
#include "glance.h"

#include <math.h>
#include <stddef.h>

#include "../linalg/terms.h"

void ns_mlcp_terms(const ns_mlcp *p, const double *lambda, double *restrict y, double *restrict size) {
    const size_t m = (size_t)p->m;
    for (size_t i = 0; i < m; i++) {
        y[i] = p->q[i];
        size[i] = fabs(p->q[i]);
    }
    ns_terms_add(p->m, p->m, p->m, p->W, lambda, y, size);
}

double ns_mlcp_bound_residual(const ns_mlcp *p, const double *lambda, const double *y, const double *size) {
    const size_t m = (size_t)p->m;
    double most = 0.0, all = 0.0;
    for (size_t i = 0; i < m; i++) {
        all += size[i];
        const int held = y[i] > 0.0 ? lambda[i] <= p->l[i] : lambda[i] >= p->u[i];
        if (!held && !(fabs(y[i]) <= most * size[i]))
            most = fabs(y[i]) / size[i];
    }
    return isfinite(all) ? most : NAN;
}

double ns_mlcp_glance(const ns_mlcp *p, const double *lambda, double *restrict y, double *restrict size) {
    ns_mlcp_terms(p, lambda, y, size);
    return ns_mlcp_bound_residual(p, lambda, y, size);
}
