/* src/linalg/sparse_lu.c - factors of sparse matrices by KLU.
 *
 * Factors with the pivots of another matrix are several times faster to get.  They are as good as fresh ones
 * unless entries grow or solutions are off: then, or where a pivot vanishes, pivots are chosen anew.
 *
 * Where a matrix is given that pivots may be chosen by for all of them (partial_refactor.h), these are tried
 * first.
 *
 * Where the pattern that all matrices share fills up, as zeros on its diagonal turn pivots away from the
 * order that it was given, each matrix is taken apart by the places that are not zero in itself.
 */
#include "sparse_lu.h"

#include <math.h>
#include <stdlib.h>

#include <suitesparse/klu.h>

#include "nonsmooth/status.h"
#include "packed_triangular.h"
#include "partial_refactor.h"
#include "sparse_pattern.h"
#include "sparse_pivots.h"

struct ns_klu {
    int n, *start, *row, often_zero;
    double *x; /* 3n: work */
    klu_common common;
    klu_symbolic *symbolic;
    int fills; /* factors of the shared pattern do */
    ns_patterns patterns;
    long fresh, again, solves;
    ns_partial_lu *steady; /* pivots for all matrices, NULL: none */
    long served, failures; /* so many, and for so many they were not good enough */
};

struct ns_factors {
    ns_pattern *own; /* its own pattern, taken from the shared one; NULL: that */
    double *value;   /* what is at the places of its own */
    klu_numeric *numeric;
    double growth;                /* reciprocal, with these pivots when they were chosen; */
    double error;                 /* of a solution then */
    int steady;                   /* packed is by the pivots for all, and there may be no numeric */
    int solved;                   /* how often */
    int all;                      /* no unknown is left out, */
    int missed;                   /* for so often one of them was not zero */
    ns_packed_triangular *packed; /* made by the solution that makes it worth while */
};

enum { WORTH_PACKING = 2, MOST_MISSED = 16 };

/* Factors have filled up where, but for their diagonals, they have so many times the entries of the matrix.
 */
static const double fill_share = 1.2;

/* Pivots for all matrices are given up where they are not good enough for a good part of them; they are worth
 * while where factors have no more than so many times the entries. */
enum { FAILURES_AT_FIRST = 8, FAILURES_PART = 8, STEADY_FILL = 4 };

/* Old pivots are dropped where entries grow this much more than when they were chosen, or where a row of a
 * solution is off by so much of its terms, and by so many times as much as then; below rcond_min the matrix
 * is as good as singular. */
static const double growth_share = 1e-3, least_error = 1e-8, error_growth = 16, rcond_min = 1e-300;

static int status_of(const klu_common *c) {
    if (c->status == KLU_OK)
        return NS_OK;
    return c->status == KLU_SINGULAR ? NS_E_SINGULAR : NS_E_MEMORY; /* or too large for its integers */
}

int ns_linalg_klu_create(int n, int *start, int *row, ns_klu **out) {
    *out = NULL;
    ns_klu *k = calloc(1, sizeof *k);
    if (!k)
        return NS_E_MEMORY;
    k->n = n;
    k->start = start;
    k->row = row;
    k->often_zero = n;
    k->x = calloc(3 * (size_t)n + 1, sizeof(double));
    if (!k->x) {
        ns_linalg_klu_free(k);
        return NS_E_MEMORY;
    }
    if (n > 0) {
        (void)klu_defaults(&k->common);
        k->common.scale = 1; /* by the sum of a row: full rows make bad pivots */
        k->symbolic = klu_analyze(n, start, row, &k->common);
        if (!k->symbolic || k->symbolic->structural_rank < n) {
            const int status = k->symbolic ? NS_E_SINGULAR : status_of(&k->common);
            ns_linalg_klu_free(k);
            return status == NS_OK ? NS_E_SINGULAR : status;
        }
    }
    *out = k;
    return NS_OK;
}

void ns_linalg_klu_free(ns_klu *k) {
    if (k && k->symbolic)
        (void)klu_free_symbolic(&k->symbolic, &k->common);
    if (k) {
        ns_linalg_patterns_free(&k->patterns, &k->common);
        ns_linalg_partial_free(k->steady);
        free(k->x);
    }
    free(k);
}

