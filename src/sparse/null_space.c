/* src/sparse/null_space.c - the null spaces of (P2).
 *
 * K_g, K with leaks, is regular, and its inverse is large along what K does nothing to.  Pairs of directions
 * x, y with y = K_g^-T x, x = K_g^-1 y are the ones with the smallest singular values of K_g.  Then
 *
 *     x <- x - K_g^-1 K x
 *
 * takes out of x what K holds by more than the leaks.  Of the space these span, the part that K takes to
 * nothing but rounding is the null space.
 */
#include "null_space.h"
#include "linalg/directions.h"
#include "linalg/simd.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 64, ROUNDS = 2, PURIFY = 4 };
/* K_g^-1 makes a direction near the null space so many times as long, or more; of length 1 it is in the null
 * space if K leaves no more than `rounding` of it.  All in units. */
static const double near = 1e4, rounding = 1e-14;

struct ns_null_search {
    const ns_form *f;
    int *start, *row, *place; /* the pattern of K, transposed, and where its values are in K */
    ns_klu *klu;
    ns_factors *factors;          /* of K with leaks, transposed */
    double *value;                /* K's: of K with leaks; then of K, in units */
    double *turned;               /* the same, transposed */
    double *right, *left, *image; /* MOST+1 vectors (size) each */
    double *along, *room;         /* MOST+1; for ns_linalg_turn() */
};

void ns_sparse_null_search_free(ns_null_search *s) {
    if (!s)
        return;
    if (s->klu)
        ns_linalg_factors_free(s->klu, s->factors);
    ns_linalg_klu_free(s->klu);
    free(s->start);
    free(s->value);
    free(s);
}

static void turn_pattern(const ns_csc *K, int *start, int *row, int *place) {
    for (int k = 0; k < K->start[K->columns]; k++)
        start[K->row[k] + 1]++;
    for (int i = 0; i < K->columns; i++)
        start[i + 1] += start[i];
    for (int j = 0; j < K->columns; j++)
        for (int k = K->start[j]; k < K->start[j + 1]; k++) {
            const int to = start[K->row[k]]++;
            row[to] = j;
            place[to] = k;
        }
    for (int i = K->columns; i > 0; i--)
        start[i] = start[i - 1];
    start[0] = 0;
}

int ns_sparse_null_search_create(const ns_form *f, ns_null_search **out) {
    const size_t size = (size_t)f->size, entries = (size_t)f->K.start[f->size];
    ns_null_search *s = calloc(1, sizeof *s);
    *out = NULL;
    if (!s)
        return NS_E_MEMORY;
    s->f = f;
    s->start = calloc(size + 2 * entries + 1, sizeof(int));
    s->value = calloc(2 * entries + (3 * size + 1) * (MOST + 1) + ns_linalg_turn_room(f->size, MOST),
                      sizeof(double));
    int status = s->start && s->value ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK) {
        s->row = s->start + size + 1;
        s->place = s->row + entries;
        s->turned = s->value + entries;
        s->right = s->turned + entries;
        s->left = s->right + (MOST + 1) * size;
        s->image = s->left + (MOST + 1) * size;
        s->along = s->image + (MOST + 1) * size;
        s->room = s->along + MOST + 1;
        turn_pattern(&f->K, s->start, s->row, s->place);
        status = ns_linalg_klu_create(f->size, s->start, s->row, &s->klu);
    }
    if (status == NS_OK)
        *out = s;
    else
        ns_sparse_null_search_free(s);
    return status;
}

/* --- vectors in units --- */

static double *vector(double *of, int c, int size) {
    return of + (size_t)c * (size_t)size;
}

static void solve_right(const ns_sparse_leaks *k, double *x) {
    for (int i = 0; i < k->f->size; i++)
        x[i] /= k->scale[i];
    ns_linalg_klu_solve(k->klu, k->factors, x);
    for (int i = 0; i < k->f->size; i++)
        x[i] *= k->unit[i];
}

static void solve_left(const ns_null_search *s, const ns_sparse_leaks *k, double *y) {
    for (int i = 0; i < k->f->size; i++)
        y[i] *= k->unit[i];
    ns_linalg_klu_solve(s->klu, s->factors, y);
    for (int i = 0; i < k->f->size; i++)
        y[i] /= k->scale[i];
}

static void times(const ns_null_search *s, int transposed, const double *x, double *out) {
    const ns_csc *K = &s->f->K;
    memset(out, 0, sizeof(double) * (size_t)K->columns);
    for (int j = 0; j < K->columns; j++)
        for (int k = K->start[j]; k < K->start[j + 1]; k++)
            if (transposed)
                out[j] += s->value[k] * x[K->row[k]];
            else
                out[K->row[k]] += s->value[k] * x[j];
}

/* --- the search --- */

