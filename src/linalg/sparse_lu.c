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
#include "sweep.h"

struct ns_klu {
    int n, *start, *row, often_zero;
    double *x; /* n: work */
    klu_common common;
    klu_symbolic *symbolic;
    long fresh, again;
};

struct ns_factors {
    klu_numeric *numeric;
    double growth;    /* reciprocal, with these pivots when they were chosen */
    int solved;       /* how often */
    int all;          /* no unknown is left out */
    ns_sweep *packed; /* made by the solution that makes it worth while */
};

enum { WORTH_PACKING = 3 };

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
    k->often_zero = n;
    k->x = calloc((size_t)n + 1, sizeof(double));
    if (!k->x) {
        ns_klu_free(k);
        return NS_E_MEMORY;
    }
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
    if (k)
        free(k->x);
    free(k);
}

void ns_factors_free(ns_klu *k, ns_factors *f) {
    if (f && f->numeric)
        (void)klu_free_numeric(&f->numeric, &k->common);
    if (f)
        ns_sweep_free(f->packed);
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

int ns_klu_factor(ns_klu *k, double *value, ns_factors **f) {
    if (!*f)
        *f = calloc(1, sizeof **f);
    if (!*f)
        return NS_E_MEMORY;
    ns_sweep_free((*f)->packed);
    (*f)->packed = NULL;
    (*f)->all = 0;
    (*f)->solved = 0;
    if (k->n == 0)
        return NS_OK;
    for (int i = 0; i < k->start[k->n]; i++)
        if (!isfinite(value[i]))
            return give_up(k, f, NS_E_NUMBER);
    if (!factor_again(k, value, *f)) {
        const int status = factor_fresh(k, value, *f);
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
        bytes += 2 * ((size_t)n->lnz + (size_t)n->unz) * (sizeof(int) + sizeof(double)); /* packed too */
    }
    return bytes;
}

/* NULL: no memory; then it goes without. */
static ns_sweep *pack(ns_klu *k, const ns_factors *f) {
    const int n = k->n, lnz = f->numeric->lnz, unz = f->numeric->unz;
    const size_t all = (size_t)lnz + (size_t)unz + (size_t)f->numeric->nzoff;
    int *ints = calloc(6 * (size_t)n + 4 + all, sizeof(int));
    double *doubles = calloc((size_t)n + 1 + all, sizeof(double));
    ns_sweep *s = NULL;
    if (ints && doubles) {
        ns_triangles t = {.n = n, .blocks = k->symbolic->nblocks, .R = ints, .Rs = doubles};
        t.often_zero = f->all ? n : k->often_zero;
        t.P = t.R + n + 1;
        t.Q = t.P + n;
        t.Lp = t.Q + n;
        t.Up = t.Lp + n + 1;
        t.Fp = t.Up + n + 1;
        t.Li = t.Fp + n + 1;
        t.Ui = t.Li + lnz;
        t.Fi = t.Ui + unz;
        t.Lx = t.Rs + n;
        t.Ux = t.Lx + lnz;
        t.Fx = t.Ux + unz;
        if (klu_extract(f->numeric, k->symbolic, t.Lp, t.Li, t.Lx, t.Up, t.Ui, t.Ux, t.Fp, t.Fi, t.Fx, t.P,
                        t.Q, t.Rs, t.R, &k->common))
            s = ns_sweep_create(&t);
    }
    free(ints);
    free(doubles);
    return s;
}

void ns_klu_often_zero(ns_klu *k, int from) {
    k->often_zero = from;
}

void ns_klu_solve(ns_klu *k, ns_factors *f, double *b) {
    if (k->n == 0)
        return;
    if (!f->packed && ++f->solved == WORTH_PACKING)
        f->packed = pack(k, f);
    if (f->packed && ns_sweep_solve(f->packed, b, k->x))
        return;
    (void)klu_solve(k->symbolic, f->numeric, k->n, 1, b, &k->common);
    if (f->packed) { /* with all, next time */
        ns_sweep_free(f->packed);
        f->packed = NULL;
        f->all = 1;
        f->solved = WORTH_PACKING - 1;
    }
}

long ns_klu_fresh(const ns_klu *k) {
    return k->fresh;
}

long ns_klu_again(const ns_klu *k) {
    return k->again;
}
