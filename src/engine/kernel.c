/* src/engine/kernel.c - integrals of what a kernel answers. */
#include "kernel.h"

#include <stdlib.h>

/* Gauss-Legendre on [-1, 1], eight points: the positive nodes and their weights (Abramowitz and
 * Stegun, 25.4). */
enum { HALF = 4 };
static const double node[HALF] = {0.18343464249564980, 0.52553240991632899, 0.79666647741362674,
                                  0.96028985649753623};
static const double weight[HALF] = {0.36268378337836198, 0.31370664587788729, 0.22238103445337447,
                                    0.10122853629037626};

int ns_engine_kernel_integrals(ns_kernel *k, double from, double to, double *x, double *lambda) {
    const int n = k->s->n, m = k->s->m;
    const double mid = (from + to) / 2, half = (to - from) / 2;
    double *at = calloc((size_t)(n + m) + 1, sizeof *at);
    int status = at ? NS_OK : NS_E_MEMORY;
    for (int i = 0; i < n; i++)
        x[i] = 0;
    for (int j = 0; j < m; j++)
        lambda[j] = 0;
    for (int p = 0; p < 2 * HALF && status == NS_OK; p++) {
        const double tau = mid + (p % 2 ? half : -half) * node[p / 2];
        status = k->table->outputs(k, tau, at, at + n);
        for (int i = 0; i < n && status == NS_OK; i++)
            x[i] += half * weight[p / 2] * at[i];
        for (int j = 0; j < m && status == NS_OK; j++)
            lambda[j] += half * weight[p / 2] * at[n + j];
    }
    free(at);
    return status;
}