static int factor_turned(ns_null_search *s, const ns_sparse_leaks *k) {
    const int entries = s->f->K.start[s->f->size];
    ns_sparse_form_values(s->f, k->g, k->mode, k->leak, s->value);
    for (int e = 0; e < entries; e++)
        s->turned[e] = s->value[s->place[e]];
    return ns_linalg_klu_factor(s->klu, s->turned, &s->factors);
}

static void values_in_units(ns_null_search *s, const ns_sparse_leaks *k) {
    const ns_csc *K = &s->f->K;
    ns_sparse_form_values(s->f, k->g, k->mode, NULL, s->value);
    for (int j = 0; j < K->columns; j++)
        for (int e = K->start[j]; e < K->start[j + 1]; e++)
            s->value[e] *= k->scale[K->row[e]] / k->unit[j];
}

/* The next pair of directions, at right angles to the first count; 0: there is none near the null space. */
static int find_direction(const ns_null_search *s, const ns_sparse_leaks *k, int count) {
    const size_t size = (size_t)s->f->size;
    double *x = s->right + (size_t)count * size, *y = s->left + (size_t)count * size;
    unsigned long long random = 88172645463325252U + (unsigned long long)count;
    for (size_t i = 0; i < size; i++) {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        x[i] = (double)(random >> 11) * 0x1p-53 - 0.5;
    }
    (void)ns_linalg_straighten((int)size, count, s->right, x, s->along);
    for (int round = 0; round < ROUNDS; round++) {
        memcpy(y, x, sizeof(double) * size);
        solve_left(s, k, y);
        double longer = ns_linalg_straighten((int)size, count, s->left, y, s->along);
        memcpy(x, y, sizeof(double) * size);
        solve_right(k, x);
        longer = fmax(longer, ns_linalg_straighten((int)size, count, s->right, x, s->along));
        if (!(longer > near) || !isfinite(longer))
            return 0;
    }
    return 1;
}

/* Takes out of each direction of Q what K holds, other: those on the other side of K.  What K_g^-1 makes long
 * is left to keep_null(). */
static void purify(const ns_null_search *s, const ns_sparse_leaks *k, int count, int transposed, double *Q,
                   const double *other) {
    const int size = s->f->size;
    double *by = s->image;
    for (int c = 0; c < count; c++) {
        double *q = Q + (size_t)c * (size_t)size;
        for (int round = 0; round < PURIFY; round++) {
            times(s, transposed, q, by);
            ns_linalg_leave(size, count, other, by, s->along);
            if (transposed)
                solve_left(s, k, by);
            else
                solve_right(k, by);
            ns_linalg_leave(size, count, Q, by, s->along);
            for (int i = 0; i < size; i++)
                q[i] -= by[i];
        }
        (void)ns_linalg_straighten(size, c, Q, q, s->along);
    }
}

static void exchange(int size, double *a, double *b) {
    for (int i = 0; i < size && a != b; i++) {
        const double of_a = a[i];
        a[i] = b[i];
        b[i] = of_a;
    }
}

/* Of the space of count directions those that K takes to nothing to the front; how many. */
static int null_first(const ns_null_search *s, int count, int transposed, double *Q) {
    const int size = s->f->size;
    int kept = 0;
    for (int c = 0; c < count; c++)
        times(s, transposed, vector(Q, c, size), vector(s->image, c, size));
    ns_linalg_turn(size, count, Q, s->image, s->along, s->room);
    for (int c = 0; c < count; c++)
        if (s->along[c] <= rounding)
            exchange(size, vector(Q, kept++, size), vector(Q, c, size));
    return kept;
}

/* 1 if K takes what is not small in q, of length 1, to nothing as well: that, without the rest, is q then. */
static int leave_small(const ns_null_search *s, int transposed, double small, double *q) {
    const int size = s->f->size;
    double *rest = vector(s->image, 0, size), *image = vector(s->image, 1, size);
    for (int i = 0; i < size; i++)
        rest[i] = fabs(q[i]) > small ? q[i] : 0;
    times(s, transposed, rest, image);
    if (!(sqrt(ns_dot(size, image, image)) <= rounding))
        return 0;
    memcpy(q, rest, sizeof *q * (size_t)size);
    return 1;
}

/* Takes out of each direction what is small: leaks of pairs differ by decades, and would see it. */
static void clean(const ns_null_search *s, int count, int transposed, double *Q) {
    static const double small[] = {1e-4, 1e-6, 1e-8, 1e-10, 1e-12};
    for (int c = 0; c < count; c++)
        for (int k = 0; k < 5 && !leave_small(s, transposed, small[k], vector(Q, c, s->f->size)); k++)
            ;
}

/* What leaks make of v in the row of pair j. */
static double leak_of(const ns_sparse_leaks *k, int j, const double *v) {
    if (ns_mode_slides(k->mode[j]))
        return 0;
    return k->leak[j] * (k->mode[j] == NS_INSIDE ? v[k->f->n + j] : ns_linalg_csc_dot(&k->f->Ct, j, v));
}

