/* src/linalg/product.c - small matrix-vector products.
 *
 * Columns go by while the sums of some rows stay in registers (lanes.h).  Every row is summed up in the order
 * of its columns, whatever the size and whatever the registers: results are the same on all machines.
 */
#include "dense.h"
#include "lanes.h"

#include <string.h>

/* In all of them: y = from + A x for the first rows of A, as many as their name has registers. */

ALWAYS_INLINE void eight(int p, int q, const double *a, const double *x, const double *from, double *y) {
    const ns_wide *f = (const ns_wide *)from;
    ns_wide s0 = f[0], s1 = f[1], s2 = f[2], s3 = f[3];
    ns_wide s4 = f[4], s5 = f[5], s6 = f[6], s7 = f[7], *to = (ns_wide *)y;
    for (int j = 0; j < q; j++, a += p) {
        const ns_wide *v = (const ns_wide *)a;
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

ALWAYS_INLINE void four(int p, int q, const double *a, const double *x, const double *from, double *y) {
    const ns_wide *f = (const ns_wide *)from;
    ns_wide s0 = f[0], s1 = f[1], s2 = f[2], s3 = f[3], *to = (ns_wide *)y;
    for (int j = 0; j < q; j++, a += p) {
        const ns_wide *v = (const ns_wide *)a;
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

ALWAYS_INLINE void two(int p, int q, const double *a, const double *x, const double *from, double *y) {
    const ns_wide *f = (const ns_wide *)from;
    ns_wide s0 = f[0], s1 = f[1], *to = (ns_wide *)y;
    for (int j = 0; j < q; j++, a += p) {
        const ns_wide *v = (const ns_wide *)a;
        const double by = x[j];
        s0 += v[0] * by;
        s1 += v[1] * by;
    }
    to[0] = s0;
    to[1] = s1;
}

ALWAYS_INLINE void one(int p, int q, const double *a, const double *x, const double *from, double *y) {
    ns_wide s = *(const ns_wide *)from;
    for (int j = 0; j < q; j++, a += p)
        s += *(const ns_wide *)a * x[j];
    *(ns_wide *)y = s;
}

/* Half a register. */
ALWAYS_INLINE void half(int p, int q, const double *a, const double *x, const double *from, double *y) {
    ns_lanes s = *(const ns_lanes *)from;
    for (int j = 0; j < q; j++, a += p)
        s += *(const ns_lanes *)a * x[j];
    *(ns_lanes *)y = s;
}

/* y = A x, or with what y is; step: 0 or 1; most: registers that there are for sums, 4 or 8. */
ALWAYS_INLINE void product(int p, int q, const double *a, const double *x, const double *from, int step,
                           int most, double *y) {
    int i = 0;
    for (; most == 8 && i + 8 * NS_WIDE <= p; i += 8 * NS_WIDE)
        eight(p, q, a + i, x, from + step * i, y + i);
    for (; i + 4 * NS_WIDE <= p; i += 4 * NS_WIDE)
        four(p, q, a + i, x, from + step * i, y + i);
    for (; i + 2 * NS_WIDE <= p; i += 2 * NS_WIDE)
        two(p, q, a + i, x, from + step * i, y + i);
    for (; i + NS_WIDE <= p; i += NS_WIDE)
        one(p, q, a + i, x, from + step * i, y + i);
    for (; i + NS_LANES <= p; i += NS_LANES)
        half(p, q, a + i, x, from + step * i, y + i);
    for (; i < p; i++) {
        double s = from[step * i];
        for (int j = 0; j < q; j++)
            s += a[(size_t)i + (size_t)j * (size_t)p] * x[j];
        y[i] = s;
    }
}

static const double zeros[8 * NS_WIDE];

static void add(int p, int q, const double *a, const double *x, double *y) {
    product(p, q, a, x, y, 1, 4, y);
}

static void set(int p, int q, const double *a, const double *x, double *y) {
    product(p, q, a, x, zeros, 0, 4, y);
}

NS_WIDE_TARGET static void add_wide(int p, int q, const double *a, const double *x, double *y) {
    product(p, q, a, x, y, 1, 8, y);
}

NS_WIDE_TARGET static void set_wide(int p, int q, const double *a, const double *x, double *y) {
    product(p, q, a, x, zeros, 0, 8, y);
}

void ns_matvec_add(int p, int q, const double *a, const double *x, double *y) {
    if (q <= 0)
        return;
    if (ns_is_wide())
        add_wide(p, q, a, x, y);
    else
        add(p, q, a, x, y);
}

void ns_matvec(int p, int q, const double *a, const double *x, double *y) {
    if (q <= 0) {
        if (p > 0)
            memset(y, 0, sizeof *y * (size_t)p);
    } else if (ns_is_wide()) {
        set_wide(p, q, a, x, y);
    } else {
        set(p, q, a, x, y);
    }
}
