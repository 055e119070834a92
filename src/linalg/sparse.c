/* src/linalg/sparse.c - sparse matrices, column by column. */
#include "sparse.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static int grow(ns_entries *e) {
    const size_t room = 2 * e->room + 64;
    if (room > INT_MAX / 2)
        return 0;
    void *row = realloc(e->row, room * sizeof *e->row);
    if (row)
        e->row = row;
    void *column = realloc(e->column, room * sizeof *e->column);
    if (column)
        e->column = column;
    void *value = realloc(e->value, room * sizeof *e->value);
    if (value)
        e->value = value;
    if (!row || !column || !value)
        return 0;
    e->room = room;
    return 1;
}

void ns_linalg_entries_add(ns_entries *e, int row, int column, double value) {
    if (e->failed || (e->count == e->room && !grow(e))) {
        e->failed = 1;
        return;
    }
    e->row[e->count] = row;
    e->column[e->count] = column;
    e->value[e->count++] = value;
}

void ns_linalg_entries_free(ns_entries *e) {
    free(e->row);
    free(e->column);
    free(e->value);
    memset(e, 0, sizeof *e);
}

static int create(int rows, int columns, size_t count, ns_csc *a) {
    *a = (ns_csc){rows, columns, NULL, NULL, NULL};
    a->start = calloc((size_t)columns + 1, sizeof(int));
    a->row = calloc(count + 1, sizeof(int));
    a->value = calloc(count + 1, sizeof(double));
    if (a->start && a->row && a->value)
        return NS_OK;
    ns_linalg_csc_free(a);
    return NS_E_MEMORY;
}

void ns_linalg_csc_free(ns_csc *a) {
    free(a->start);
    free(a->row);
    free(a->value);
    *a = (ns_csc){0};
}

/* Numbers of entries, by their line, become where the first of each line goes. */
static void sum_up(int lines, int *start) {
    int at = 0;
    for (int i = 0; i <= lines; i++) {
        const int count = start[i];
        start[i] = at;
        at += count;
    }
}

/* After lines were filled, start[i] is the end of line i: back by one line. */
static void step_back(int lines, int *start) {
    for (int i = lines; i > 0; i--)
        start[i] = start[i - 1];
    start[0] = 0;
}

/* Entries of one row that are neighbours now and lie in the same column become one. */
static void add_doubles(ns_csc *a) {
    int to = 0, from = 0;
    for (int j = 0; j < a->columns; j++) {
        const int end = a->start[j + 1], first = to;
        for (; from < end; from++) {
            if (to > first && a->row[to - 1] == a->row[from]) {
                a->value[to - 1] += a->value[from];
            } else {
                a->row[to] = a->row[from];
                a->value[to++] = a->value[from];
            }
        }
        a->start[j + 1] = to;
    }
}

/* Sorted by row first, then by column: both sorts keep the order of what is equal. */
int ns_linalg_csc_of_entries(int rows, int columns, const ns_entries *e, ns_csc *out) {
    ns_csc by_row;
    *out = (ns_csc){0};
    if (e->failed || create(columns, rows, e->count, &by_row) != NS_OK)
        return NS_E_MEMORY;
    for (size_t k = 0; k < e->count; k++)
        by_row.start[e->row[k]]++;
    sum_up(rows, by_row.start);
    for (size_t k = 0; k < e->count; k++) {
        const int at = by_row.start[e->row[k]]++;
        by_row.row[at] = e->column[k];
        by_row.value[at] = e->value[k];
    }
    step_back(rows, by_row.start);
    const int status = ns_linalg_csc_transpose(&by_row, out);
    ns_linalg_csc_free(&by_row);
    if (status == NS_OK)
        add_doubles(out);
    return status;
}

/* Of `sums` what is not rounding of terms of these sizes, at the same places. */
static void drop_rounding(ns_csc *sums, const ns_csc *sizes) {
    static const double rounding = 8 * DBL_EPSILON;
    for (int j = 0, to = 0, from = 0; j < sums->columns; j++) {
        for (const int end = sums->start[j + 1]; from < end; from++)
            if (fabs(sums->value[from]) > rounding * sizes->value[from]) {
                sums->row[to] = sums->row[from];
                sums->value[to++] = sums->value[from];
            }
        sums->start[j + 1] = to;
    }
}

int ns_linalg_csc_of_terms(int rows, int columns, ns_entries *e, ns_csc *out) {
    ns_csc sizes = {0};
    int status = ns_linalg_csc_of_entries(rows, columns, e, out);
    for (size_t k = 0; k < e->count && status == NS_OK; k++)
        e->value[k] = fabs(e->value[k]);
    if (status == NS_OK)
        status = ns_linalg_csc_of_entries(rows, columns, e, &sizes);
    if (status == NS_OK)
        drop_rounding(out, &sizes);
    ns_linalg_csc_free(&sizes);
    return status;
}

int ns_linalg_csc_of_dense(int rows, int columns, const double *a, ns_csc *out) {
    size_t count = 0;
    const size_t places = a ? (size_t)rows * (size_t)columns : 0;
    for (size_t k = 0; k < places; k++)
        count += a[k] != 0;
    if (create(rows, columns, count, out) != NS_OK)
        return NS_E_MEMORY;
    for (int j = 0, at = 0; j < columns && a; j++) {
        for (int i = 0; i < rows; i++) {
            const double value = a[(size_t)i + (size_t)j * (size_t)rows];
            if (value != 0) {
                out->row[at] = i;
                out->value[at++] = value;
            }
        }
        out->start[j + 1] = at;
    }
    return NS_OK;
}

int ns_linalg_csc_transpose(const ns_csc *a, ns_csc *out) {
    const int count = a->start[a->columns];
    if (create(a->columns, a->rows, (size_t)count, out) != NS_OK)
        return NS_E_MEMORY;
    for (int k = 0; k < count; k++)
        out->start[a->row[k]]++;
    sum_up(a->rows, out->start);
    for (int j = 0; j < a->columns; j++)
        for (int k = a->start[j]; k < a->start[j + 1]; k++) {
            const int at = out->start[a->row[k]]++;
            out->row[at] = j;
            out->value[at] = a->value[k];
        }
    step_back(a->rows, out->start);
    return NS_OK;
}

void ns_linalg_csc_times_add(const ns_csc *a, const double *x, double *y) {
    for (int j = 0; j < a->columns; j++)
        for (int k = a->start[j]; x[j] != 0 && k < a->start[j + 1]; k++)
            y[a->row[k]] += a->value[k] * x[j];
}

double ns_linalg_csc_size(const ns_csc *a, int j, const double *x) {
    double sum = 0;
    for (int k = a->start[j]; k < a->start[j + 1]; k++)
        sum += fabs(a->value[k] * x[a->row[k]]);
    return sum;
}