static void free_pattern(ns_klu *k, ns_factors *f) {
    ns_linalg_pattern_free(f->own, &k->common);
    free(f->value);
    f->own = NULL;
    f->value = NULL;
}

void ns_linalg_factors_free(ns_klu *k, ns_factors *f) {
    if (!f)
        return;
    if (f->numeric)
        (void)klu_free_numeric(&f->numeric, &k->common);
    free_pattern(k, f);
    ns_linalg_packed_free(f->packed);
    free(f);
}

static int give_up(ns_klu *k, ns_factors **f, int status) {
    ns_linalg_factors_free(k, *f);
    *f = NULL;
    return status;
}

static klu_symbolic *symbolic_of(const ns_klu *k, const ns_factors *f) {
    return f->own ? f->own->symbolic : k->symbolic;
}

/* What KLU is to look at. */
typedef struct klu_matrix {
    int *start, *row;
    double *value;
    klu_symbolic *symbolic;
} klu_matrix;

static klu_matrix matrix_of(const ns_klu *k, const ns_factors *f, double *value) {
    return f->own ? (klu_matrix){f->own->start, f->own->row, f->value, f->own->symbolic}
                  : (klu_matrix){k->start, k->row, value, k->symbolic};
}

/* 1 if it has no other places than those of f, whose values are taken. */
static int take_values(const ns_klu *k, ns_factors *f, const double *value) {
    int at = 0;
    if (!f->own)
        return 1;
    const int count = f->own->start[k->n], *from = f->own->from;
    for (int p = 0; p < k->start[k->n]; p++)
        if (value[p] != 0) {
            while (at < count && from[at] < p)
                f->value[at++] = 0;
            if (at == count || from[at] != p)
                return 0;
            f->value[at++] = value[p];
        }
    for (; at < count; at++)
        f->value[at] = 0;
    return 1;
}

/* Its own pattern, taken apart.  Errors: MEMORY, SINGULAR. */
static int take_apart(ns_klu *k, ns_factors *f, const double *value) {
    free_pattern(k, f);
    f->own = ns_linalg_pattern_of(&k->patterns, k->n, k->start, k->row, value, &k->common);
    if (!f->own) {
        const int status = status_of(&k->common);
        return status == NS_OK ? NS_E_SINGULAR : status;
    }
    f->value = malloc(((size_t)f->own->start[k->n] + 1) * sizeof(double));
    if (!f->value)
        return NS_E_MEMORY;
    (void)take_values(k, f, value);
    return NS_OK;
}

static int count_nonzero(const ns_klu *k, const double *value) {
    int count = 0;
    for (int p = 0; p < k->start[k->n]; p++)
        count += value[p] != 0;
    return count;
}

static double pivots_error(ns_klu *k, const klu_matrix *a, const ns_factors *f) {
    return ns_linalg_pivots_error(k->n, a->start, a->row, a->value, a->symbolic, f->numeric, &k->common,
                                  k->x);
}

/* 1 if the pivots of f serve this matrix too. */
static int factor_again(ns_klu *k, double *value, ns_factors *f) {
    klu_common *c = &k->common;
    if (!f->numeric || (k->fills && !f->own) || !take_values(k, f, value))
        return 0;
    const klu_matrix a = matrix_of(k, f, value);
    if (!klu_refactor(a.start, a.row, a.value, a.symbolic, f->numeric, c) || c->status != KLU_OK)
        return 0;
    if (!klu_rgrowth(a.start, a.row, a.value, a.symbolic, f->numeric, c))
        return 0;
    k->again++;
    return c->rgrowth >= growth_share * f->growth &&
           pivots_error(k, &a, f) <= fmax(least_error, error_growth * f->error);
}