/* to (count) = left G v */
static void leaks_along(const ns_sparse_leaks *k, const ns_null_space *z, const double *v, double *to) {
    memset(to, 0, sizeof(double) * (size_t)z->count);
    for (int j = 0; j < k->f->m; j++) {
        const int i = k->f->n + j;
        const double leak = leak_of(k, j, v) * k->scale[i];
        for (int c = 0; leak != 0 && c < z->count; c++)
            to[c] += z->left[(size_t)c * (size_t)k->f->size + (size_t)i] * leak;
    }
}

/* Factors of a (count*count); *out: NULL where they say nothing.  Errors: MEMORY. */
static int factor_small(int count, const double *a, ns_lu **out) {
    double rcond = 0;
    const int status = ns_linalg_lu_create(count, out);
    if (status == NS_OK && (ns_linalg_lu_factor(*out, count, a, &rcond) != NS_OK || !(rcond > rounding))) {
        ns_linalg_lu_free(*out);
        *out = NULL;
    }
    return status;
}

/* Errors: MEMORY. */
static int find_shares(const ns_null_search *s, const ns_sparse_leaks *k, ns_null_space *z) {
    const size_t size = (size_t)k->f->size, count = (size_t)z->count;
    double *a = calloc(count * count + 1, sizeof(double));
    for (size_t c = 0; c < count && a; c++) {
        for (size_t i = 0; i < size; i++)
            s->image[i] = z->right[c * size + i] / k->unit[i];
        leaks_along(k, z, s->image, a + c * count);
    }
    const int status = a ? factor_small(z->count, a, &z->shares) : NS_E_MEMORY;
    free(a);
    return status;
}

static int keep_space(const ns_null_search *s, const ns_sparse_leaks *k, int count, ns_null_space *z) {
    const size_t all = (size_t)count * (size_t)s->f->size;
    z->count = count;
    if (count == 0)
        return NS_OK;
    z->right = malloc(2 * all * sizeof(double));
    if (!z->right)
        return NS_E_MEMORY;
    z->left = z->right + all;
    memcpy(z->right, s->right, all * sizeof(double));
    memcpy(z->left, s->left, all * sizeof(double));
    return find_shares(s, k, z);
}

int ns_sparse_null_find(ns_null_search *s, const ns_sparse_leaks *k, ns_null_space **out) {
    int status = factor_turned(s, k), count = 0;
    *out = NULL;
    while (status == NS_OK && count <= MOST && find_direction(s, k, count))
        count++;
    if (status != NS_OK || count > MOST)
        return status != NS_OK ? status : NS_E_NUMBER;
    values_in_units(s, k);
    purify(s, k, count, 0, s->right, s->left);
    purify(s, k, count, 1, s->left, s->right);
    const int left = null_first(s, count, 1, s->left), right = null_first(s, count, 0, s->right);
    if (right != left)
        return NS_E_NUMBER;
    clean(s, left, 1, s->left);
    clean(s, right, 0, s->right);
    ns_null_space *z = calloc(1, sizeof *z);
    status = z ? keep_space(s, k, right, z) : NS_E_MEMORY;
    if (status == NS_OK)
        *out = z;
    else
        ns_sparse_null_free(z);
    return status;
}

void ns_sparse_null_free(ns_null_space *z) {
    if (!z)
        return;
    ns_linalg_lu_free(z->shares);
    free(z->right);
    free(z);
}

/* What r has along direction c, which no v gives. */
static double along_left(const ns_sparse_leaks *k, const ns_null_space *z, int c, const double *r) {
    const double *l = z->left + (size_t)c * (size_t)k->f->size;
    double off = 0;
    for (int i = 0; i < k->f->size; i++)
        off += l[i] * (r[i] * k->scale[i]);
    return off;
}

void ns_sparse_null_make_solvable(const ns_sparse_leaks *k, const ns_null_space *z, double *r) {
    const int size = k->f->size;
    for (int c = 0; c < z->count; c++) {
        const double *l = z->left + (size_t)c * (size_t)size, off = along_left(k, z, c, r);
        for (int i = 0; i < size; i++)
            r[i] -= off * l[i] / k->scale[i];
    }
}

void ns_sparse_null_settle(const ns_sparse_leaks *k, const ns_null_space *z, double *v) {
    double along[MOST];
    if (!z->shares)
        return;
    leaks_along(k, z, v, along);
    ns_linalg_lu_solve(z->shares, 1, along);
    for (int c = 0; c < z->count; c++)
        for (int i = 0; i < k->f->size; i++)
            v[i] -= along[c] * z->right[(size_t)c * (size_t)k->f->size + (size_t)i] / k->unit[i];
}
