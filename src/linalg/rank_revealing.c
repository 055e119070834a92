/* src/linalg/rank_revealing.c - a square matrix of any rank, by the elimination that splits the rows of a
 * system: what is rounding and what is small is told apart entry by entry, and null vectors of a circuit's
 * matrices come out as integers where they are. */
#include "rank_revealing.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "nonsmooth/status.h"
#include "row_split.h"

/* Left null vectors of a into T, its independent rows into row. */
static int take_apart(int n, const double *a, const double *size, double *T, int *rank, int *row) {
    const int status = ns_linalg_row_split_rows(n, a, size, T, rank);
    for (int k = 0; k < *rank && status == NS_OK; k++)
        for (int j = 0; j < n; j++)
            if (T[k + j * n] != 0)
                row[k] = j; /* rows of T before rank are those of the identity */
    return status;
}

static void transpose(int n, const double *a, double *to) {
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++)
            to[i + j * n] = a[j + i * n];
}

/* work: 2 n*n */
static int fill(ns_ranked *f, const double *size, double *work) {
    const int n = f->n;
    double *sizes = work + (size_t)n * (size_t)n;
    int columns = 0, status = take_apart(n, f->a, size, f->left, &f->rank, f->row);
    transpose(n, f->a, work);
    transpose(n, size, sizes);
    if (status == NS_OK)
        status = take_apart(n, work, sizes, f->right, &columns, f->column);
    if (status != NS_OK)
        return status;
    if (columns != f->rank)
        return NS_E_SINGULAR;
    for (int j = 0; j < f->rank; j++)
        for (int i = 0; i < f->rank; i++)
            f->core[i + j * f->rank] = f->a[f->row[i] + f->column[j] * n];
    return ns_linalg_lu_factor(f->lu, f->rank, f->core, NULL);
}

int ns_linalg_ranked_create(int n, const double *a, const double *size, ns_ranked **out) {
    const size_t k = (size_t)n, square = k * k;
    *out = NULL;
    ns_ranked *f = calloc(1, sizeof *f);
    if (!f)
        return NS_E_MEMORY;
    f->n = n;
    f->a = a;
    f->left = calloc(5 * square + 2 * k + 1, sizeof(double));
    f->row = calloc(2 * k + 1, sizeof(int));
    int status = f->left && f->row ? ns_linalg_lu_create(n, &f->lu) : NS_E_MEMORY;
    if (status == NS_OK) {
        f->right = f->left + square;
        f->core = f->right + square;
        f->work = f->core + 3 * square;
        f->column = f->row + n;
        status = fill(f, size, f->core + square);
    }
    if (status != NS_OK) {
        ns_linalg_ranked_free(f);
        return status;
    }
    *out = f;
    return NS_OK;
}

void ns_linalg_ranked_free(ns_ranked *f) {
    if (!f)
        return;
    free(f->left);
    free(f->row);
    ns_linalg_lu_free(f->lu);
    free(f);
}

void ns_linalg_ranked_solve(ns_ranked *f, const double *b, double *x) {
    const int r = f->rank;
    double *y = f->work, *step = f->work + f->n;
    memset(f->work, 0, sizeof(double) * 2 * (size_t)f->n);
    for (int round = 0; round < 3; round++) { /* two of refinement */
        for (int i = 0; i < r; i++)
            step[i] = -b[f->row[i]];
        ns_linalg_matvec_add(r, r, f->core, y, step);
        ns_linalg_lu_solve(f->lu, 1, step);
        for (int i = 0; i < r; i++)
            y[i] -= step[i];
    }
    memset(x, 0, sizeof(double) * (size_t)f->n);
    for (int i = 0; i < r; i++)
        x[f->column[i]] = y[i];
}

double ns_linalg_ranked_left(const ns_ranked *f, int k, const double *b, const double *size, double *terms) {
    double sum = 0, total = 0;
    for (int i = 0; i < f->n; i++) {
        const double v = f->left[(f->rank + k) + i * f->n];
        sum += v * b[i];
        total += fabs(v) * (size ? fmax(size[i], fabs(b[i])) : fabs(b[i]));
    }
    if (terms)
        *terms = total;
    return fabs(sum) <= 64 * DBL_EPSILON * total ? 0 : sum;
}

void ns_linalg_ranked_add_right(const ns_ranked *f, int k, double share, double *x) {
    for (int i = 0; i < f->n; i++)
        x[i] += share * f->right[(f->rank + k) + i * f->n];
}
