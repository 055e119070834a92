/* src/sparse/leaky_parts.c - Kirchhoff's current law of a part that only large resistors join to the rest.
 *
 * 1 Gohm from the far side of a transformer to ground: the voltage of that side as a whole is what its rows
 * leave when they are added up.  Each holds currents of C/h beside the leak, and in a step of 1e-15 s their
 * rounding is a volt across the 1 Gohm.  So an algebraic row of such a part becomes the sum of all of its
 * rows, in which nothing but the leaks is left.
 *
 * Rows are joined where anything but a large resistor leads from one node to the other: entries of A and M of
 * one sign in both directions, the current of a branch or of a pair that leaves one and enters the other.
 *
 * Then the same is done inside of these parts, and of what is joined to ground, where a pair whose device
 * leaks very little joins nothing: a blocked one is a large resistor, and in the sum stands the lambda of a
 * closed one.
 *
 * A itself is rounded: 1e-12 S beside 3 S in the diagonal entry of a node has four digits.  What flows out of
 * a part is exact where it is taken from the rows that it enters: of other parts, and of ground.
 */
#include "assemble.h"

#include "linalg/sparse_lu.h"
#include "system/union_find.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* S: smaller conductances are leaks.  Those of devices are followed where they are smaller than this:
 * rounding of larger ones is below 1e-4 of the voltages, and with their sums some runs took Euler steps, or
 * were refused. */
static const double leak = 1e-3, tiny_leak = 2e-10, rounding = 8 * DBL_EPSILON;
/* A sum has each row of T an integer number of times; below this it does not have it.  A place is searched
 * for so many sums at most. */
static const double least_multiple = 0.5;
enum { MOST_SEARCHES = 64 };

