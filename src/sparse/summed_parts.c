/* src/sparse/summed_parts.c - Kirchhoff's current law of a part that resistors and capacitors join, in one
 * exact row: what linalg/summed_parts.c does with arrays.
 */
#include "assemble.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

static const double eps_factor = 8 * DBL_EPSILON;

typedef struct sums {
    const ns_csc *M, *A, *Tt;
    const unsigned char *algebraic;
    int n;
    int *part;    /* n: the part of a row, by its first one */
    int *list;    /* n: rows, part by part */
    int *open;    /* n: 1: something leads out of the part of that first row */
    int *rounded; /* n: 1: a diagonal entry of that part is the rounded sum of several branches */
} sums;

static double entry(const ns_csc *a, int i, int j) {
    for (int k = a->start[j]; k < a->start[j + 1]; k++)
        if (a->row[k] == i)
            return a->value[k];
    return 0;
}

/* 1 if entries of one sign join row i to row j, whose own entry is `own`. */
static int joined(const ns_csc *a, double own, int i, int j) {
    return entry(a, i, j) * own < 0 && entry(a, j, i) * own < 0 && entry(a, i, i) * own > 0;
}

/* Row j of part `first`: the rows joined to it become the next ones of the list.  Returns how many it has. */
static int list_joined(sums *s, const ns_csc *a, int first, int j, int count) {
    const double own = entry(a, j, j);
    int several = 0;
    for (int k = a->start[j]; own != 0 && k < a->start[j + 1]; k++) {
        const int i = a->row[k];
        if (!joined(a, own, i, j))
            continue;
        s->rounded[first] |= several;
        several = 1;
        if (s->part[i] < 0) {
            s->part[i] = first;
            s->list[count++] = i;
        }
    }
    return count;
}

/* From place `at` in the list on: row `first`, and those that resistors (A) and capacitors (M) join to it.
 * Returns where the next part begins. */
static int list_part(sums *s, int first, int at) {
    int count = at + 1;
    s->list[at] = first;
    s->part[first] = first;
    for (; at < count; at++) {
        const int j = s->list[at];
        count = list_joined(s, s->A, first, j, count);
        count = list_joined(s, s->M, first, j, count);
    }
    return count;
}

static void list_parts(sums *s) {
    for (int i = 0; i < s->n; i++)
        s->part[i] = -1;
    for (int i = 0, at = 0; i < s->n; i++)
        if (s->part[i] < 0)
            at = list_part(s, i, at);
}

int ns_sparse_part_cancels(const ns_csc *a, const int *part, int p, int j) {
    double sum = 0, size = 0;
    for (int k = a->start[j]; k < a->start[j + 1]; k++)
        if (part[a->row[k]] == p) {
            sum += a->value[k];
            size += fabs(a->value[k]);
        }
    return fabs(sum) <= eps_factor * size;
}

static void find_open(sums *s) {
    for (int j = 0; j < s->n; j++) {
        s->open[s->part[j]] |= !ns_sparse_part_cancels(s->A, s->part, s->part[j], j);
        for (int k = s->M->start[j]; k < s->M->start[j + 1]; k++)
            s->open[s->part[s->M->row[k]]] |=
                !ns_sparse_part_cancels(s->M, s->part, s->part[s->M->row[k]], j);
    }
}

static int is_unit(const sums *s, int i) {
    return s->algebraic[i] && s->Tt->start[i + 1] - s->Tt->start[i] == 1 && s->Tt->row[s->Tt->start[i]] == i;
}

/* What T gets, to e: in place of a row of each part that is closed the sum of all. */
static void put_sums(const sums *s, ns_entries *e) {
    for (int at = 0, next = 0; at < s->n; at = next) {
        const int first = s->list[at], is_summed = s->rounded[first] && !s->open[first];
        int place = -1;
        for (next = at; next < s->n && s->part[s->list[next]] == first; next++)
            if (place < 0 && is_unit(s, s->list[next]))
                place = s->list[next];
        for (int k = at; k < next && is_summed && place >= 0; k++)
            if (s->list[k] != place)
                ns_linalg_entries_add(e, s->list[k], place, 1);
    }
}

/* NOLINTNEXTLINE(readability-non-const-parameter): written through s */
int ns_sparse_sum_parts(const ns_csc *M, const ns_csc *A, const unsigned char *algebraic, ns_csc *Tt) {
    sums s = {.M = M, .A = A, .Tt = Tt, .algebraic = algebraic, .n = A->columns};
    ns_entries e = {0};
    ns_csc T = {0};
    s.part = calloc(4 * (size_t)s.n + 1, sizeof *s.part);
    if (!s.part)
        return NS_E_MEMORY;
    s.list = s.part + s.n;
    s.open = s.list + s.n;
    s.rounded = s.open + s.n;
    list_parts(&s);
    find_open(&s);
    put_sums(&s, &e);
    for (int i = 0; i < s.n; i++)
        for (int k = Tt->start[i]; k < Tt->start[i + 1]; k++)
            ns_linalg_entries_add(&e, Tt->row[k], i, Tt->value[k]);
    const int status = ns_linalg_csc_of_entries(s.n, s.n, &e, &T);
    if (status == NS_OK) {
        ns_linalg_csc_free(Tt);
        *Tt = T;
    }
    ns_linalg_entries_free(&e);
    free(s.part);
    return status;
}
