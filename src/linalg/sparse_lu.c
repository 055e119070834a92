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
    int n, *start, *row;
    double *x; /* n: work */
    klu_common common;
    klu_symbolic *symbolic;
    long fresh, again;
};

/* The sweep's arrays; made at the solution that makes it worth while, NULL: not yet. */
typedef struct packed {
    ns_sweep sweep;
    int *ints;
    double *doubles;
} packed;

struct ns_factors {
    klu_numeric *numeric;
    double growth; /* reciprocal, with these pivots when they were chosen */
    int solved;    /* how often */
    packed *packed;
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

static void unpack(ns_factors *f) {
    if (f && f->packed) {
        free(f->packed->ints);
        free(f->packed->doubles);
        free(f->packed);
        f->packed = NULL;
    }
}

void ns_factors_free(ns_klu *k, ns_factors *f) {
    if (f && f->numeric)
        (void)klu_free_numeric(&f->numeric, &k->common);
    unpack(f);
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
    unpack(*f);
    (*f)->solved = 0;
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
        bytes += 2 * ((size_t)n->lnz + (size_t)n->unz) * (sizeof(int) + sizeof(double)); /* packed too */
    }
    return bytes;
}

/* Columns of U within blocks and of what lies above them, without the diagonal, which goes to pivot. */
static void join_columns(int n, const int *U[2], const int *F[2], const double *ux, const double *fx, int *to,
                         int *row, double *value, double *pivot) {
    int at = 0;
    for (int k = 0; k < n; k++) {
        to[k] = at;
        for (int p = U[0][k]; p < U[0][k + 1]; p++) {
            if (U[1][p] == k)
                pivot[k] = 1 / ux[p];
            else {
                row[at] = U[1][p];
                value[at++] = ux[p];
            }
        }
        for (int p = F[0][k]; p < F[0][k + 1]; p++) {
            row[at] = F[1][p];
            value[at++] = fx[p];
        }
    }
    to[n] = at;
}

/* L without its diagonal, in place. */
static void drop_diagonal(int n, int *start, int *row, double *value) {
    int at = 0;
    for (int k = 0, p = 0; k < n; k++) {
        const int end = start[k + 1];
        for (start[k] = at; p < end; p++)
            if (row[p] != k) {
                row[at] = row[p];
                value[at++] = value[p];
            }
    }
    start[n] = at;
}

static int fill(ns_klu *k, const ns_factors *f, packed *p, int *spare, double *spare_x) {
    const int n = k->n, lnz = f->numeric->lnz, unz = f->numeric->unz, off = f->numeric->nzoff;
    int *begin = p->ints, *row = begin + n + 1, *to = row + n, *l = to + n, *u = l + n + 1, *li = u + n + 1,
        *ui = li + lnz;
    double *scale = p->doubles, *pivot = scale + n, *lx = pivot + n, *ux = lx + lnz;
    int *up = spare, *uj = up + n + 1, *fp = uj + unz, *fj = fp + n + 1;
    double *uv = spare_x, *fv = uv + unz;
    if (!klu_extract(f->numeric, k->symbolic, l, li, lx, up, uj, uv, fp, fj, fv, row, to, scale, begin,
                     &k->common))
        return 0;
    (void)off;
    for (int i = 0; i < n; i++)
        scale[i] = 1 / scale[i];
    drop_diagonal(n, l, li, lx);
    join_columns(n, (const int *[]){up, uj}, (const int *[]){fp, fj}, uv, fv, u, ui, ux, pivot);
    p->sweep = (ns_sweep){n, k->symbolic->nblocks, begin, row, to, scale, l, u, li, ui, lx, ux, pivot};
    return 1;
}

/* NULL: no memory; then it goes without. */
static packed *pack(ns_klu *k, const ns_factors *f) {
    const size_t n = (size_t)k->n, lnz = (size_t)f->numeric->lnz, unz = (size_t)f->numeric->unz,
                 off = (size_t)f->numeric->nzoff;
    packed *p = calloc(1, sizeof *p);
    if (!p)
        return NULL;
    p->ints = calloc(5 * n + 3 + lnz + unz + off, sizeof(int));
    p->doubles = calloc(2 * n + lnz + unz + off, sizeof(double));
    int *spare = calloc(2 * n + 2 + unz + off, sizeof(int));
    double *spare_x = calloc(unz + off + 1, sizeof(double));
    const int made = p->ints && p->doubles && spare && spare_x && fill(k, f, p, spare, spare_x);
    free(spare);
    free(spare_x);
    if (made)
        return p;
    free(p->ints);
    free(p->doubles);
    free(p);
    return NULL;
}

void ns_klu_solve(ns_klu *k, ns_factors *f, double *b) {
    if (k->n == 0)
        return;
    if (!f->packed && ++f->solved == WORTH_PACKING)
        f->packed = pack(k, f);
    if (f->packed)
        ns_sweep_solve(&f->packed->sweep, b, k->x);
    else
        (void)klu_solve(k->symbolic, f->numeric, k->n, 1, b, &k->common);
}

long ns_klu_fresh(const ns_klu *k) {
    return k->fresh;
}

long ns_klu_again(const ns_klu *k) {
    return k->again;
}
