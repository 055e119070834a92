/* src/sparse/split_rows.c - which rows of a sparse M are algebraic, part by part.
 *
 * Rows that share no unknown can be split apart.  Small parts are split as dense ones (row_split.c).  A large
 * part is a network of capacitors: its rows are independent, or, where no capacitor leads to ground, they sum
 * to zero and nothing else does.
 */
#include "assemble.h"

#include "linalg/row_split.h"
#include "system/union_find.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SMALL = 48 };

typedef struct parts {
    const ns_csc *M;
    ns_csc Mt; /* rows of M */
    int n;
    int *parent; /* n */
    int *first;  /* n+1: where the rows of a part begin in list, by their root */
    int *list;   /* n */
    int *place;  /* n: of a row inside its part */
    double *dense;
    const double *flow; /* n: how much flows in a row */
    ns_entries T;
    unsigned char *algebraic;
} parts;

static void find_parts(parts *p) {
    ns_system_union_begin(p->parent, p->n);
    for (int j = 0; j < p->n; j++)
        for (int k = p->M->start[j]; k < p->M->start[j + 1]; k++)
            if (p->M->value[k] != 0)
                ns_system_union_join(p->parent, p->M->row[k], j);
    for (int i = 0; i < p->n; i++)
        p->first[ns_system_union_top(p->parent, i)]++;
    for (int i = 0; i < p->n; i++)
        p->first[i + 1] += p->first[i];
    for (int i = p->n - 1; i >= 0; i--)
        p->list[--p->first[ns_system_union_top(p->parent, i)]] = i;
}

static int split_small(parts *p, const int *rows, int count) {
    double *M = p->dense, *T = M + SMALL * SMALL, flow[SMALL];
    int rank;
    memset(M, 0, sizeof(double) * (size_t)count * (size_t)count);
    for (int i = 0; i < count; i++) {
        p->place[rows[i]] = i;
        flow[i] = p->flow[rows[i]];
    }
    for (int j = 0; j < count; j++)
        for (int k = p->M->start[rows[j]]; k < p->M->start[rows[j] + 1]; k++)
            if (p->M->value[k] != 0)
                M[p->place[p->M->row[k]] + j * count] = p->M->value[k];
    const int status = ns_linalg_row_split_quiet(count, M, flow, T, &rank);
    for (int i = 0; i < count && status == NS_OK; i++) {
        p->algebraic[rows[i]] = i >= rank;
        for (int j = 0; j < count; j++)
            if (T[i + j * count] != 0)
                ns_linalg_entries_add(&p->T, rows[j], rows[i], T[i + j * count]);
    }
    return status;
}

/* 1 if the rows sum to zero: each column does. */
static int floats(const parts *p, const int *rows, int count) {
    for (int i = 0; i < count; i++) {
        double sum = 0, terms = 0;
        for (int k = p->M->start[rows[i]]; k < p->M->start[rows[i] + 1]; k++) {
            sum += p->M->value[k];
            terms += fabs(p->M->value[k]);
        }
        if (fabs(sum) > 64 * DBL_EPSILON * terms)
            return 0;
    }
    return 1;
}

/* The row in whose place the sum of all stands. */
static int busiest(const parts *p, const int *rows, int count) {
    int at = rows[0];
    for (int i = 1; i < count; i++)
        if (p->flow[rows[i]] > p->flow[at])
            at = rows[i];
    return at;
}

static void split_large(parts *p, const int *rows, int count) {
    const int sum = floats(p, rows, count) ? busiest(p, rows, count) : -1;
    for (int i = 0; i < count; i++) {
        ns_linalg_entries_add(&p->T, rows[i], rows[i], 1);
        if (sum >= 0 && rows[i] != sum)
            ns_linalg_entries_add(&p->T, rows[i], sum, 1);
    }
    if (sum >= 0)
        p->algebraic[sum] = 1;
}

static int split(parts *p) {
    int status = NS_OK;
    find_parts(p);
    /* NOLINTNEXTLINE(clang-analyzer-unix.Malloc): entries are freed by ns_sparse_split() */
    for (int i = 0; i < p->n && status == NS_OK; i++) {
        const int *rows = p->list + p->first[i], count = p->first[i + 1] - p->first[i];
        if (count > SMALL)
            split_large(p, rows, count);
        else if (count > 0)
            status = split_small(p, rows, count);
    }
    return status;
}

/* NOLINTNEXTLINE(readability-non-const-parameter): written through p */
int ns_sparse_split(const ns_csc *M, const double *flow, ns_csc *Tt, unsigned char *algebraic) {
    const size_t n = (size_t)M->columns;
    parts p = {.M = M, .n = M->columns, .flow = flow, .algebraic = algebraic};
    p.parent = calloc(4 * n + 1, sizeof(int));
    p.dense = calloc((size_t)2 * SMALL * SMALL, sizeof(double));
    int status = p.parent && p.dense ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK) {
        p.first = p.parent + n;
        p.list = p.first + n + 1;
        p.place = p.list + n;
        status = split(&p);
    }
    if (status == NS_OK)
        status = ns_linalg_csc_of_entries(p.n, p.n, &p.T, Tt);
    ns_linalg_entries_free(&p.T);
    free(p.parent);
    free(p.dense);
    return status;
}
