/* src/sparse/low_rank_update.c - a few rows of (P2) changed, without new factors. */
#include "low_rank_update.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "linalg/simd.h"

enum { MOST = NS_UPDATE_MOST };
/* A pivot of the small matrix must be more than this fraction of its terms. */
static const double least_pivot = 1e-6;
/* The terms of an unknown may be so many times as large as it was of late; how much of that is kept a step.
 */
static const double most_terms = 1e3, forget = 0.9;
/* A law below this fraction of the largest unknown may be the rounding of what it is summed from, all of it
 * zero; it is not, where a correction of these unknowns changes it by no more than this part of it. */
static const double may_be_rounding = 1e-9, most_change = 1e-3;

/* What a small matrix is made of. */
typedef struct changed_rows {
    ns_klu *klu;
    ns_factors *factors;
    double g;
    const ns_mode *base, *mode; /* of the factors; of the update */
} changed_rows;

int ns_sparse_update_create(const ns_form *f, ns_low_rank *u) {
    *u = (ns_low_rank){.f = f};
    u->mode = calloc((size_t)f->m + 1, 1);
    return u->mode ? NS_OK : NS_E_MEMORY;
}

void ns_sparse_update_free(ns_low_rank *u) {
    free(u->mode);
    free(u->v);
}

void ns_sparse_update_reset(ns_low_rank *u, const ns_mode *mode) {
    u->count = u->columns = 0;
    u->checked = 0;
    memmove(u->mode, mode, (size_t)u->f->m);
}

/* The law of pair j applied to v. */
static double law(const ns_form *f, ns_mode mode, int j, const double *v) {
    return ns_mode_slides(mode) ? ns_linalg_csc_dot(&f->gx, f->command[j], v)
           : mode == NS_INSIDE  ? ns_linalg_csc_dot(&f->Ct, j, v)
                                : v[f->n + j];
}

/* Of the rows that lambda_j enters: the largest sum of the sizes of their other terms, over its coefficient.
 */
static double terms_of_lambda(const ns_form *f, double g, int j, const double *v) {
    double max = 0;
    for (int k = f->K.start[f->n + j]; k < f->K.start[f->n + j + 1]; k++) {
        const int i = f->K.row[k];
        if (i >= f->n || f->KA[k] == 0)
            continue;
        const double charge = f->algebraic[i] ? 0 : ns_linalg_csc_size(&f->Mt, i, v) / g;
        max = ns_higher(max, (charge + ns_linalg_csc_size(&f->At, i, v)) / fabs(f->KA[k]));
    }
    return max;
}

/* The sizes of the terms of its law; of lambda alone, only rounding counts. */
static double law_size(const ns_form *f, double g, ns_mode mode, int j, const double *v) {
    return ns_mode_slides(mode) ? ns_linalg_csc_size(&f->gx, f->command[j], v)
           : mode == NS_INSIDE  ? ns_linalg_csc_size(&f->Ct, j, v)
                                : fmax(fabs(v[f->n + j]), 1e-4 * terms_of_lambda(f, g, j, v));
}

/* Two modes that have the same row of K. */
static int have_same_row(ns_mode a, ns_mode b) {
    return a == b || (!ns_mode_slides(a) && !ns_mode_slides(b) && a != NS_INSIDE && b != NS_INSIDE) ||
           (ns_mode_slides(a) && ns_mode_slides(b));
}

/* The pairs that differ; 0: too many. */
static int differences(ns_low_rank *u, const ns_mode *base, const ns_mode *mode) {
    u->count = 0;
    for (int j = 0; j < u->f->m; j++) {
        if (base[j] == mode[j] || have_same_row(base[j], mode[j]))
            continue;
        if (u->count == MOST)
            return 0;
        u->pair[u->count++] = j;
    }
    return 1;
}

static int column_of(const ns_low_rank *u, int pair) {
    int c = 0;
    while (c < u->columns && u->known[c] != pair)
        c++;
    return c;
}

