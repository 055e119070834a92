/* src/linalg/sparse.h - sparse matrices, column by column: entered, summed up, multiplied. */
#ifndef NS_LINALG_SPARSE_H
#define NS_LINALG_SPARSE_H

#include <stddef.h>

#include "nonsmooth/csc.h"
#include "nonsmooth/status.h"

/* Entries as they come, the same place more than once if need be. */
typedef struct ns_entries {
    size_t count, room;
    int *row, *column;
    double *value;
    int failed; /* memory ran out: entries are missing */
} ns_entries;

void ns_linalg_entries_add(ns_entries *e, int row, int column, double value);
void ns_linalg_entries_free(ns_entries *e);

/* What was entered at one place is summed in the order of entering; sums of zero are kept.  Rows of a column
 * ascend.  Errors: MEMORY. */
int ns_linalg_csc_of_entries(int rows, int columns, const ns_entries *e, ns_csc *out);

/* The same, but sums that cancel to rounding are left out: those within 8 eps of the sizes of their terms.
 * Changes the values of e.  Errors: MEMORY. */
int ns_linalg_csc_of_terms(int rows, int columns, ns_entries *e, ns_csc *out);

/* The entries of a dense array (rows*columns, NULL where it is empty) that are not zero.  Errors: MEMORY. */
int ns_linalg_csc_of_dense(int rows, int columns, const double *a, ns_csc *out);

int ns_linalg_csc_transpose(const ns_csc *a, ns_csc *out); /* Errors: MEMORY. */
void ns_linalg_csc_free(ns_csc *a);                        /* frees its arrays */

/* y += A x. */
void ns_linalg_csc_times_add(const ns_csc *a, const double *x, double *y);

/* Column j of a times x; the sum of the sizes of its terms. */
static inline double ns_linalg_csc_dot(const ns_csc *a, int j, const double *x) {
    double sum = 0;
    for (int k = a->start[j]; k < a->start[j + 1]; k++)
        sum += a->value[k] * x[a->row[k]];
    return sum;
}
double ns_linalg_csc_size(const ns_csc *a, int j, const double *x);

#endif
