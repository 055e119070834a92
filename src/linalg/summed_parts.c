/* src/linalg/summed_parts.c - Kirchhoff's current law of a part that resistors and capacitors join, in one
 * exact row.
 *
 * The conductances at a star point are summed and rounded: 1/R1 + 1/R2 + 1/R3 on the diagonal and the three
 * beside it need not cancel.  Where nothing but open devices ties such a part to the rest, what is left
 * over, 1e-17 S, is all that determines its voltage; leaks of a step of 1e-12 s are smaller than that.  In
 * the sum of the part's rows the resistors inside cancel exactly, and so it takes the place of one of them.
 * So do capacitors inside, which in such a step conduct 1e10 S and more; they join parts as resistors do.
 */
#include "summed_parts.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "nonsmooth/status.h"

static const double eps_factor = 8 * DBL_EPSILON;

static int joined(int n, const double *A, int i, int j) {
    const double there = A[i + j * n], back = A[j + i * n];
    return i != j && there * back > 0 && there * A[i + i * n] < 0 && back * A[j + j * n] < 0;
}

/* To row (n): `first`, and all rows that A or M joins to it; returns how many. */
static int list_part(int n, const double *A, const double *M, int first, int *row, int *reached) {
    int count = 1;
    row[0] = first;
    reached[first] = 1;
    for (int at = 0; at < count; at++)
        for (int j = 0; j < n; j++)
            if (!reached[j] && (joined(n, A, row[at], j) || joined(n, M, row[at], j))) {
                reached[j] = 1;
                row[count++] = j;
            }
    return count;
}

static int joins_several(int n, const double *a, int i) {
    int count = 0;
    for (int j = 0; j < n; j++)
        count += joined(n, a, i, j);
    return count > 1;
}

/* 1 if a diagonal entry of these rows is the rounded sum of several branches.  That of one branch, g, and its
 * -g beside it cancel exactly. */
static int may_be_rounded(int n, const double *A, const double *M, const int *row, int count) {
    for (int k = 0; k < count; k++)
        if (joins_several(n, A, row[k]) || joins_several(n, M, row[k]))
            return 1;
    return 0;
}

/* 1 if these rows of a cancel in column j. */
static int cancel(int n, const double *a, const int *row, int count, int j) {
    double sum = 0, size = 0;
    for (int k = 0; k < count; k++) {
        sum += a[row[k] + j * n];
        size += fabs(a[row[k] + j * n]);
    }
    return fabs(sum) <= eps_factor * size;
}

static int is_closed(int n, const double *A, const double *M, const int *row, int count) {
    for (int k = 0; k < count; k++)
        if (!cancel(n, A, row, count, row[k]))
            return 0;
    for (int j = 0; j < n; j++)
        if (!cancel(n, M, row, count, j))
            return 0;
    return 1;
}

/* The algebraic row of T that is one of these rows and of nothing else; -1: there is none. */
static int unit_row(int n, int rank, const double *T, const int *row, int count) {
    for (int i = rank; i < n; i++) {
        int terms = 0, own = 0;
        for (int j = 0; j < n; j++)
            terms += T[i + j * n] != 0;
        for (int k = 0; k < count; k++)
            own += T[i + row[k] * n] != 0;
        if (terms == 1 && own == 1)
            return i;
    }
    return -1;
}

int ns_linalg_summed_parts(int n, const double *A, const double *M, int rank, double *T) {
    int *row = calloc(2 * (size_t)n + 1, sizeof *row);
    if (!row)
        return NS_E_MEMORY;
    int *reached = row + n;
    for (int first = 0; first < n; first++) {
        const int count = reached[first] ? 0 : list_part(n, A, M, first, row, reached);
        const int is_summed = may_be_rounded(n, A, M, row, count) && is_closed(n, A, M, row, count);
        const int place = is_summed ? unit_row(n, rank, T, row, count) : -1;
        for (int k = 0; k < count && place >= 0; k++)
            T[place + row[k] * n] = 1;
    }
    free(row);
    return NS_OK;
}
