/* src/linalg/sparse_lu.c - factors of sparse matrices by KLU.
 *
 * Factors with the pivots of another matrix are several times faster to get.  They are as good as fresh ones
 * unless entries grow: then, or where a pivot vanishes, pivots are chosen anew.
 */
#include "sparse_lu.h"

#include <math.h>
#include <stdlib.h>

#include <suitesparse/klu.h>

#include "nonsmooth/status.h"

struct ns_klu {
    int n, *start, *row;
    klu_common common;
    klu_symbolic *symbolic;
    long fresh, again;
};

struct ns_factors {
    klu_numeric *numeric;
    double growth; /* reciprocal, with these pivots when they were chosen */
};

/* Old pivots are dropped where entries grow this much more than when they were chosen; below rcond_min the
 * matrix is as good as singular. */
static const double growth_share = 1e-3, rcond_min = 1e-300;

static int status_of(const klu_common *c) {
    if (c->status == KLU_OK)
        return NS_OK;
    return c->status == KLU_SINGULAR ? NS_E_SINGULAR : NS_E_MEMORY; /* or too large for its integers */
}

int ns_klu_create(int n, int *start, int *row, ns_klu **out) {
    *out = NULL;
    ns_klu *k = calloc(1, sizeof *k);
    if (!k)
        return NS_E_MEMORY;
    k->n = n;
    k->start = start;
    k->row = row;
    if (n > 0) {
        (void)klu_defaults(&k->common);
        k->common.scale = 1; /* by the sum of a row: full rows make bad pivots */
        k->symbolic = klu_analyze(n, start, row, &k->common);
        if (!k->symbolic || k->symbolic->structural_rank < n) {
            const int status = k->symbolic ? NS_E_SINGULAR : status_of(&k->common);
            ns_klu_free(k);
            return status == NS_OK ? NS_E_SINGULAR : status;
        }
    }
    *out = k;
    return NS_OK;
}

void ns_klu_free(ns_klu *k) {
    if (k && k->symbolic)
        (void)klu_free_symbolic(&k->symbolic, &k->common);
    free(k);
}

void ns_factors_free(ns_klu *k, ns_factors *f) {
    if (f && f->numeric)
        (void)klu_free_numeric(&f->numeric, &k->common);
    free(f);
}

static int give_up(ns_klu *k, ns_factors **f, int status) {
    ns_factors_free(k, *f);
    *f = NULL;
    return status;
}

/* 1 if the pivots of f serve this matrix too. */
static int factor_again(ns_klu *k, double *value, ns_factors *f) {
    klu_common *c = &k->common;
    if (!f->numeric || !klu_refactor(k->start, k->row, value, k->symbolic, f->numeric, c) ||
        c->status != KLU_OK)
        return 0;
    if (!klu_rgrowth(k->start, k->row, value, k->symbolic, f->numeric, c))
        return 0;
    k->again++;
    return c->rgrowth >= growth_share * f->growth;
}

static int factor_fresh(ns_klu *k, double *value, ns_factors *f) {
    klu_common *c = &k->common;
    if (f->numeric)
        (void)klu_free_numeric(&f->numeric, c);
    f->numeric = klu_factor(k->start, k->row, value, k->symbolic, c);
    k->fresh++;
    if (!f->numeric || c->status != KLU_OK)
        return c->status == KLU_OK ? NS_E_SINGULAR : status_of(c);
    (void)klu_rgrowth(k->start, k->row, value, k->symbolic, f->numeric, c);
    f->growth = c->rgrowth;
    return NS_OK;
}

int ns_klu_factor(ns_klu *k, const double *value, ns_factors **f) {
    double *const a = (double *)(size_t)value; /* KLU only reads it */
    if (!*f)
        *f = calloc(1, sizeof **f);
    if (!*f)
        return NS_E_MEMORY;
    if (k->n == 0)
        return NS_OK;
    for (int i = 0; i < k->start[k->n]; i++)
        if (!isfinite(value[i]))
            return give_up(k, f, NS_E_NUMBER);
    if (!factor_again(k, a, *f)) {
        const int status = factor_fresh(k, a, *f);
        if (status != NS_OK)
            return give_up(k, f, status);
    }
    if (!klu_rcond(k->symbolic, (*f)->numeric, &k->common) || !(k->common.rcond > rcond_min))
        return give_up(k, f, NS_E_SINGULAR);
    return NS_OK;
}

size_t ns_factors_bytes(const ns_factors *f) {
    const klu_numeric *n = f->numeric;
    size_t bytes = sizeof *f;
    if (n) {
        bytes += sizeof *n + n->worksize + (size_t)n->n * (8 * sizeof(int) + 2 * sizeof(double)) +
                 (size_t)n->nzoff * (sizeof(int) + sizeof(double));
        bytes += ((size_t)n->lnz + (size_t)n->unz) * (sizeof(int) + sizeof(double));
    }
    return bytes;
}

void ns_klu_solve(ns_klu *k, const ns_factors *f, int nrhs, double *b) {
    if (k->n > 0)
        (void)klu_solve(k->symbolic, f->numeric, k->n, nrhs, b, &k->common);
}

long ns_klu_fresh(const ns_klu *k) {
    return k->fresh;
}

long ns_klu_again(const ns_klu *k) {
    return k->again;
}
