/* src/engine/sparse_leaky.c - (P2) where the laws of devices leave it singular: the limit of vanishing leaks.
 *
 * Two closed switches in parallel share a current in no particular way; a part behind open ones floats.  With
 * a leak across each open pair and a resistance in series with each closed one K is regular, K_g, and
 *
 *     v <- v + K_g^-1 (r - K v),   from v = 0
 *
 * converges to a solution of K v = r: what is determined in a few rounds, what is open as the leaks share it.
 * Leaks are some share of what is around them, in units in which all entries of K are near 1.
 */
#include "sparse_leaky.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SWEEPS = 24, PEAKS = 6, ROUNDS = 30 };
/* Large ones leave more digits of what is open; what hangs together by less than they are takes small ones.
 */
static const double shares[] = {1e-6, 1e-10};
/* What is left of (P2), of the terms of its rows, where it holds; where it may still be said to, if rounds
 * gain no more. */
static const double holds = 64 * DBL_EPSILON, may_hold = 1e-11, far = 1e-3;

/* The mean of the exponents of rows and columns is brought to zero, in turns, then peaks are cut. */
static void find_units(const ns_csc *K, const int *exponent, double *row, double *column, double *count) {
    const int size = K->columns;
    memset(row, 0, sizeof(double) * (size_t)size);
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
            row[i] /= fmax(1, count[i]);
        for (int j = 0; j < size; j++) {
            double sum = 0, entries = 0;
            for (int k = K->start[j]; k < K->start[j + 1]; k++)
                if (exponent[k] != INT_MIN) {
                    sum += exponent[k] + row[K->row[k]];
                    entries++;
                }
            column[j] = -sum / fmax(1, entries);
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
                    count[K->row[k]] = fmax(count[K->row[k]], e);
                    most = fmax(most, e);
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
            most = fmax(most, exponent[k] + row[f->K.row[k]]);
    return most;
}

static double leaves(const ns_form *f, const double *column, int j) {
    double most = -INFINITY;
    for (int k = f->Ct.start[j]; k < f->Ct.start[j + 1]; k++)
        if (f->Ct.value[k] != 0)
            most = fmax(most, ilogb(f->Ct.value[k]) + column[f->Ct.row[k]]);
    return most;
}

int ns_leaky_find(const ns_form *f, const ns_mode *mode, const double *value, int small, double *leak,
                  double *scale) {
    const int size = f->size, entries = f->K.start[size];
    int *exponent = calloc((size_t)entries + 1, sizeof *exponent);
    double *row = calloc(3 * (size_t)size + 1, sizeof(double)), *column = row + size;
    if (!exponent || !row) {
        free(exponent);
        free(row);
        return NS_E_MEMORY;
    }
    for (int k = 0; k < entries; k++)
        exponent[k] = value[k] != 0 ? ilogb(value[k]) : INT_MIN;
    find_units(&f->K, exponent, row, column, column + size);
    for (int j = 0; j < f->m; j++) {
        const double at = mode[j] == NS_INSIDE ? -row[f->n + j] - column[f->n + j]
                                               : -enters(f, exponent, row, j) - leaves(f, column, j);
        leak[j] = fabs(at) < 900 && !ns_slides(mode[j]) ? shares[small] * exp2(at) : 0;
    }
    for (int i = 0; i < size; i++)
        scale[i] = exp2(fmin(fmax(row[i], -900), 900));
    free(exponent);
    free(row);
    return NS_OK;
}

/* The terms that row i of (P2) is summed from. */
static double terms_of(const ns_form *f, double g, const ns_mode *mode, int i, const double *v) {
    const int j = i - f->n;
    if (j < 0)
        return (f->algebraic[i] ? 0 : ns_csc_size(&f->Mt, i, v)) +
               ns_form_rate(f, g, i) * ns_csc_size(&f->At, i, v);
    return ns_slides(mode[j])     ? ns_csc_size(&f->gx, f->command[j], v)
           : mode[j] == NS_INSIDE ? ns_csc_size(&f->Ct, j, v)
                                  : fabs(v[i]);
}

/* Those of lambda_j as what is left over in the rows it enters. */
static double terms_around(const ns_form *f, double g, const ns_mode *mode, int j, const double *v) {
    double most = 0;
    for (int k = f->K.start[f->n + j]; k < f->K.start[f->n + j + 1]; k++) {
        const int i = f->K.row[k];
        if (i < f->n && f->KA[k] != 0)
            most = fmax(most, terms_of(f, g, mode, i, v) / fabs(f->KA[k] * ns_form_rate(f, g, i)));
    }
    return most;
}

double ns_leaky_left(const ns_form *f, double g, const ns_mode *mode, const double *scale, const double *r,
                     const double *v, const double *seen, double *rest) {
    double worst = 0, most = 0;
    for (int i = 0; scale && i < f->size; i++)
        most = fmax(most, scale[i] * (fabs(r[i]) + terms_of(f, g, mode, i, v)));
    memcpy(rest, r, sizeof(double) * (size_t)f->size);
    ns_form_subtract(f, g, mode, v, rest);
    for (int i = 0; i < f->size; i++) {
        const int j = i - f->n;
        if (rest[i] == 0)
            continue;
        double terms = fabs(r[i]) + terms_of(f, g, mode, i, v) + (scale ? far * most / scale[i] : 0);
        if (j >= 0 && mode[j] != NS_INSIDE && !ns_slides(mode[j]))
            terms += terms_around(f, g, mode, j, v);
        if (seen && fabs(rest[i]) > worst * terms) /* terms may be what others round */
            terms += terms_of(f, g, mode, i, seen);
        worst = fabs(rest[i]) <= worst * terms ? worst : fabs(rest[i]) / terms; /* NaN stays */
    }
    return worst;
}

int ns_leaky_solve(const ns_form *f, double g, const ns_mode *mode, const double *scale, ns_klu *klu,
                   ns_factors *factors, const double *r, double *v, double *rest) {
    double left = INFINITY, least = INFINITY;
    int since = 0;
    memcpy(rest, r, sizeof(double) * (size_t)f->size);
    memset(v, 0, sizeof(double) * (size_t)f->size);
    for (int round = 0; round < ROUNDS && since < 4; round++, since++) {
        ns_klu_solve(klu, factors, rest);
        for (int i = 0; i < f->size; i++)
            v[i] += rest[i];
        left = ns_leaky_left(f, g, mode, scale, r, v, NULL, rest);
        if (left <= holds)
            return NS_OK;
        if (left < 0.5 * least) {
            least = left;
            since = 0;
        }
    }
    if (left <= may_hold)
        return NS_OK;
    memcpy(v, r, sizeof(double) * (size_t)f->size);
    ns_klu_solve(klu, factors, v);
    return NS_E_SINGULAR;
}