static int is_needed(const ns_low_rank *u, int pair) {
    for (int i = 0; i < u->count; i++)
        if (u->pair[i] == pair)
            return 1;
    return 0;
}

/* The place of a new column: behind the others, or that of one that is not needed now. */
static int free_column(ns_low_rank *u) {
    if (u->columns < MOST)
        return u->columns++;
    int c = 0;
    while (c < MOST - 1 && is_needed(u, u->known[c]))
        c++;
    return c;
}

/* v: K^-1 of the unit vector in the row of pair j.  Where that row is lambda_j alone, lambda_j is known, and
 * its terms are moved to the right-hand side. */
static void solve_column(const ns_low_rank *u, ns_klu *klu, ns_factors *factors, double g,
                         const ns_mode *base, int j, double *v) {
    const ns_form *f = u->f;
    const int known = base[j] != NS_INSIDE && !ns_mode_slides(base[j]);
    memset(v, 0, sizeof(double) * (size_t)f->size);
    for (int k = f->K.start[f->n + j]; known && k < f->K.start[f->n + j + 1]; k++) {
        const int i = f->K.row[k];
        if (i < f->n)
            v[i] = f->held && !isnan(f->held[i]) ? 0 : ns_sparse_form_rate(f, g, i) * f->KA[k];
        else if (i != f->n + j && base[i - f->n] == NS_INSIDE)
            v[i] = -f->KA[k];
    }
    if (!known)
        v[f->n + j] = 1;
    ns_linalg_klu_solve(klu, factors, v);
    if (known)
        v[f->n + j] = 1;
}

static int solve_columns(ns_low_rank *u, ns_klu *klu, ns_factors *factors, double g, const ns_mode *base) {
    const size_t size = (size_t)u->f->size;
    if (!u->v)
        u->v = calloc((MOST + 1) * size + 1, sizeof(double));
    if (!u->v)
        return 0;
    for (int i = 0; i < u->count; i++) {
        int c = column_of(u, u->pair[i]);
        if (c == u->columns) {
            c = free_column(u);
            solve_column(u, klu, factors, g, base, u->pair[i], u->v + (size_t)c * size);
            u->known[c] = u->pair[i];
            for (int k = 0; k < MOST; k++)
                u->kind[c][k] = u->kind[k][c] = 0;
        }
        u->of[i] = c;
    }
    return 1;
}

/* Row i of c by its triangles; 0: a pivot is but rounding of terms. */
static int eliminate(ns_low_rank *u, const double *terms) {
    const int k = u->count;
    for (int p = 0; p < k; p++) {
        int best = p;
        for (int i = p + 1; i < k; i++)
            if (fabs(u->c[u->order[i] * MOST + p]) * terms[u->order[best]] >
                fabs(u->c[u->order[best] * MOST + p]) * terms[u->order[i]])
                best = i;
        const int row = u->order[best];
        u->order[best] = u->order[p];
        u->order[p] = row;
        const double pivot = u->c[row * MOST + p];
        if (!(fabs(pivot) > least_pivot * terms[row]) || !isfinite(pivot))
            return 0;
        for (int i = p + 1; i < k; i++) {
            double *c = u->c + u->order[i] * MOST;
            const double by = c[p] /= pivot;
            for (int q = p + 1; q < k; q++)
                c[q] -= by * u->c[row * MOST + q];
        }
    }
    return 1;
}

/* 1 if the law of pair j applied to its own column v is but rounding: what is closed already holds its nodes
 * where it would. */
static int is_rounding(ns_low_rank *u, const changed_rows *k, int j, const double *v) {
    const ns_form *f = u->f;
    double *rest = u->v + MOST * (size_t)f->size, largest = 0;
    const double is = fabs(law(f, k->mode[j], j, v));
    for (int i = 0; i < f->size; i++)
        largest = ns_higher(largest, fabs(v[i]));
    if (is > may_be_rounding * largest)
        return 0;
    memset(rest, 0, sizeof(double) * (size_t)f->size);
    rest[f->n + j] = 1;
    ns_sparse_form_subtract(f, k->g, k->base, v, rest);
    ns_sparse_form_move_known(f, k->base, rest);
    ns_linalg_klu_solve(k->klu, k->factors, rest);
    return !(fabs(law(f, k->mode[j], j, rest)) <= most_change * is);
}

