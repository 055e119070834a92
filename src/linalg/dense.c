/* src/linalg/dense.c - LU factors through LAPACK; what arrays of numbers need. */
#include "dense.h"

#include <lapacke.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "equilibrate.h"
#include "matching.h"
#include "nonsmooth/status.h"
#include "small.h"

struct ns_lu {
    int cap, n;
    double norm;  /* of the scaled matrix, 1-norm */
    double ratio; /* of its smallest pivot to the largest */
    double *a;    /* n*n, the factors of the scaled matrix */
    double *work; /* 4*cap */
    double *rs;   /* n, row factors (powers of two) */
    double *cs;   /* n, column factors */
    int *r, *c;   /* n, their exponents */
    int *match;   /* 6 (n+1), for the matching, then for small.c's pattern of e: 2 n, and LONE_SOLVES if it is
                   * known, before that how many right-hand sides came */
    lapack_int *piv, *iwork;
    short *e;
};

int ns_linalg_lu_create(int n, ns_lu **out) {
    if (!out)
        return NS_E_NULL;
    *out = NULL;
    if (n < 0 || n > 30000) /* n*n ints must not overflow */
        return NS_E_SIZE;
    ns_lu *f = calloc(1, sizeof *f);
    if (!f)
        return NS_E_MEMORY;
    size_t k = (size_t)n;
    f->cap = n;
    f->a = malloc((k * k + 6 * k + 1) * sizeof *f->a);
    f->r = malloc((8 * k + 7) * sizeof *f->r);
    f->piv = malloc((2 * k + 1) * sizeof *f->piv);
    f->e = malloc((k * k + 1) * sizeof *f->e);
    if (!f->a || !f->r || !f->piv || !f->e) {
        ns_linalg_lu_free(f);
        return NS_E_MEMORY;
    }
    f->work = f->a + k * k;
    f->rs = f->work + 4 * k;
    f->cs = f->rs + k;
    f->c = f->r + k;
    f->match = f->c + k;
    f->iwork = f->piv + k;
    *out = f;
    return NS_OK;
}

void ns_linalg_lu_free(ns_lu *f) {
    if (!f)
        return;
    free(f->a);
    free(f->r);
    free(f->piv);
    free(f->e);
    free(f);
}

/* 2^k, exact; k is kept where 2^k is a normal number. */
static double power_of_two(int k) {
    k = k < -1000 ? -1000 : k > 1000 ? 1000 : k;
    uint64_t bits = (uint64_t)(k + 1023) << 52; /* IEEE 754 */
    double v;
    memcpy(&v, &bits, sizeof v);
    return v;
}

/* Copies a, scaled by 2^r, 2^c, into the factors' place; returns its 1-norm. */
static double load(ns_lu *f, int n, const double *a) {
    double norm = 0.0;
    for (int j = 0; j < n; j++) {
        const double *src = a + (size_t)j * (size_t)n;
        double *dst = f->a + (size_t)j * (size_t)n, sum = 0.0;
        for (int i = 0; i < n; i++) {
            dst[i] = src[i] * f->rs[i] * f->cs[j];
            sum += fabs(dst[i]);
        }
        norm = fmax(norm, sum);
    }
    return norm;
}

/* The scaling by the best permutation, or one of largest entries: singular whatever its numbers are. */
static void find_scaling(ns_lu *f, int n, const double *a) {
    if (!ns_linalg_match_scale(n, a, f->r, f->c, f->e, f->match))
        ns_linalg_equilibrate(n, a, n, f->r, f->c, f->e);
}

/* -(binary exponent) of a, 0 for 0. */
static int down(double a) {
    int e = 0;
    if (a > 0.0)
        (void)frexp(a, &e);
    return -e;
}

/* The scaling by largest entries, of rows in units 2^c of the columns, then of columns. */
static void find_quickly(ns_lu *f, int n, const double *a, const int *c) {
    double *most = f->rs;
    for (int i = 0; i < n; i++)
        most[i] = 0.0;
    for (int j = 0; j < n; j++) {
        const double *col = a + (size_t)j * (size_t)n, unit = power_of_two(c[j]);
        for (int i = 0; i < n; i++) {
            const double v = fabs(col[i]) * unit;
            most[i] = v > most[i] ? v : most[i];
        }
    }
    for (int i = 0; i < n; i++) {
        f->r[i] = down(most[i]);
        most[i] = power_of_two(f->r[i]);
    }
    for (int j = 0; j < n; j++) {
        const double *col = a + (size_t)j * (size_t)n;
        double top = 0.0;
        for (int i = 0; i < n; i++) {
            const double v = fabs(col[i]) * most[i];
            top = v > top ? v : top;
        }
        f->c[j] = down(top);
    }
}

