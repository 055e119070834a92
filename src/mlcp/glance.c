/* src/mlcp/glance.c - an upper bound of the natural residual, in one pass over W. */
#include "glance.h"

#include <math.h>
#include <stddef.h>

double ns_mlcp_glance(const ns_mlcp *p, const double *lambda, double *restrict y, double *restrict size) {
    const size_t m = (size_t)p->m;
    double most = 0.0;
    for (size_t i = 0; i < m; i++) {
        y[i] = p->q[i];
        size[i] = fabs(p->q[i]);
    }
    for (size_t j = 0; j < m; j++) {
        const double *restrict col = p->W + j * m, v = lambda[j];
        if (v == 0.0)
            continue;
        for (size_t i = 0; i < m; i++) {
            const double term = col[i] * v;
            y[i] += term;
            size[i] += fabs(term);
        }
    }
    for (size_t i = 0; i < m; i++) {
        const int held = y[i] > 0.0 ? lambda[i] <= p->l[i] : lambda[i] >= p->u[i];
        if (!held && !(fabs(y[i]) <= most * size[i]))
            most = fabs(y[i]) / size[i];
    }
    return most;
}
