/* src/linalg/small.c - LU factors and eigenvalues of small matrices. */
#include "small.h"

#include "simd.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

static void swap(double *a, double *b) {
    const double was = *a;
    *a = *b;
    *b = was;
}

static int largest(int n, const double *x) {
    int at = 0;
    for (int i = 1; i < n; i++)
        if (fabs(x[i]) > fabs(x[at]))
            at = i;
    return at;
}

/* y -= by x */
static inline void take_off(int n, double by, const double *x, double *y) {
    for (int i = 0; i < n; i++)
        y[i] -= by * x[i];
}

ALWAYS_INLINE void take_off_widely(int n, double by, const double *x, double *y) {
    int i = 0;
    for (; i + NS_WIDE <= n; i += NS_WIDE)
        *(ns_simd_wide *)(y + i) -= by * *(const ns_simd_wide *)(x + i);
    take_off(n - i, by, x + i, y + i);
}

/* Row after row: of few. */
static int eliminate_few(int n, double *a, int *piv) {
    int first = 0;
    for (int k = 0; k < n; k++) {
        double *col = a + k * n;
        const int at = k + largest(n - k, col + k);
        piv[k] = at + 1;
        if (col[at] == 0) {
            first = first ? first : k + 1;
            continue;
        }
        for (int j = 0; at != k && j < n; j++)
            swap(&a[k + j * n], &a[at + j * n]);
        for (int i = k + 1; i < n; i++)
            col[i] /= col[k];
        for (int j = k + 1; j < n; j++)
            if (a[k + j * n] != 0)
                take_off(n - k - 1, a[k + j * n], col + k + 1, a + j * n + k + 1);
    }
    return first;
}

/* Column after column, each by those before it: the same sums, along columns alone. */
ALWAYS_INLINE int eliminate_many(int n, double *a, int *piv) {
    int first = 0;
    for (int j = 0; j < n; j++) {
        double *col = a + j * n;
        for (int k = 0; k < j; k++)
            swap(&col[k], &col[piv[k] - 1]);
        for (int k = 0; k < j; k++)
            if (col[k] != 0)
                take_off_widely(n - k - 1, col[k], a + k * n + k + 1, col + k + 1);
        const int at = j + largest(n - j, col + j);
        piv[j] = at + 1;
        if (col[at] == 0) {
            first = first ? first : j + 1;
            continue;
        }
        for (int k = 0; at != j && k <= j; k++)
            swap(&a[j + k * n], &a[at + k * n]);
        for (int i = j + 1; i < n; i++)
            col[i] /= col[j];
    }
    return first;
}

NS_WIDE_TARGET static int many_wide(int n, double *a, int *piv) {
    return eliminate_many(n, a, piv);
}

static int many_narrow(int n, double *a, int *piv) {
    return eliminate_many(n, a, piv);
}

int ns_linalg_small_factor(int n, double *a, int *piv) {
    enum { FEW = 32 };
    return (n <= FEW ? eliminate_few : ns_simd_is_wide() ? many_wide : many_narrow)(n, a, piv);
}

static void solve_one(int n, const double *a, const int *piv, double *b) {
    for (int k = 0; k < n; k++)
        swap(&b[k], &b[piv[k] - 1]);
    for (int k = 0; k < n; k++)
        if (b[k] != 0)
            take_off(n - k - 1, b[k], a + k * n + k + 1, b + k + 1);
    for (int k = n - 1; k >= 0; k--) {
        b[k] /= a[k + k * n];
        if (b[k] != 0)
            take_off(k, b[k], a + k * n, b);
    }
}

/* The same, past what is zero. */
static void solve_one_by(int n, const double *a, const int *piv, const short *row, const int *count,
                         double *b) {
    for (int k = 0; k < n; k++)
        swap(&b[k], &b[piv[k] - 1]);
    for (int k = 0; k < n; k++)
        for (int t = 0; t < count[2 * k] && b[k] != 0; t++)
            b[row[t + k * n]] -= b[k] * a[row[t + k * n] + k * n];
    for (int k = n - 1; k >= 0; k--) {
        b[k] /= a[k + k * n];
        for (int t = count[2 * k]; t < count[2 * k + 1] && b[k] != 0; t++)
            b[row[t + k * n]] -= b[k] * a[row[t + k * n] + k * n];
    }
}