/* The smallest pivot over the largest. */
static double ratio_of_pivots(const ns_lu *f) {
    double lo = INFINITY, hi = 0.0;
    for (int k = 0; k < f->n; k++) {
        const double u = fabs(f->a[(size_t)k * (size_t)(f->n + 1)]);
        hi = fmax(hi, u);
        lo = u < lo ? u : lo;
    }
    return hi > 0.0 ? lo / hi : 0.0;
}

/* c: NULL, or exponents of the units of the columns, then taken instead of the best permutation. */
static int scale(ns_lu *f, int n, const double *a, const int *c) {
    if (!f || (n > 0 && !a))
        return NS_E_NULL;
    if (n < 0 || n > f->cap)
        return NS_E_SIZE;
    f->n = 0;
    if (!ns_linalg_finite((size_t)n * (size_t)n, a))
        return NS_E_NUMBER;
    f->n = n;
    if (n > 0 && c)
        find_quickly(f, n, a, c);
    else if (n > 0)
        find_scaling(f, n, a);
    for (int i = 0; i < n; i++) {
        f->rs[i] = power_of_two(f->r[i]);
        f->cs[i] = power_of_two(f->c[i]);
    }
    return NS_OK;
}

static int factor(ns_lu *f, int n, const double *a, const int *c, double *rcond) {
    const int status = scale(f, n, a, c);
    if (rcond && status != NS_E_NULL && status != NS_E_SIZE)
        *rcond = n == 0 ? 1.0 : 0.0;
    if (status != NS_OK || n == 0)
        return status;
    f->norm = load(f, n, a);
    const lapack_int info = n <= NS_SMALL ? ns_linalg_small_factor(n, f->a, f->piv)
                                          : LAPACKE_dgetrf_work(LAPACK_COL_MAJOR, n, n, f->a, n, f->piv);
    f->match[2 * n] = 0;
    f->ratio = ratio_of_pivots(f);
    int bad = info != 0 || !(f->ratio > 1e-300);
    if (!bad && rcond) {
        *rcond = ns_linalg_lu_rcond(f);
        bad = !(*rcond > 1e-300);
    }
    return bad ? NS_E_SINGULAR : NS_OK;
}

int ns_linalg_lu_scale(ns_lu *f, int n, const double *a) {
    return scale(f, n, a, NULL);
}

double ns_linalg_lu_rcond(ns_lu *f) {
    double rcond = 1.0;
    if (f->n > 0)
        LAPACKE_dgecon_work(LAPACK_COL_MAJOR, '1', f->n, f->a, f->n, f->norm, &rcond, f->work, f->iwork);
    return rcond;
}

double ns_linalg_lu_pivots(const ns_lu *f) {
    return f->n > 0 ? f->ratio : 1.0;
}

int ns_linalg_lu_factor(ns_lu *f, int n, const double *a, double *rcond) {
    return factor(f, n, a, NULL, rcond);
}

int ns_linalg_lu_factor_quickly(ns_lu *f, int n, const double *a, const int *c, double *rcond) {
    return factor(f, n, a, c, rcond);
}

/* So many right-hand sides that come alone are solved for without the pattern, which takes as long as one. */
enum { LONE_SOLVES = 2 };

static void solve_small(const ns_lu *f, int nrhs, double *b) {
    int *come = &f->match[2 * f->n];
    if (*come < LONE_SOLVES && (nrhs > 1 || ++*come == LONE_SOLVES)) {
        ns_linalg_small_pattern(f->n, f->a, f->e, f->match);
        *come = LONE_SOLVES;
    }
    ns_linalg_small_solve(f->n, f->a, f->piv, *come == LONE_SOLVES ? f->e : NULL, f->match, nrhs, b);
}