typedef struct leaky {
    const ns_large *a;
    const unsigned char *balance, *algebraic;
    const double *ground; /* n: the row of ground in A */
    const ns_csc *Tt;
    int n;
    int *uses;     /* n */
    int *part;     /* n+1: of each row, by its top; n: ground's; a row that is no balance is alone */
    int *size;     /* n+1: balances in a part, by its top */
    int *sum;      /* n+1: the row of T in which its sum stands, by its top; -1: none */
    double *leads; /* n+1: by its top, the largest conductance that leads out of it */
    const struct leaky *outer; /* NULL, or the parts that all pairs join */
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

/* Siemens beside the pair of column j of B, between the two balances it enters, or one and ground; 0: there
 * are none, or they are not known. */
static double beside(const leaky *l, int j) {
    const ns_csc *B = &l->a->B, *A = &l->a->A;
    int end[2] = {-1, -1}, count = 0;
    double siemens = 0;
    for (int k = B->start[j]; k < B->start[j + 1]; k++)
        if (l->balance[B->row[k]] && B->value[k] != 0) {
            end[count > 0] = B->row[k];
            count++;
        }
    if (count == 1)
        return isnan(l->ground[end[0]]) ? 0 : fabs(l->ground[end[0]]);
    for (int k = count == 2 ? A->start[end[0]] : 0; count == 2 && k < A->start[end[0] + 1]; k++)
        if (A->row[k] == end[1])
            siemens = fabs(A->value[k]);
    return siemens;
}

/* 1 if the pair of column j joins what it leads to. */
static int joins(const leaky *l, int j) {
    const double siemens = l->outer ? beside(l, j) : 0;
    return !(siemens > 0 && siemens < tiny_leak);
}

static void join_branches(const leaky *l) {
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
        if (joins(l, j))
            join_column(l, &a->B, j);
    for (int j = 0; j < a->E.columns; j++)
        join_column(l, &a->E, j);
}

/* Siemens in column j that lead out of part p: from its own rows, or from those of all other parts and of
 * ground, where less is rounded. */
static double leads_out(const leaky *l, int j, int p) {
    const ns_csc *A = &l->a->A;
    double in = 0, of_in = 0, out = l->ground[j], of_out = fabs(out);
    for (int k = A->start[j]; k < A->start[j + 1]; k++) {
        const double value = A->value[k];
        if (!l->balance[A->row[k]])
            continue;
        if (l->part[A->row[k]] == p) {
            in += value;
            of_in += fabs(value);
        } else {
            out += value;
            of_out += fabs(value);
        }
    }
    if (of_out < of_in && fabs(in + out) <= rounding * (of_in + of_out)) {
        in = -out;
        of_in = of_out;
    }
    return fabs(in) > rounding * of_in ? in : 0;
}

static void find_parts(const leaky *l) {
    join_branches(l);
    for (int i = 0; i <= l->n; i++)
        l->part[i] = ns_system_union_top(l->part, i);
    for (int i = 0; i < l->n; i++)
        l->size[l->part[i]] += l->balance[i];
    for (int j = 0; j < l->n; j++)
        if (l->balance[j]) {
            double *leads = &l->leads[l->part[j]];
            *leads = fmax(*leads, fabs(leads_out(l, j, l->part[j])));
        }
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

/* How well the sum of part p stands in the place of row i: the one whose own voltages the largest leak holds,
 * so that the diagonal keeps its pivots; of equals a single row of the system. */
static double fitness(const leaky *l, int i, int p) {
    const int *row = l->Tt->row + l->Tt->start[i], count = l->Tt->start[i + 1] - l->Tt->start[i];
    double most = count == 1 ? leak * DBL_EPSILON : 0;
    for (int k = 0; k < count; k++)
        most = fmax(most, fabs(leads_out(l, row[k], p)));
    return most;
}

/* 1 if part p gets a sum: the outer part gets its own, which stands in none of the rows of p. */
static int is_summed(const leaky *l, int p, int outer_sum) {
    return l->leads[p] > 0 && p != l->part[l->n] && l->size[p] > 1 &&
           (!l->outer || (l->leads[p] < tiny_leak && (outer_sum < 0 || l->part[outer_sum] != p)));
}

/* The row of the sum of the outer part of node i; -1: there is none. */
static int outer_sum_of(const leaky *l, int i) {
    return l->outer ? l->outer->sum[l->outer->part[i]] : -1;
}

/* Of each part that is not joined to ground the algebraic row that fits best. */
static int find_rows(const leaky *l) {
    int count = 0;
    for (int i = 0; i <= l->n; i++)
        l->sum[i] = -1;
    for (int i = 0; i < l->n; i++) {
        const int p = l->part[i];
        if (!l->balance[i] || !l->algebraic[i] || !is_summed(l, p, outer_sum_of(l, i)) || !is_alone(l, i))
            continue;
        count += l->sum[p] < 0;
        if (l->sum[p] < 0 || fitness(l, i, p) > fitness(l, l->sum[p], p))
            l->sum[p] = i;
    }
    return count;
}

/* Puts to T the rows of it that are sums of parts. */
static void put_sums(const leaky *l, ns_entries *T) {
    for (int i = 0; i < l->n; i++)
        if (l->balance[i] && l->sum[l->part[i]] >= 0)
            ns_linalg_entries_add(T, i, l->sum[l->part[i]], 1);
}

static int is_sum(const leaky *l, int i) {
    return l->balance[i] && l->sum[l->part[i]] == i;
}

/* T with the sums of both that have a place so far. */
static int make_T(const leaky *outer, const leaky *inner, ns_csc *T) {
    const ns_csc *Tt = outer->Tt;
    ns_entries e = {0};
    put_sums(outer, &e);
    put_sums(inner, &e);
    for (int i = 0; i < outer->n; i++)
        for (int k = Tt->start[i]; k < Tt->start[i + 1] && !is_sum(outer, i) && !is_sum(inner, i); k++)
            ns_linalg_entries_add(&e, Tt->row[k], i, Tt->value[k]);
    const int status = ns_linalg_csc_of_entries(outer->n, outer->n, &e, T);
    ns_linalg_entries_free(&e);
    return status;
}

/* Puts their rows of A. */
static void put_currents(const leaky *l, ns_entries *sums) {
    const ns_csc *A = &l->a->A;
    for (int j = 0; j < l->n; j++)
        for (int k = A->start[j]; k < A->start[j + 1]; k++) {
            const int p = l->part[A->row[k]];
            int is_first = l->balance[A->row[k]] && l->sum[p] >= 0;
            for (int q = A->start[j]; q < k && is_first; q++)
                is_first = !l->balance[A->row[q]] || l->part[A->row[q]] != p;
            const double siemens = is_first ? leads_out(l, j, p) : 0;
            if (siemens != 0)
                ns_linalg_entries_add(sums, j, l->sum[p], siemens);
        }
}

/* c (n): the sum of part p as a sum of rows of T, so many times each. */
static int find_multiples(const leaky *outer, const leaky *inner, const leaky *l, int p, double *c) {
    ns_csc T = {0};
    ns_klu *k = NULL;
    ns_factors *f = NULL;
    int status = make_T(outer, inner, &T);
    if (status == NS_OK)
        status = ns_linalg_klu_create(l->n, T.start, T.row, &k);
    if (status == NS_OK)
        status = ns_linalg_klu_factor(k, T.value, &f);
    for (int i = 0; i < l->n; i++)
        c[i] = l->balance[i] && l->part[i] == p;
    if (status == NS_OK)
        ns_linalg_klu_solve(k, f, c);
    ns_linalg_factors_free(k, f);
    ns_linalg_klu_free(k);
    ns_linalg_csc_free(&T);
    return status;
}

/* The row of T, -1: none, that fits best of those that are in the sum of part p as often as c says: T stays
 * regular if the sum takes its place. */
static int best_row(const leaky *outer, const leaky *inner, const leaky *l, int p, const double *c) {
    int best = -1;
    for (int i = 0; i < l->n; i++)
        if (l->part[i] == p && l->balance[i] && l->algebraic[i] && fabs(c[i]) > least_multiple &&
            !is_sum(outer, i) && !is_sum(inner, i) && (best < 0 || fitness(l, i, p) > fitness(l, best, p)))
            best = i;
    return best;
}

/* A place for the sums of parts that have none.  c: n. */
static int find_other_rows(const leaky *outer, const leaky *inner, const leaky *l, double *c, int *count) {
    for (int p = 0, searches = 0; p < l->n && searches < MOST_SEARCHES; p++) {
        if (l->sum[p] >= 0 || !is_summed(l, p, outer_sum_of(l, p)))
            continue;
        searches++;
        const int status = find_multiples(outer, inner, l, p, c);
        if (status != NS_OK && status != NS_E_SINGULAR)
            return status;
        l->sum[p] = status == NS_OK ? best_row(outer, inner, l, p, c) : -1;
        *count += l->sum[p] >= 0;
    }
    return NS_OK;
}

/* Tt becomes T with the sums of both. */
static int make_sums(const leaky *outer, const leaky *inner, ns_csc *Tt, ns_csc *sums) {
    ns_entries of_sums = {0};
    ns_csc T = {0};
    int status = make_T(outer, inner, &T);
    put_currents(outer, &of_sums);
    put_currents(inner, &of_sums);
    if (status == NS_OK)
        status = ns_linalg_csc_of_entries(outer->n, outer->n, &of_sums, sums);
    ns_linalg_entries_free(&of_sums);
    if (status == NS_OK) {
        ns_linalg_csc_free(Tt);
        *Tt = T;
    } else
        ns_linalg_csc_free(&T);
    return status;
}

/* ints: 3n+3; numbers: n+1 */
static int begin(leaky *l, int *ints, double *numbers) {
    l->part = ints;
    l->size = ints + l->n + 1;
    l->sum = l->size + l->n + 1;
    l->leads = numbers;
    find_parts(l);
    return find_rows(l);
}

/* NOLINTNEXTLINE(readability-non-const-parameter): written through l */
int ns_sparse_sum_leaky_parts(const ns_system *s, const ns_large *a, const unsigned char *algebraic,
                              ns_csc *Tt, ns_csc *sums) {
    const size_t rows = (size_t)Tt->columns + 1;
    leaky outer = {.a = a,
                   .balance = s->balance,
                   .algebraic = algebraic,
                   .ground = s->ground,
                   .Tt = Tt,
                   .n = Tt->columns};
    int *ints = calloc(7 * rows, sizeof *ints), status = NS_E_MEMORY;
    double *numbers = calloc(3 * rows, sizeof *numbers);
    if (ints && numbers) {
        outer.uses = ints + 6 * rows;
        count_uses(&outer);
        leaky inner = outer;
        inner.outer = &outer;
        int count = begin(&outer, ints, numbers);
        count += begin(&inner, ints + 3 * rows, numbers + rows);
        status = find_other_rows(&outer, &inner, &outer, numbers + 2 * rows, &count);
        if (status == NS_OK)
            status = find_other_rows(&outer, &inner, &inner, numbers + 2 * rows, &count);
        if (status == NS_OK && count > 0)
            status = make_sums(&outer, &inner, Tt, sums);
    }
    free(ints);
    free(numbers);
    return status;
}