static int factor_fresh(ns_klu *k, double *value, ns_factors *f) {
    klu_common *c = &k->common;
    if (f->numeric)
        (void)klu_free_numeric(&f->numeric, c);
    k->fresh++;
    const int status = k->fills ? take_apart(k, f, value) : NS_OK;
    if (status != NS_OK)
        return status;
    const klu_matrix a = matrix_of(k, f, value);
    f->numeric = klu_factor(a.start, a.row, a.value, a.symbolic, c);
    if (!f->numeric || c->status != KLU_OK)
        return c->status == KLU_OK ? NS_E_SINGULAR : status_of(c);
    (void)klu_rgrowth(a.start, a.row, a.value, a.symbolic, f->numeric, c);
    f->growth = c->rgrowth;
    f->error = pivots_error(k, &a, f);
    k->fills = k->fills || f->numeric->lnz + f->numeric->unz + f->numeric->nzoff - 2 * k->n >
                               fill_share * count_nonzero(k, value);
    return NS_OK;
}

int ns_linalg_klu_is_partial(const ns_klu *k) {
    return k->steady && k->failures < FAILURES_AT_FIRST + k->served / FAILURES_PART;
}

/* By the pivots for all matrices.  Errors: SINGULAR (they do not serve this one), MEMORY. */
static int factor_steadily(ns_klu *k, const double *value, ns_factors *f) {
    if (!f->steady) {
        ns_linalg_packed_free(f->packed);
        f->packed = NULL;
    }
    const int status =
        ns_linalg_klu_is_partial(k) ? ns_linalg_partial_factor(k->steady, value, &f->packed) : NS_E_SINGULAR;
    f->steady = status == NS_OK;
    *(f->steady ? &k->served : &k->failures) += status != NS_E_MEMORY;
    k->again += f->steady;
    return status;
}

int ns_linalg_klu_change(ns_klu *k, ns_factors *f, const double *value, int rows, const int *row) {
    if (!f->steady || !ns_linalg_klu_is_partial(k))
        return 0;
    f->steady = ns_linalg_partial_change(k->steady, value, rows, row, &f->packed);
    *(f->steady ? &k->served : &k->failures) += 1;
    return f->steady;
}

static int pivots_vanish(ns_klu *k, const ns_factors *f, double *value) {
    const klu_matrix a = matrix_of(k, f, value);
    return ns_linalg_pivots_vanish(k->n, a.start, a.row, a.value, a.symbolic, f->numeric, &k->common);
}

int ns_linalg_klu_factor(ns_klu *k, double *value, ns_factors **f) {
    if (!*f)
        *f = calloc(1, sizeof **f);
    if (!*f)
        return NS_E_MEMORY;
    if (k->n == 0)
        return NS_OK;
    const int steadily = k->steady ? factor_steadily(k, value, *f) : NS_E_SINGULAR;
    if (steadily != NS_E_SINGULAR)
        return steadily == NS_OK ? NS_OK : give_up(k, f, steadily);
    ns_linalg_packed_free((*f)->packed);
    (*f)->packed = NULL;
    (*f)->all = (*f)->missed = 0;
    (*f)->solved = 0;
    for (int i = 0; i < k->start[k->n]; i++)
        if (!isfinite(value[i]))
            return give_up(k, f, NS_E_NUMBER);
    if (!factor_again(k, value, *f)) {
        const int status = factor_fresh(k, value, *f);
        if (status != NS_OK)
            return give_up(k, f, status);
    }
    if (!klu_rcond(symbolic_of(k, *f), (*f)->numeric, &k->common) || !(k->common.rcond > rcond_min) ||
        pivots_vanish(k, *f, value))
        return give_up(k, f, NS_E_SINGULAR);
    return NS_OK;
}

size_t ns_linalg_factors_bytes(const ns_klu *k, const ns_factors *f) {
    const klu_numeric *n = f->numeric;
    size_t bytes = sizeof *f + (f->steady ? ns_linalg_partial_bytes(k->steady) : 0);
    if (n) {
        bytes += sizeof *n + n->worksize + (size_t)n->n * (8 * sizeof(int) + 2 * sizeof(double)) +
                 (size_t)n->nzoff * (sizeof(int) + sizeof(double));
        bytes += 2 * ((size_t)n->lnz + (size_t)n->unz) * (sizeof(int) + sizeof(double)); /* packed too */
    }
    if (f->own) /* its places, and what KLU says of them, as if no others had the same */
        bytes += sizeof *f->own + sizeof *f->own->symbolic +
                 (size_t)f->own->start[k->n] * (2 * sizeof(int) + sizeof(double)) +
                 (size_t)k->n * (4 * sizeof(int) + sizeof(double));
    return bytes;
}

