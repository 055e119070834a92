/* src/linalg/product.c - small matrix-vector products.
 *
 * Columns go by while the sums of some rows stay in registers (simd.h).  Every row is summed up in the order
 * of its columns, whatever the size and whatever the registers: results are the same on all machines.
 */
#include "dense.h"
#include "simd.h"

/* y = from + B z + A x, B and A side by side in that order of summing: what is known first comes first. */
typedef struct factors {
    int p;           /* rows */
    int q, qz;       /* columns of A, B */
    const double *a; /* p*q */
    const double *x;
    const double *b; /* p*qz */
    const double *z;
    int from_y; /* from is what y was, else zero */
} factors;

/* Rows from i on, as many as `width` registers have, at most 8 of them: a constant. */
ALWAYS_INLINE void block(int width, const factors *f, int i, double *y) {
    const double *a = f->a + i, *b = f->b + i;
    ns_simd_wide s[8], *to = (ns_simd_wide *)(y + i);
    NS_UNROLL
    for (int k = 0; k < width; k++)
        s[k] = f->from_y ? to[k] : (ns_simd_wide){0};
    for (int j = 0; j < f->qz; j++, b += f->p) {
        NS_UNROLL
        for (int k = 0; k < width; k++)
            s[k] += ((const ns_simd_wide *)b)[k] * f->z[j];
    }
    for (int j = 0; j < f->q; j++, a += f->p) {
        NS_UNROLL
        for (int k = 0; k < width; k++)
            s[k] += ((const ns_simd_wide *)a)[k] * f->x[j];
    }
    NS_UNROLL
    for (int k = 0; k < width; k++)
        to[k] = s[k];
}

ALWAYS_INLINE void few(int width, const factors *f, int i, double *y) {
    switch (width) {
    case 1:
        block(1, f, i, y);
        break;
    case 2:
        block(2, f, i, y);
        break;
    case 3:
        block(3, f, i, y);
        break;
    case 4:
        block(4, f, i, y);
        break;
    case 5:
        block(5, f, i, y);
        break;
    case 6:
        block(6, f, i, y);
        break;
    case 7:
        block(7, f, i, y);
        break;
    default:
        break;
    }
}

/* Half a register. */
ALWAYS_INLINE void half(const factors *f, int i, double *y) {
    ns_simd s = f->from_y ? *(const ns_simd *)(y + i) : (ns_simd){0};
    for (int j = 0; j < f->qz; j++)
        s += *(const ns_simd *)(f->b + i + (size_t)j * (size_t)f->p) * f->z[j];
    for (int j = 0; j < f->q; j++)
        s += *(const ns_simd *)(f->a + i + (size_t)j * (size_t)f->p) * f->x[j];
    *(ns_simd *)(y + i) = s;
}

static inline void single(const factors *f, int i, double *y) {
    double s = f->from_y ? y[i] : 0;
    for (int j = 0; j < f->qz; j++)
        s += f->b[(size_t)i + (size_t)j * (size_t)f->p] * f->z[j];
    for (int j = 0; j < f->q; j++)
        s += f->a[(size_t)i + (size_t)j * (size_t)f->p] * f->x[j];
    y[i] = s;
}

/* most: registers that there are for sums, 4 or 8. */
ALWAYS_INLINE void product(const factors *f, int most, double *y) {
    int i = 0;
    for (; i + most * NS_WIDE <= f->p; i += most * NS_WIDE)
        block(most, f, i, y);
    const int rest = (f->p - i) / NS_WIDE;
    few(rest, f, i, y);
    for (i += rest * NS_WIDE; i + NS_LANES <= f->p; i += NS_LANES)
        half(f, i, y);
    for (; i < f->p; i++)
        single(f, i, y);
}

static void narrow(const factors *f, double *y) {
    product(f, 4, y);
}

NS_WIDE_TARGET static void wide(const factors *f, double *y) {
    product(f, 8, y);
}

static inline void any(const factors *f, double *y) {
    if (ns_simd_is_wide())
        wide(f, y);
    else
        narrow(f, y);
}

void ns_linalg_matvec_add(int p, int q, const double *a, const double *x, double *y) {
    const factors f = {p, q, 0, a, x, a, x, 1};
    if (q > 0)
        any(&f, y);
}

/* Of a few rows: what the others look up and hand on takes longer than the sums. */
ALWAYS_INLINE void small(int p, int q, const double *a, const double *x, double *y) {
    const factors f = {p, q, 0, a, x, a, x, 0};
    int i = 0;
    for (; i + NS_LANES <= p; i += NS_LANES)
        half(&f, i, y);
    if (i < p)
        single(&f, i, y);
}

void ns_linalg_matvec(int p, int q, const double *a, const double *x, double *y) {
    const factors f = {p, q, 0, a, x, a, x, 0};
    if (q == 0) /* a may be NULL */
        for (int i = 0; i < p; i++)
            y[i] = 0;
    else if (p < NS_WIDE)
        small(p, q, a, x, y);
    else
        any(&f, y);
}

void ns_linalg_matvec_two(int p, int q, const double *x, int qz, const double *z, const double *a,
                          double *y) {
    const factors f = {p, q, qz, a, x, a + (size_t)p * (size_t)q, z, 0};
    any(&f, y);
}
