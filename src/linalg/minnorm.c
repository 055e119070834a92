/* src/linalg/minnorm.c - consistent equations whose matrix is singular, by complete orthogonal decomposition.
 */
#include "minnorm.h"

#include <lapacke.h>
#include <math.h>
#include <stdlib.h>

#include "equilibrate.h"
#include "nonsmooth/status.h"

/* Singular values below this, relative to the largest, are zero: entries are about 1, cancelled ones some
 * eps. */
static const double rank_tol = 1e-12;
/* An equation is met when its residual is below this, relative to the sizes of its terms. */
static const double residual_tol = 1e-9;

typedef struct work {
    double *a, *b;
    int *r, *c;
    lapack_int *pivot;
    short *e;
} work;

static int allocate(work *w, size_t n, size_t nrhs) {
    w->a = malloc(sizeof(double) * (n * n + 1));
    w->b = malloc(sizeof(double) * (n * nrhs + 1));
    w->r = malloc(sizeof(int) * (n + 1));
    w->c = malloc(sizeof(int) * (n + 1));
    w->pivot = calloc(n + 1, sizeof(lapack_int));
    w->e = malloc(sizeof(short) * (n * n + 1));
    return w->a && w->b && w->r && w->c && w->pivot && w->e;
}

static void release(work *w) {
    free(w->a);
    free(w->b);
    free(w->r);
    free(w->c);
    free(w->pivot);
    free(w->e);
}

/* Row i of A x = b, column k: is the residual rounding? */
static int is_met(int n, const double *a, const double *x, double b, int i) {
    double sum = -b, size = fabs(b);
    for (int j = 0; j < n; j++) {
        const double term = a[i + j * n] * x[j];
        sum += term;
        size += fabs(term);
    }
    return fabs(sum) <= residual_tol * size;
}

static int all_met(int n, const double *a, int nrhs, const double *b, const double *x) {
    for (int k = 0; k < nrhs; k++)
        for (int i = 0; i < n; i++)
            if (!is_met(n, a, x + k * n, b[i + k * n], i))
                return 0;
    return 1;
}

static int solve(work *w, int n, const double *a, int nrhs, const double *b, double *x) {
    lapack_int rank = 0;
    ns_equilibrate(n, a, n, w->r, w->c, w->e);
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++)
            w->a[i + j * n] = ldexp(a[i + j * n], w->r[i] + w->c[j]);
    for (int k = 0; k < nrhs; k++)
        for (int i = 0; i < n; i++)
            w->b[i + k * n] = ldexp(b[i + k * n], w->r[i]);
    const lapack_int info =
        LAPACKE_dgelsy(LAPACK_COL_MAJOR, n, n, nrhs, w->a, n, w->b, n, w->pivot, rank_tol, &rank);
    if (info != 0)
        return info == LAPACK_WORK_MEMORY_ERROR ? NS_E_MEMORY : NS_E_SINGULAR;
    for (int k = 0; k < nrhs; k++)
        for (int j = 0; j < n; j++)
            x[j + k * n] = ldexp(w->b[j + k * n], w->c[j]);
    return all_met(n, a, nrhs, b, x) ? NS_OK : NS_E_SINGULAR;
}

int ns_min_norm(int n, const double *a, int nrhs, const double *b, double *x) {
    if (n == 0 || nrhs == 0)
        return NS_OK;
    work w = {0};
    const int status = allocate(&w, (size_t)n, (size_t)nrhs) ? solve(&w, n, a, nrhs, b, x) : NS_E_MEMORY;
    release(&w);
    return status;
}