/* The law of pair j, of column r, applied to column c. */
static void apply_law(ns_low_rank *u, const changed_rows *k, int j, int r, int c) {
    const ns_mode mode = k->mode[j];
    const unsigned char kind = ns_mode_slides(mode) ? 3 : mode == NS_INSIDE ? 2 : 1;
    const double *v = u->v + (size_t)c * (size_t)u->f->size;
    if (u->kind[r][c] == kind)
        return;
    u->kind[r][c] = kind;
    u->law[r][c] = law(u->f, mode, j, v);
    u->terms[r][c] = law_size(u->f, k->g, mode, j, v);
    if (r == c && kind != 1 && is_rounding(u, k, j, v))
        u->terms[r][c] = INFINITY;
}

/* The small matrix, in triangles. */
static int form_small(ns_low_rank *u, const changed_rows *rows) {
    double terms[MOST] = {0};
    for (int i = 0; i < u->count; i++) {
        const int r = u->of[i];
        for (int k = 0; k < u->count; k++) {
            const int c = u->of[k];
            apply_law(u, rows, u->pair[i], r, c);
            u->c[i * MOST + k] = u->law[r][c];
            terms[i] = ns_higher(terms[i], u->terms[r][c]);
        }
        u->order[i] = i;
    }
    return eliminate(u, terms);
}

int ns_sparse_update_to(ns_low_rank *u, ns_klu *klu, ns_factors *factors, double g, const ns_mode *base,
                        const ns_mode *mode) {
    const changed_rows rows = {klu, factors, g, base, mode};
    const int done =
        differences(u, base, mode) && solve_columns(u, klu, factors, g, base) && form_small(u, &rows);
    u->count = done ? u->count : 0;
    u->checked = u->count == 0;
    u->served = 0;
    memcpy(u->mode, done ? mode : base, (size_t)u->f->m);
    return done;
}

/* mu (count): the weights with which v, whose right-hand sides were zero there, keeps the laws that changed.
 */
static void solve_small(const ns_low_rank *u, const double *r, const double *v, double *mu) {
    const ns_form *f = u->f;
    for (int p = 0; p < u->count; p++) {
        const int i = u->order[p], j = u->pair[i];
        mu[p] = r[f->n + j] - law(f, u->mode[j], j, v);
        for (int q = 0; q < p; q++)
            mu[p] -= u->c[i * MOST + q] * mu[q];
    }
    for (int p = u->count - 1; p >= 0; p--) {
        const double *c = u->c + u->order[p] * MOST;
        for (int q = p + 1; q < u->count; q++)
            mu[p] -= c[q] * mu[q];
        mu[p] /= c[p];
    }
}

/* v += four columns times mu. */
ALWAYS_INLINE void add_from(int i, int size, const double *const *column, const double *mu, double *v) {
    const double *a = column[0], *b = column[1], *c = column[2], *d = column[3];
    for (; i < size; i++)
        v[i] += (mu[0] * a[i] + mu[1] * b[i]) + (mu[2] * c[i] + mu[3] * d[i]);
}

NS_WIDE_TARGET static void add_wide(int size, const double *const *column, const double *mu, double *v) {
    const double *a = column[0], *b = column[1], *c = column[2], *d = column[3];
    const double x = mu[0], y = mu[1], z = mu[2], t = mu[3];
    int i = 0;
    for (; i + NS_WIDE <= size; i += NS_WIDE)
        *(ns_simd_wide *)(v + i) +=
            (x * *(const ns_simd_wide *)(a + i) + y * *(const ns_simd_wide *)(b + i)) +
            (z * *(const ns_simd_wide *)(c + i) + t * *(const ns_simd_wide *)(d + i));
    add_from(i, size, column, mu, v);
}

