/* src/linalg/leakage.c - leakage fluxes of closely coupled coils in place of fluxes of single coils.
 *
 * Where k is 0.9999, the fluxes of two coils are almost multiples of each other, and their currents are
 * differences of these: rounding of a flux is 1e4 roundings of a current.  So what the current of one coil
 * alone makes of its flux is taken as the state: its flux less what the fluxes of the others explain
 * (Gaussian elimination with the largest pivots, in units of each coil's own inductance).
 */
#include "leakage.h"

#include "cut_sets.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "nonsmooth/status.h"

/* What is left of a coil's inductance, at most: larger parts cost no digit. */
static const double close_part = 0.5;

typedef struct coils {
    int n, count;
    const double *M;
    double *a;    /* count*count: what is left of M, */
    double *t;    /* count*count: as these combinations of rows */
    int *row;     /* n: rows of M of this part */
    int *place;   /* n: the row of T that is this row of M; -1: none */
    int *reached; /* n: its part was found */
    int *used;    /* n: a pivot, of a row of the part */
} coils;

static double entry(const coils *c, int i, int j) {
    return c->M[(size_t)i + (size_t)j * (size_t)c->n];
}

static int create(coils *c, int n, const double *M) {
    const size_t size = (size_t)n;
    memset(c, 0, sizeof *c);
    c->n = n;
    c->M = M;
    c->row = calloc(4 * size + 1, sizeof *c->row);
    if (!c->row)
        return NS_E_MEMORY;
    c->place = c->row + n;
    c->reached = c->place + n;
    c->used = c->reached + n;
    return NS_OK;
}

/* The row of T that is row i of M and of nothing else; -1: there is none. */
static void find_places(coils *c, int rank, const double *T) {
    for (int i = 0; i < c->n; i++)
        c->place[i] = -1;
    for (int k = 0; k < rank; k++) {
        int terms = 0, last = -1;
        for (int i = 0; i < c->n; i++)
            if (T[(size_t)k + (size_t)i * (size_t)c->n] != 0) {
                terms++;
                last = i;
            }
        if (terms == 1)
            c->place[last] = k;
    }
}

/* 1 if the part is no network of capacitors and all of its rows are rows of T, each with its own entry. */
static int are_coils(const coils *c) {
    int joined = 0;
    for (int k = 0; k < c->count; k++) {
        const int i = c->row[k];
        double sum = 0;
        if (c->place[i] < 0 || !(entry(c, i, i) > 0))
            return 0;
        for (int j = 0; j < c->n; j++) {
            sum += entry(c, i, j);
            joined |= j != i && entry(c, i, j) > 0;
        }
        joined |= sum < 0;
    }
    return joined;
}

/* The row without a pivot of which the largest part is left. */
static int find_pivot(const coils *c) {
    int best = -1;
    double most = 0;
    for (int k = 0; k < c->count; k++) {
        const double part = c->a[k + k * c->count] / entry(c, c->row[k], c->row[k]);
        if (!c->used[k] && part > most * (1 + 1e-9)) {
            most = part;
            best = k;
        }
    }
    return best;
}

static void eliminate(const coils *c, int p) {
    const int count = c->count;
    for (int k = 0; k < count; k++) {
        const double f = c->a[k + p * count] / c->a[p + p * count];
        if (c->used[k] || f == 0)
            continue;
        for (int j = 0; j < count; j++) {
            c->t[k + j * count] -= f * c->t[p + j * count];
            c->a[k + j * count] -= f * c->a[p + j * count];
        }
        c->a[k + p * count] = 0;
    }
}

/* Row p of the part, if little is left of it. */
static void write_row(const coils *c, int p, double *T, double *TM) {
    const int i = c->row[p], count = c->count;
    if (!(c->a[p + p * count] < close_part * entry(c, i, i)))
        return;
    for (int j = 0; j < count; j++) {
        const size_t at = (size_t)c->place[i] + (size_t)c->row[j] * (size_t)c->n;
        T[at] = c->t[p + j * count];
        TM[at] = c->a[p + j * count];
    }
}

static int replace_rows(coils *c, double *T, double *TM) {
    const size_t count = (size_t)c->count;
    c->a = calloc(2 * count * count, sizeof *c->a);
    if (!c->a)
        return NS_E_MEMORY;
    c->t = c->a + count * count;
    memset(c->used, 0, sizeof *c->used * count);
    for (size_t j = 0; j < count; j++)
        for (size_t k = 0; k < count; k++) {
            c->a[k + j * count] = entry(c, c->row[k], c->row[j]);
            c->t[k + j * count] = k == j;
        }
    for (int p = find_pivot(c); p >= 0; p = find_pivot(c)) {
        c->used[p] = 1;
        write_row(c, p, T, TM);
        eliminate(c, p);
    }
    free(c->a);
    return NS_OK;
}

int ns_linalg_leakage(int n, const double *M, int rank, double *T, double *TM) {
    coils c;
    int status = create(&c, n, M);
    if (status == NS_OK)
        find_places(&c, rank, T);
    for (int first = 0; first < n && status == NS_OK; first++) {
        if (c.reached[first])
            continue;
        c.count = ns_linalg_cut_sets_part(n, M, first, c.row, c.reached);
        if (c.count > 1 && are_coils(&c))
            status = replace_rows(&c, T, TM);
    }
    free(c.row);
    return status;
}
