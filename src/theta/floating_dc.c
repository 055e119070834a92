/* src/theta/floating_dc.c - parts of a circuit that only capacitors tie to the rest, at the operating point.
 *
 * Capacitors are open there, so the sum of the KCL rows of such a part is 0 = 0 and its voltage is
 * undetermined.  Sources that rise from zero leave the charge of the part at zero: that takes the place of
 * one of these rows.  A loop of inductors without resistance, of sources and nodes that are held, keeps its
 * flux at zero in the same way: what flows there comes from what holds the node.
 */
#include "floating_dc.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "linalg/row_split.h"

/* S across each pair: it joins its nodes, whatever its mode. */
static const double joined = 1e-6;

/* The rows of an operating point without its pairs: n of the system, one of each held unknown. */
typedef struct dc_rows {
    ns_theta *s;
    int n, count; /* of the system; of all */
    int nhold;
    const int *hold;
} dc_rows;

/* The place of a row in K and in s->rhs. */
static int place_of(const dc_rows *d, int row) {
    return row < d->n ? row : row + d->s->s->m;
}

/* a (count*count) = -A + g B C, a column -T e for the current that holds an unknown and a row e' for its
 * value; size: the sums of the sizes of the terms. */
static void join(const dc_rows *d, double *a, double *size) {
    const ns_theta *s = d->s;
    const size_t n = (size_t)d->n, all = (size_t)d->count, m = (size_t)s->s->m;
    for (size_t j = 0; j < n; j++)
        for (size_t i = 0; i < n; i++) {
            a[i + j * all] = -s->A[i + j * n];
            size[i + j * all] = fabs(a[i + j * all]);
        }
    for (size_t j = 0; j < n; j++)
        for (size_t k = 0; k < m; k++)
            for (size_t i = 0; i < n && s->s->C[k + j * m] != 0; i++) {
                const double term = joined * s->B[i + k * n] * s->s->C[k + j * m];
                a[i + j * all] += term;
                size[i + j * all] += fabs(term);
            }
    for (size_t k = 0; k < (size_t)d->nhold; k++) {
        const size_t held = (size_t)d->hold[k];
        for (size_t i = 0; i < n; i++) {
            a[i + (n + k) * all] = -s->T[i + held * n];
            size[i + (n + k) * all] = fabs(s->T[i + held * n]);
        }
        a[n + k + held * all] = size[n + k + held * all] = 1;
    }
}

/* The right-hand sides of the rows of a part add up to zero.  A row that is not of the part may have rounding
 * of the largest multiplier in place of zero, which its right-hand side multiplies. */
static int adds_up(const dc_rows *d, const double *part) {
    static const double rounding = 1e-12, of_zero = 64 * DBL_EPSILON;
    double sum = 0, terms = 0, beside = 0, most = 0;
    for (int i = 0; i < d->count; i++) {
        const double by = part[i * d->count], value = by != 0 ? d->s->rhs[place_of(d, i)] : 0;
        sum += by * value;
        terms += fabs(by * value);
        beside += fabs(value);
        most = fmax(most, fabs(by));
    }
    return fabs(sum) <= rounding * terms + of_zero * most * beside;
}

/* The charge of a part, of each unknown (n).  Returns the largest. */
static double charge_of(const dc_rows *d, const double *part, double *charge) {
    double most = 0;
    for (int j = 0; j < d->n; j++) {
        charge[j] = 0;
        for (int i = 0; i < d->s->r; i++)
            charge[j] += part[i * d->count] * d->s->M[i + j * d->n];
        most = fmax(most, fabs(charge[j]));
    }
    return most;
}

/* In place of a row of K. */
static void put_charge(const dc_rows *d, int row, double most, const double *charge) {
    const int size = d->count + d->s->s->m;
    for (int j = 0; j < size; j++)
        d->s->K[row + j * size] = j < d->n ? charge[j] / most : 0;
    d->s->rhs[row] = 0;
}

/* T (count*count): left null vectors in rows rank..count-1, each with one row that follows from others.
 * work: 2 count. */
static void take_places(const dc_rows *d, const double *T, int rank, double *work) {
    double *stays = work, *charge = work + d->count;
    for (int i = 0; i < d->count; i++) {
        stays[i] = 0;
        for (int k = 0; k < rank; k++)
            stays[i] += T[k + i * d->count];
    }
    for (int k = rank; k < d->count; k++) {
        const double most = adds_up(d, T + k) ? charge_of(d, T + k, charge) : 0;
        for (int i = 0; i < d->count && most > 0; i++)
            if (stays[i] == 0 && T[k + i * d->count] != 0)
                put_charge(d, place_of(d, i), most, charge);
    }
}

static int find_parts(const dc_rows *d, ns_floating_parts *parts) {
    const size_t square = (size_t)d->count * (size_t)d->count;
    double *a = calloc(2 * square + 1, sizeof *a);
    parts->null = calloc(square + 1, sizeof *parts->null);
    int status = a && parts->null ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK) {
        join(d, a, a + square);
        status = ns_linalg_row_split_rows(d->count, a, a + square, parts->null, &parts->rank);
    }
    free(a);
    if (status != NS_OK) {
        free(parts->null);
        parts->null = NULL;
    }
    return status;
}

int ns_theta_floating_dc(ns_theta *s, int nhold, const int *hold, ns_floating_parts *parts) {
    const dc_rows d = {s, s->s->n, s->s->n + nhold, nhold, hold};
    double *work = calloc(2 * (size_t)d.count + 1, sizeof *work);
    int status = work ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK && !parts->null)
        status = find_parts(&d, parts);
    if (status == NS_OK)
        take_places(&d, parts->null, parts->rank, work);
    free(work);
    return status;
}
