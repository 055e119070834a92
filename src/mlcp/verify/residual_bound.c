/* src/mlcp/verify/residual_bound.c - an upper bound of the natural residual, in one pass over W. */
#include "residual_bound.h"

#include <math.h>
#include <stddef.h>

#include "linalg/abs_product.h"

int ns_mlcp_nonzeros_fit(int m, const double *W, const ns_nonzeros *z) {
    double all[4] = {0.0, 0.0, 0.0, 0.0}; /* how many */
    int listed = 0, k = 0;
    for (; k + 4 <= m * m; k += 4)
        for (int i = 0; i < 4; i++)
            all[i] += W[k + i] != 0.0 ? 1.0 : 0.0;
    for (; k < m * m; k++)
        listed -= W[k] != 0.0;
    for (int j = 0; j < m; j++, W += m)
        for (k = z->start[j]; k < z->start[j + 1]; k++)
            listed += W[z->row[k]] != 0.0;
    return (int)(all[0] + all[1] + all[2] + all[3]) == listed;
}

void ns_mlcp_nonzeros_find(int m, const double *W, ns_nonzeros *z) {
    int n = 0;
    z->few = 0;
    z->start[0] = 0;
    for (int j = 0; j < m && m <= NS_QUICK && 3 * n <= m * m; j++, W += m) {
        for (int i = 0; i < m; i++) {
            z->row[n] = (unsigned char)i;
            n += W[i] != 0.0;
        }
        z->start[j + 1] = (short)n;
    }
    z->few = m <= NS_QUICK && 3 * n <= m * m;
}

void ns_mlcp_sum_terms(const ns_mlcp *p, const ns_nonzeros *z, const double *lambda, double *restrict y,
                       double *restrict size) {
    const size_t m = (size_t)p->m;
    for (size_t i = 0; i < m; i++) {
        y[i] = p->q[i];
        size[i] = fabs(p->q[i]);
    }
    if (!z || !z->few) {
        ns_linalg_abs_product_add(p->m, p->m, p->m, p->W, lambda, y, size);
        return;
    }
    for (int j = 0; j < p->m; j++)
        if (lambda[j] != 0.0)
            ns_mlcp_nonzeros_add(z, j, p->W + (size_t)j * m, lambda[j], y, size);
}

double ns_mlcp_residual_bound_of(const ns_mlcp *p, const double *lambda, const double *y,
                                 const double *size) {
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

double ns_mlcp_residual_bound(const ns_mlcp *p, const double *lambda, double *restrict y,
                              double *restrict size) {
    ns_mlcp_sum_terms(p, NULL, lambda, y, size);
    return ns_mlcp_residual_bound_of(p, lambda, y, size);
}
