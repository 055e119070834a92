/* src/sparse/leaky_parts.c - Kirchhoff's current law of a part that only large resistors join to the rest.
 *
 * 1 Gohm from the far side of a transformer to ground: the voltage of that side as a whole is what its rows
 * leave when they are added up.  Each holds currents of C/h beside the leak, and in a step of 1e-15 s their
 * rounding is a volt across the 1 Gohm.  So an algebraic row of such a part becomes the sum of all of its
 * rows, in which nothing but the leaks is left.
 *
 * Rows are joined where anything but a large resistor leads from one node to the other: entries of A and M of
 * one sign in both directions, the current of a branch or of a pair that leaves one and enters the other.
 */
#include "assemble.h"

#include "system/union_find.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* S: smaller conductances are leaks. */
static const double leak = 1e-3, rounding = 8 * DBL_EPSILON;

typedef struct leaky {
    const ns_large *a;
    const unsigned char *balance, *algebraic;
    const ns_csc *Tt;
    int n;
    int *part;  /* n+1: of each row, by its top; n: ground's; a row that is no balance is alone */
    int *size;  /* n+1: balances in a part, by its top */
    int *leads; /* n+1: by its top, 1: leaks of a part are left where its rows are added up */
    int *uses;  /* n */
    int *sum;   /* n+1: the row of T in which its sum stands, by its top; -1: none */
} leaky;

/* All balances in column j: what leaves one of them enters the others, or ground if it is alone. */
static void join_column(const leaky *l, const ns_csc *a, int j) {
    int last = -1, count = 0;
    for (int k = a->start[j]; k < a->start[j + 1]; k++) {
        if (!l->balance[a->row[k]] || a->value[k] == 0)
            continue;
        if (last >= 0)
            ns_system_union_join(l->part, last, a->row[k]);
        last = a->row[k];
        count++;
    }
    if (count == 1)
        ns_system_union_join(l->part, last, l->n);
}

/* Column j, the voltage of a node: those that entries above `least` join to it; ground, if they do not add up
 * to zero. */
static void join_node(const leaky *l, const ns_csc *a, int j, double least) {
    double sum = 0, size = 0;
    for (int k = a->start[j]; k < a->start[j + 1]; k++) {
        const int i = a->row[k];
        if (!l->balance[i])
            continue;
        sum += a->value[k];
        size += fabs(a->value[k]);
        if (i != j && fabs(a->value[k]) > least)
            ns_system_union_join(l->part, i, j);
    }
    if (fabs(sum) > fmax(least, rounding * size))
        ns_system_union_join(l->part, j, l->n);
}

static void find_parts(const leaky *l) {
    const ns_large *a = l->a;
    ns_system_union_begin(l->part, l->n + 1);
    for (int j = 0; j < l->n; j++) {
        if (l->balance[j]) {
            join_node(l, &a->A, j, leak);
            join_node(l, &a->M, j, 0);
        } else {
            join_column(l, &a->A, j);
            join_column(l, &a->M, j);
        }
    }
    for (int j = 0; j < a->B.columns; j++)
        join_column(l, &a->B, j);
    for (int j = 0; j < a->E.columns; j++)
        join_column(l, &a->E, j);
    for (int i = 0; i <= l->n; i++)
        l->part[i] = ns_system_union_top(l->part, i);
    for (int i = 0; i < l->n; i++)
        l->size[l->part[i]] += l->balance[i];
}

static void find_leaks(const leaky *l) {
    for (int j = 0; j < l->n; j++)
        if (l->balance[j])
            l->leads[l->part[j]] |= !ns_sparse_part_cancels(&l->a->A, l->part, l->part[j], j);
}

/* uses[i]: rows of T in which row i of the system is. */
static void count_uses(const leaky *l) {
    for (int k = 0; k < l->Tt->start[l->n]; k++)
        l->uses[l->Tt->row[k]] += l->Tt->value[k] != 0;
}

/* 1 if row i of the system is in row i of T and in no other: then T stays regular if another sum that has it
 * takes the place of that row. */
static int is_alone(const leaky *l, int i) {
    int found = 0;
    for (int k = l->Tt->start[i]; k < l->Tt->start[i + 1]; k++)
        found |= l->Tt->row[k] == i && l->Tt->value[k] != 0;
    return found && l->uses[i] == 1;
}

/* Siemens that lead from node i out of part p. */
static double leaves(const leaky *l, int i, int p) {
    const ns_csc *A = &l->a->A;
    double sum = 0;
    for (int k = A->start[i]; k < A->start[i + 1]; k++)
        if (l->part[A->row[k]] == p)
            sum += A->value[k];
    return fabs(sum);
}

/* How well the sum of part p stands in the place of row i: the one whose own voltages the largest leak holds,
 * so that the diagonal keeps its pivots; of equals a single row of the system. */
static double fitness(const leaky *l, int i, int p) {
    const int *row = l->Tt->row + l->Tt->start[i], count = l->Tt->start[i + 1] - l->Tt->start[i];
    double most = count == 1 ? leak * DBL_EPSILON : 0;
    for (int k = 0; k < count; k++)
        most = fmax(most, leaves(l, row[k], p));
    return most;
}

/* Of each part that is not joined to ground the algebraic row that fits best. */
static int find_rows(const leaky *l) {
    int count = 0;
    for (int i = 0; i <= l->n; i++)
        l->sum[i] = -1;
    for (int i = 0; i < l->n; i++) {
        const int p = l->part[i];
        if (!l->balance[i] || !l->algebraic[i] || !l->leads[p] || p == l->part[l->n] || l->size[p] < 2 ||
            !is_alone(l, i))
            continue;
        count += l->sum[p] < 0;
        if (l->sum[p] < 0 || fitness(l, i, p) > fitness(l, l->sum[p], p))
            l->sum[p] = i;
    }
    return count;
}

static int put_rows(const leaky *l, ns_csc *T) {
    ns_entries e = {0};
    for (int i = 0; i < l->n; i++) {
        const int p = l->part[i];
        if (l->balance[i] && l->sum[p] >= 0)
            ns_linalg_entries_add(&e, i, l->sum[p], 1);
        for (int k = l->Tt->start[i]; k < l->Tt->start[i + 1] && l->sum[p] != i; k++)
            ns_linalg_entries_add(&e, l->Tt->row[k], i, l->Tt->value[k]);
    }
    const int status = ns_linalg_csc_of_entries(l->n, l->n, &e, T);
    ns_linalg_entries_free(&e);
    return status;
}

/* NOLINTNEXTLINE(readability-non-const-parameter): written through l */
int ns_sparse_sum_leaky_parts(const ns_large *a, const unsigned char *balance, const unsigned char *algebraic,
                              ns_csc *Tt) {
    leaky l = {.a = a, .balance = balance, .algebraic = algebraic, .Tt = Tt, .n = Tt->columns};
    const size_t rows = (size_t)l.n + 1;
    ns_csc T = {0};
    int status = NS_OK;
    l.part = calloc(5 * rows, sizeof *l.part);
    if (!l.part)
        return NS_E_MEMORY;
    l.size = l.part + rows;
    l.sum = l.size + rows;
    l.leads = l.sum + rows;
    l.uses = l.leads + rows;
    count_uses(&l);
    find_parts(&l);
    find_leaks(&l);
    if (find_rows(&l) > 0 && (status = put_rows(&l, &T)) == NS_OK) {
        ns_linalg_csc_free(Tt);
        *Tt = T;
    }
    free(l.part);
    return status;
}