void ns_linalg_small_pattern(int n, const double *a, short *row, int *count) {
    for (int k = 0; k < n; k++) {
        const double *col = a + k * n;
        short *of = row + k * n;
        int found = 0;
        for (int i = k + 1; i < n; i++) {
            of[found] = (short)i;
            found += col[i] != 0;
        }
        count[2 * k] = found;
        for (int i = 0; i < k; i++) {
            of[found] = (short)i;
            found += col[i] != 0;
        }
        count[2 * k + 1] = found;
    }
}

/* As many as a register holds, side by side. */
ALWAYS_INLINE void substitute(int n, const double *a, const short *row, const int *count, ns_simd_wide *b) {
    for (int k = 0; k < n; k++)
        for (int t = 0; t < count[2 * k]; t++)
            b[row[t + k * n]] -= a[row[t + k * n] + k * n] * b[k];
    for (int k = n - 1; k >= 0; k--) {
        b[k] /= a[k + k * n];
        for (int t = count[2 * k]; t < count[2 * k + 1]; t++)
            b[row[t + k * n]] -= a[row[t + k * n] + k * n] * b[k];
    }
}

NS_WIDE_TARGET static void substitute_wide(int n, const double *a, const short *row, const int *count,
                                           ns_simd_wide *b) {
    substitute(n, a, row, count, b);
}

static void substitute_narrow(int n, const double *a, const short *row, const int *count, ns_simd_wide *b) {
    substitute(n, a, row, count, b);
}

/* So many of them (count), the others zero. */
static void solve_beside(int n, const double *a, const int *piv, const short *row, const int *nonzeros,
                         int count, double *b) {
    double beside[NS_SMALL * NS_WIDE];
    int from[NS_SMALL];
    memset(beside, 0, sizeof *beside * NS_WIDE * (size_t)n);
    for (int i = 0; i < n; i++)
        from[i] = i;
    for (int k = 0; k < n; k++) {
        const int was = from[k];
        from[k] = from[piv[k] - 1];
        from[piv[k] - 1] = was;
    }
    for (int i = 0; i < n; i++)
        for (int c = 0; c < count; c++)
            beside[i * NS_WIDE + c] = b[from[i] + c * n];
    (ns_simd_is_wide() ? substitute_wide : substitute_narrow)(n, a, row, nonzeros, (ns_simd_wide *)beside);
    for (int i = 0; i < n; i++)
        for (int c = 0; c < count; c++)
            b[i + c * n] = beside[i * NS_WIDE + c];
}

void ns_linalg_small_solve(int n, const double *a, const int *piv, const short *row, const int *nonzeros,
                           int nrhs, double *b) {
    for (int k = 0; k < nrhs; k += NS_WIDE) {
        const int count = nrhs - k < NS_WIDE ? nrhs - k : NS_WIDE;
        if (count == 1 && !row)
            solve_one(n, a, piv, b + (size_t)k * (size_t)n);
        else if (count == 1)
            solve_one_by(n, a, piv, row, nonzeros, b + (size_t)k * (size_t)n);
        else
            solve_beside(n, a, piv, row, nonzeros, count, b + (size_t)k * (size_t)n);
    }
}

void ns_linalg_small_solve_transposed(int n, const double *a, const int *piv, double *b) {
    for (int k = 0; k < n; k++)
        b[k] = (b[k] - ns_dot(k, a + k * n, b)) / a[k + k * n];
    for (int k = n - 1; k >= 0; k--)
        b[k] -= ns_dot(n - k - 1, a + k * n + k + 1, b + k + 1);
    for (int k = n - 1; k >= 0; k--)
        swap(&b[k], &b[piv[k] - 1]);
}

/* The larger of two real ones is a sum of numbers of one sign; the other is what makes up their product. */
int ns_linalg_small_eigenvalues(int n, const double *a, double *re, double *im) {
    re[0] = a[0];
    im[0] = 0;
    if (n == 1)
        return 1;
    const double half = (a[0] - a[3]) / 2, cross = a[1] * a[2], under = half * half + cross;
    im[1] = 0;
    if (!isfinite(under) || (cross == 0 && a[1] != 0 && a[2] != 0))
        return 0;
    if (under < 0) {
        re[0] = re[1] = a[3] + half;
        im[0] = sqrt(-under);
        im[1] = -im[0];
        return 1;
    }
    const double by = half + copysign(sqrt(under), half);
    re[0] = a[3] + by;
    re[1] = by == 0 ? a[3] : a[3] - cross / by;
    return 1;
}
