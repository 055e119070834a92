/* src/sparse/leaks.c - the leaks of a singular (P2): a fraction of the entries around them, in units in which
 * all entries of K are near 1.
 */
#include "regularise.h"

#include "linalg/simd.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SWEEPS = 24, PEAKS = 6 };
static const double leak_fraction = 1e-7;

/* Exponents of scales: the mean exponent of rows and of columns is brought to zero in turns, then the largest
 * of each is lowered. */
static void find_units(const ns_csc *K, const int *exponent, double *row, double *column, double *count) {
    const int size = K->columns;
    memset(column, 0, sizeof(double) * (size_t)size);
    for (int sweep = 0; sweep < SWEEPS; sweep++) {
        memset(row, 0, sizeof(double) * (size_t)size);
        memset(count, 0, sizeof(double) * (size_t)size);
        for (int j = 0; j < size; j++)
            for (int k = K->start[j]; k < K->start[j + 1]; k++)
                if (exponent[k] != INT_MIN) {
                    row[K->row[k]] -= exponent[k] + column[j];
                    count[K->row[k]]++;
                }
        for (int i = 0; i < size; i++)
            row[i] /= ns_higher(1, count[i]);
        for (int j = 0; j < size; j++) {
            double sum = 0, entries = 0;
            for (int k = K->start[j]; k < K->start[j + 1]; k++)
                if (exponent[k] != INT_MIN) {
                    sum += exponent[k] + row[K->row[k]];
                    entries++;
                }
            column[j] = -sum / ns_higher(1, entries);
        }
    }
    for (int sweep = 0; sweep < PEAKS; sweep++) {
        for (int i = 0; i < size; i++)
            count[i] = 0;
        for (int j = 0; j < size; j++) {
            double most = 0;
            for (int k = K->start[j]; k < K->start[j + 1]; k++)
                if (exponent[k] != INT_MIN) {
                    const double e = exponent[k] + row[K->row[k]] + column[j];
                    count[K->row[k]] = ns_higher(count[K->row[k]], e);
                    most = ns_higher(most, e);
                }
            column[j] -= most / 2;
        }
        for (int i = 0; i < size; i++)
            row[i] -= count[i] / 2;
    }
}

/* The largest entry of the rows of x in column j of K, in units; of row j of [C D]. */
static double enters(const ns_form *f, const int *exponent, const double *row, int j) {
    double most = -INFINITY;
    for (int k = f->K.start[f->n + j]; k < f->K.start[f->n + j + 1]; k++)
        if (f->K.row[k] < f->n && exponent[k] != INT_MIN)
            most = ns_higher(most, exponent[k] + row[f->K.row[k]]);
    return most;
}

static double leaves(const ns_form *f, const double *column, int j) {
    double most = -INFINITY;
    for (int k = f->Ct.start[j]; k < f->Ct.start[j + 1]; k++)
        if (f->Ct.value[k] != 0)
            most = ns_higher(most, ilogb(f->Ct.value[k]) + column[f->Ct.row[k]]);
    return most;
}

int ns_sparse_leaks_find(const ns_form *f, const ns_mode *mode, const double *value, double *leak,
                         double *scale, double *unit) {
    const int size = f->size, entries = f->K.start[size];
    int *exponent = calloc((size_t)entries + 1, sizeof *exponent);
    double *row = calloc(3 * (size_t)size + 1, sizeof(double));
    if (!exponent || !row) {
        free(exponent);
        free(row);
        return NS_E_MEMORY;
    }
    double *column = row + size;
    for (int k = 0; k < entries; k++)
        exponent[k] = value[k] != 0 ? ilogb(value[k]) : INT_MIN;
    find_units(&f->K, exponent, row, column, column + size);
    for (int j = 0; j < f->m; j++) {
        const double at = mode[j] == NS_INSIDE ? -row[f->n + j] - column[f->n + j]
                                               : -enters(f, exponent, row, j) - leaves(f, column, j);
        leak[j] = fabs(at) < 900 && !ns_mode_slides(mode[j]) ? leak_fraction * exp2(at) : 0;
    }
    for (int i = 0; i < size; i++) {
        scale[i] = exp2(fmin(fmax(row[i], -450), 450));
        unit[i] = exp2(fmin(fmax(-column[i], -450), 450));
    }
    free(exponent);
    free(row);
    return NS_OK;
}
