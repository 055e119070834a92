/* src/theta/floating_dc.c - parts of a circuit that only capacitors tie to the rest, at the operating point.
 *
 * Capacitors are open there, so the sum of the KCL rows of such a part is 0 = 0 and its voltage is
 * undetermined.  Sources that rise from zero leave the charge of the part at zero: that takes the place of
 * one of these rows.  A loop of inductors without resistance keeps its flux at zero in the same way.
 */
#include "floating_dc.h"

#include <math.h>
#include <stdlib.h>

#include "linalg/row_split.h"

/* S across each pair, and from each held unknown to ground: a pair joins its nodes, whatever its mode. */
static const double joined = 1e-6;

/* a (n*n) = -A + g B C, and g T e e' of each held unknown e; size (n*n): the sum of the sizes of the terms.
 */
static void join(const ns_theta *s, int nhold, const int *hold, double *a, double *size) {
    const size_t n = (size_t)s->s->n, m = (size_t)s->s->m;
    for (size_t at = 0; at < n * n; at++) {
        a[at] = -s->A[at];
        size[at] = fabs(a[at]);
    }
    for (size_t j = 0; j < n; j++)
        for (size_t k = 0; k < m; k++)
            for (size_t i = 0; i < n && s->s->C[k + j * m] != 0; i++) {
                const double term = joined * s->B[i + k * n] * s->s->C[k + j * m];
                a[i + j * n] += term;
                size[i + j * n] += fabs(term);
            }
    for (int k = 0; k < nhold; k++)
        for (size_t i = 0; i < n; i++) {
            const size_t at = i + (size_t)hold[k] * n;
            a[at] += joined * s->T[at];
            size[at] += fabs(joined * s->T[at]);
        }
}

/* The right-hand sides of the rows of a part add up to zero. */
static int adds_up(const ns_theta *s, const double *part) {
    static const double rounding = 1e-12;
    const int n = s->s->n;
    double sum = 0, terms = 0;
    for (int i = 0; i < n; i++) {
        sum += part[i * n] * s->rhs[i];
        terms += fabs(part[i * n] * s->rhs[i]);
    }
    return fabs(sum) <= rounding * terms;
}

/* The charge of a part, of each unknown (n).  Returns the largest. */
static double charge_of(const ns_theta *s, const double *part, double *charge) {
    const int n = s->s->n;
    double most = 0;
    for (int j = 0; j < n; j++) {
        charge[j] = 0;
        for (int i = 0; i < s->r; i++)
            charge[j] += part[i * n] * s->M[i + j * n];
        most = fmax(most, fabs(charge[j]));
    }
    return most;
}

/* In place of a row of K. */
static void put_charge(ns_theta *s, int size, int row, double most, const double *charge) {
    for (int j = 0; j < size; j++)
        s->K[row + j * size] = j < s->s->n ? charge[j] / most : 0;
    s->rhs[row] = 0;
}

/* T (n*n): left null vectors in rows rank..n-1, each with one row that follows from others.  work: 2 n. */
static void take_places(ns_theta *s, int size, const double *T, int rank, double *work) {
    const int n = s->s->n;
    double *stays = work, *charge = work + n;
    for (int i = 0; i < n; i++) {
        stays[i] = 0;
        for (int k = 0; k < rank; k++)
            stays[i] += T[k + i * n];
    }
    for (int k = rank; k < n; k++) {
        const double most = adds_up(s, T + k) ? charge_of(s, T + k, charge) : 0;
        for (int i = 0; i < n && most > 0; i++)
            if (stays[i] == 0 && T[k + i * n] != 0)
                put_charge(s, size, i, most, charge);
    }
}

int ns_theta_floating_dc(ns_theta *s, int nhold, const int *hold) {
    const int n = s->s->n;
    const size_t square = (size_t)n * (size_t)n;
    double *a = calloc(3 * square + 2 * (size_t)n + 1, sizeof *a);
    int rank;
    if (!a)
        return NS_E_MEMORY;
    double *T = a + 2 * square;
    join(s, nhold, hold, a, a + square);
    const int status = ns_linalg_row_split_rows(n, a, a + square, T, &rank);
    if (status == NS_OK)
        take_places(s, n + s->s->m + nhold, T, rank, T + square);
    free(a);
    return status;
}