/* Columns of V in the order of mu, and three of no weight behind them. */
static void list_columns(const ns_low_rank *u, const double **column, double *mu) {
    const size_t size = (size_t)u->f->size;
    for (int p = 0; p < u->count + 3; p++) {
        column[p] = u->v + (p < u->count ? (size_t)u->of[p] * size : 0);
        mu[p] = p < u->count ? mu[p] : 0;
    }
}

/* v += V mu, four columns at a time. */
static void add_all(int size, int count, const double *const *column, const double *mu, double *v) {
    const int wide = ns_simd_is_wide();
    for (int p = 0; p < count; p += 4) {
        if (wide)
            add_wide(size, column + p, mu + p, v);
        else
            add_from(0, size, column + p, mu + p, v);
    }
}

/* v += V mu from unknown i on; 0: an unknown is the difference of terms that are far larger than it was of
 * late. */
ALWAYS_INLINE int check_from(int i, int size, int count, const double *const *column, const double *mu,
                             double *v, double *seen) {
    int good = 1;
    for (; i < size; i++) {
        double sum = v[i], terms = fabs(v[i]);
        for (int p = 0; p < count; p++) {
            const double term = mu[p] * column[p][i];
            sum += term;
            terms += fabs(term);
        }
        v[i] = sum;
        seen[i] = ns_higher(fabs(sum), forget * seen[i]);
        good &= terms <= most_terms * seen[i];
    }
    return good;
}

NS_WIDE_TARGET static int check_wide(int size, int count, const double *const *column, const double *mu,
                                     double *v, double *seen) {
    const ns_simd_wide none = {0};
    ns_simd_wide least = none, no_number = none; /* what is left until terms are too large */
    int i = 0;
    for (; i + NS_WIDE <= size; i += NS_WIDE) {
        ns_simd_wide sum = *(const ns_simd_wide *)(v + i), terms = NS_WIDE_SIZE(sum);
        for (int p = 0; p < count; p++) {
            const ns_simd_wide term = mu[p] * *(const ns_simd_wide *)(column[p] + i);
            sum += term;
            terms += NS_WIDE_SIZE(term);
        }
        const ns_simd_wide now = NS_WIDE_SIZE(sum), before = forget * *(const ns_simd_wide *)(seen + i),
                           max = NS_WIDE_HIGHER(now, before), room = most_terms * max - terms;
        least = NS_WIDE_LOWER(least, room);
        no_number += terms - terms;
        *(ns_simd_wide *)(v + i) = sum;
        *(ns_simd_wide *)(seen + i) = max;
    }
    const ns_simd_wide found = least + no_number;
    return check_from(i, size, count, column, mu, v, seen) && NS_WIDE_ABOVE(found, none - DBL_MIN);
}

static int check_all(int size, int count, const double *const *column, const double *mu, double *v,
                     double *seen) {
    return check_from(0, size, count, column, mu, v, seen);
}

int ns_sparse_update_solve(const ns_low_rank *u, ns_klu *klu, ns_factors *factors, const ns_mode *base,
                           const double *r, double *v, double *seen) {
    const ns_form *f = u->f;
    const double *column[MOST + 3];
    double mu[MOST + 3];
    memcpy(v, r, sizeof(double) * (size_t)f->size);
    for (int i = 0; i < u->count; i++)
        v[f->n + u->pair[i]] = 0;
    ns_sparse_form_move_known(f, base, v);
    ns_linalg_klu_solve(klu, factors, v);
    solve_small(u, r, v, mu);
    list_columns(u, column, mu);
    if (seen)
        return (ns_simd_is_wide() ? check_wide : check_all)(f->size, u->count, column, mu, v, seen);
    add_all(f->size, u->count, column, mu, v);
    return 1;
}
