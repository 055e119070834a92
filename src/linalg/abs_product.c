/* src/linalg/abs_product.c - a product with the sizes of what it was summed from. */
#include "abs_product.h"

#include <math.h>
#include <stddef.h>

enum { TILE = 8 };   /* rows whose sums stay in registers while the columns go by */
enum { LONG = 256 }; /* rows, from which the strides between columns cost more than that saves */

/* n <= TILE rows. */
static inline void rows(int n, int q, int ld, const double *restrict A, const double *restrict x,
                        double *restrict y, double *restrict size) {
    double sum[TILE], terms[TILE];
    for (int i = 0; i < n; i++) {
        sum[i] = y[i];
        terms[i] = size[i];
    }
    for (int j = 0; j < q; j++, A += ld) {
        const double v = x[j];
        if (v == 0.0)
            continue;
        for (int i = 0; i < n; i++) {
            const double term = A[i] * v;
            sum[i] += term;
            terms[i] += fabs(term);
        }
    }
    for (int i = 0; i < n; i++) {
        y[i] = sum[i];
        size[i] = terms[i];
    }
}

/* One column after the other. */
static void columns(int p, int q, int ld, const double *restrict A, const double *restrict x,
                    double *restrict y, double *restrict size) {
    for (int j = 0; j < q; j++, A += ld) {
        const double v = x[j];
        if (v == 0.0)
            continue;
        for (int i = 0; i < p; i++) {
            const double term = A[i] * v;
            y[i] += term;
            size[i] += fabs(term);
        }
    }
}

void ns_linalg_abs_product_add(int p, int q, int ld, const double *A, const double *x, double *restrict y,
                               double *restrict size) {
    int i = 0;
    if (p > LONG) {
        columns(p, q, ld, A, x, y, size);
        return;
    }
    for (; i + TILE <= p; i += TILE)
        rows(TILE, q, ld, A + i, x, y + i, size + i);
    for (; i + 4 <= p; i += 4)
        rows(4, q, ld, A + i, x, y + i, size + i);
    for (; i < p; i++)
        rows(1, q, ld, A + i, x, y + i, size + i);
}