/* KLU's, by columns; ints, doubles: to be freed.  0: no memory. */
static int extract(ns_klu *k, klu_symbolic *symbolic, klu_numeric *numeric, ns_triangles *t, int **ints,
                   double **doubles) {
    const int n = k->n, lnz = numeric->lnz, unz = numeric->unz;
    const size_t all = (size_t)lnz + (size_t)unz + (size_t)numeric->nzoff;
    *ints = malloc((6 * (size_t)n + 4 + all) * sizeof(int));
    *doubles = malloc(((size_t)n + 1 + all) * sizeof(double));
    if (!*ints || !*doubles)
        return 0;
    *t = (ns_triangles){.n = n, .blocks = symbolic->nblocks, .R = *ints, .Rs = *doubles};
    t->P = t->R + n + 1;
    t->Q = t->P + n;
    t->Lp = t->Q + n;
    t->Up = t->Lp + n + 1;
    t->Fp = t->Up + n + 1;
    t->Li = t->Fp + n + 1;
    t->Ui = t->Li + lnz;
    t->Fi = t->Ui + unz;
    t->Lx = t->Rs + n;
    t->Ux = t->Lx + lnz;
    t->Fx = t->Ux + unz;
    return klu_extract(numeric, symbolic, t->Lp, t->Li, t->Lx, t->Up, t->Ui, t->Ux, t->Fp, t->Fi, t->Fx, t->P,
                       t->Q, t->Rs, t->R, &k->common);
}

/* NULL: no memory; then it goes without. */
static ns_packed_triangular *pack(ns_klu *k, const ns_factors *f) {
    ns_triangles t;
    int *ints;
    double *doubles;
    ns_packed_triangular *s = NULL;
    if (extract(k, symbolic_of(k, f), f->numeric, &t, &ints, &doubles)) {
        t.often_zero = f->all ? k->n : k->often_zero;
        s = ns_linalg_packed_create(&t);
    }
    free(ints);
    free(doubles);
    return s;
}

int ns_linalg_klu_partial(ns_klu *k, double *value) {
    ns_triangles t;
    int *ints = NULL, status = NS_OK;
    double *doubles = NULL;
    if (k->n == 0 || k->steady)
        return NS_OK;
    klu_numeric *numeric = klu_factor(k->start, k->row, value, k->symbolic, &k->common);
    if (!numeric)
        return k->common.status == KLU_OUT_OF_MEMORY ? NS_E_MEMORY : NS_OK;
    const int entries = numeric->lnz + numeric->unz + numeric->nzoff;
    if (k->common.status == KLU_OK && entries <= STEADY_FILL * k->start[k->n]) {
        if (extract(k, k->symbolic, numeric, &t, &ints, &doubles))
            k->steady = ns_linalg_partial_create(&t, k->start, k->row);
        status = k->steady ? NS_OK : NS_E_MEMORY;
        free(ints);
        free(doubles);
    }
    (void)klu_free_numeric(&numeric, &k->common);
    return status;
}

void ns_linalg_klu_often_zero(ns_klu *k, int from) {
    k->often_zero = from;
}

void ns_linalg_klu_solve(ns_klu *k, ns_factors *f, double *b) {
    if (k->n == 0)
        return;
    k->solves++;
    if (!f->packed && ++f->solved == WORTH_PACKING)
        f->packed = pack(k, f);
    if (f->packed && ns_linalg_packed_solve(f->packed, b, k->x))
        return;
    (void)klu_solve(symbolic_of(k, f), f->numeric, k->n, 1, b, &k->common);
    if (f->packed && ++f->missed > MOST_MISSED) { /* with all, next time */
        ns_linalg_packed_free(f->packed);
        f->packed = NULL;
        f->all = 1;
        f->solved = WORTH_PACKING - 1;
    }
}

long ns_linalg_klu_fresh(const ns_klu *k) {
    return k->fresh;
}

long ns_linalg_klu_refactor(const ns_klu *k) {
    return k->again;
}

long ns_linalg_klu_solves(const ns_klu *k) {
    return k->solves;
}