/* b = S_to A_scaled^-1 S_from b, or with A_scaled transposed. */
static void solve(const ns_lu *f, char transposed, const double *from, const double *to, int nrhs,
                  double *b) {
    int n = f->n;
    if (n == 0 || nrhs <= 0)
        return;
    for (int k = 0; k < nrhs; k++)
        for (int i = 0; i < n; i++)
            b[(size_t)i + (size_t)k * (size_t)n] *= from[i];
    if (n > NS_SMALL)
        LAPACKE_dgetrs_work(LAPACK_COL_MAJOR, transposed, n, nrhs, f->a, n, f->piv, b, n);
    else if (transposed == 'N')
        solve_small(f, nrhs, b);
    else
        for (int k = 0; k < nrhs; k++)
            ns_linalg_small_solve_transposed(n, f->a, f->piv, b + k * n);
    for (int k = 0; k < nrhs; k++)
        for (int i = 0; i < n; i++)
            b[(size_t)i + (size_t)k * (size_t)n] *= to[i];
}

void ns_linalg_lu_solve(const ns_lu *f, int nrhs, double *b) {
    solve(f, 'N', f->rs, f->cs, nrhs, b);
}

void ns_linalg_lu_solve_transposed(const ns_lu *f, int nrhs, double *b) {
    solve(f, 'T', f->cs, f->rs, nrhs, b);
}

const double *ns_linalg_lu_rows(const ns_lu *f) {
    return f->rs;
}

const double *ns_linalg_lu_units(const ns_lu *f) {
    return f->cs;
}

double ns_linalg_lu_largest(const ns_lu *f, const double *x) {
    double most = 0.0;
    for (int i = 0; i < f->n; i++)
        most = fmax(most, fabs(x[i]) / f->cs[i]);
    return most;
}

double *ns_linalg_vector(size_t count, int *failed) {
    double *v = calloc(count ? count : 1, sizeof(double));
    *failed |= !v;
    return v;
}

void ns_linalg_copy(size_t n, const double *x, double *y) {
    if (n > 0)
        memcpy(y, x, n * sizeof *y);
}

/* 0 times a finite number is 0, times NaN or infinity NaN. */
int ns_linalg_finite(size_t n, const double *x) {
    double s[4] = {0.0, 0.0, 0.0, 0.0};
    size_t i = 0;
    for (; i + 4 <= n; i += 4)
        for (int k = 0; k < 4; k++)
            s[k] += 0.0 * x[i + (size_t)k];
    for (; i < n; i++)
        s[0] += 0.0 * x[i];
    return s[0] + s[1] + s[2] + s[3] == 0.0;
}

int ns_linalg_eigenvalues(int n, double *a, double *re, double *im) {
    double none = 0;
    if (n == 0)
        return NS_OK;
    if (!ns_linalg_finite((size_t)n * (size_t)n, a))
        return NS_E_NUMBER;
    if (n <= 2 && ns_linalg_small_eigenvalues(n, a, re, im))
        return NS_OK;
    const lapack_int info = LAPACKE_dgeev(LAPACK_COL_MAJOR, 'N', 'N', n, a, n, re, im, &none, 1, &none, 1);
    if (info == LAPACK_WORK_MEMORY_ERROR)
        return NS_E_MEMORY;
    return info == 0 ? NS_OK : NS_E_NUMBER;
}

int ns_linalg_eigenvectors(int n, double *a, double *re, double *im, double *left, double *right) {
    if (n == 0)
        return NS_OK;
    if (!ns_linalg_finite((size_t)n * (size_t)n, a))
        return NS_E_NUMBER;
    const lapack_int info = LAPACKE_dgeev(LAPACK_COL_MAJOR, 'V', 'V', n, a, n, re, im, left, n, right, n);
    if (info == LAPACK_WORK_MEMORY_ERROR)
        return NS_E_MEMORY;
    return info == 0 ? NS_OK : NS_E_NUMBER;
}

void ns_linalg_exchange(int p, int q, double *T, int row, int col, double cancelled) {
    double *e = T + (size_t)col * (size_t)p;
    const double pivot = e[row];
    for (int c = 0; c < q; c++) {
        double *t = T + (size_t)c * (size_t)p;
        const double f = -t[row] / pivot;
        if (c == col || f == 0.0)
            continue;
        for (int r = 0; r < p; r++) {
            const double sum = t[r] + f * e[r];
            t[r] = fabs(sum) <= cancelled * fabs(t[r]) ? 0.0 : sum;
        }
        t[row] = f;
    }
    for (int r = 0; r < p; r++)
        e[r] /= pivot;
    e[row] = 1.0 / pivot;
}
