/* src/linalg/product.c - small matrix-vector products.
 *
 * Columns go by while the sums of some rows stay in registers (lanes.h).  Every row is summed up in the order
 * of its columns, whatever the size.
 */
#include "dense.h"
#include "lanes.h"

#include <string.h>

/* In all of them: y = from + A x for the first rows of A. */

static inline void eight(int p, int q, const double *a, const double *x, const double *from, double *y) {
    const ns_lanes *f = (const ns_lanes *)from;
    ns_lanes s0 = f[0], s1 = f[1], s2 = f[2];
    ns_lanes s3 = f[3], s4 = f[4], s5 = f[5];
    ns_lanes s6 = f[6], s7 = f[7], *to = (ns_lanes *)y;
    for (int j = 0; j < q; j++, a += p) {
        const ns_lanes *v = (const ns_lanes *)a;
        const double by = x[j];
        s0 += v[0] * by;
        s1 += v[1] * by;
        s2 += v[2] * by;
        s3 += v[3] * by;
        s4 += v[4] * by;
        s5 += v[5] * by;
        s6 += v[6] * by;
        s7 += v[7] * by;
    }
    to[0] = s0;
    to[1] = s1;
    to[2] = s2;
    to[3] = s3;
    to[4] = s4;
    to[5] = s5;
    to[6] = s6;
    to[7] = s7;
}

static inline void four(int p, int q, const double *a, const double *x, const double *from, double *y) {
    const ns_lanes *f = (const ns_lanes *)from;
    ns_lanes s0 = f[0], s1 = f[1], s2 = f[2];
    ns_lanes s3 = f[3], *to = (ns_lanes *)y;
    for (int j = 0; j < q; j++, a += p) {
        const ns_lanes *v = (const ns_lanes *)a;
        const double by = x[j];
        s0 += v[0] * by;
        s1 += v[1] * by;
        s2 += v[2] * by;
        s3 += v[3] * by;
    }
    to[0] = s0;
    to[1] = s1;
    to[2] = s2;
    to[3] = s3;
}

static inline void two(int p, int q, const double *a, const double *x, const double *from, double *y) {
    const ns_lanes *f = (const ns_lanes *)from;
    ns_lanes s0 = f[0], s1 = f[1], *to = (ns_lanes *)y;
    for (int j = 0; j < q; j++, a += p) {
        const ns_lanes *v = (const ns_lanes *)a;
        const double by = x[j];
        s0 += v[0] * by;
        s1 += v[1] * by;
    }
    to[0] = s0;
    to[1] = s1;
}

static inline void one(int p, int q, const double *a, const double *x, const double *from, double *y) {
    const ns_lanes *f = (const ns_lanes *)from;
    ns_lanes s = f[0], *to = (ns_lanes *)y;
    for (int j = 0; j < q; j++, a += p)
        s += *(const ns_lanes *)a * x[j];
    *to = s;
}

/* y = A x, or with what y is; step: 0 or 1. */
static inline void product(int p, int q, const double *a, const double *x, const double *from, int step,
                           double *y) {
    int i = 0;
    for (; i + 8 * NS_LANES <= p; i += 8 * NS_LANES)
        eight(p, q, a + i, x, from + step * i, y + i);
    for (; i + 4 * NS_LANES <= p; i += 4 * NS_LANES)
        four(p, q, a + i, x, from + step * i, y + i);
    for (; i + 2 * NS_LANES <= p; i += 2 * NS_LANES)
        two(p, q, a + i, x, from + step * i, y + i);
    for (; i + NS_LANES <= p; i += NS_LANES)
        one(p, q, a + i, x, from + step * i, y + i);
    for (; i < p; i++) {
        double s = from[step * i];
        for (int j = 0; j < q; j++)
            s += a[(size_t)i + (size_t)j * (size_t)p] * x[j];
        y[i] = s;
    }
}

void ns_matvec_add(int p, int q, const double *a, const double *x, double *y) {
    if (q > 0)
        product(p, q, a, x, y, 1, y);
}

void ns_matvec(int p, int q, const double *a, const double *x, double *y) {
    static const double zeros[8 * NS_LANES];
    if (q > 0)
        product(p, q, a, x, zeros, 0, y);
    else if (p > 0)
        memset(y, 0, sizeof *y * (size_t)p);
}
