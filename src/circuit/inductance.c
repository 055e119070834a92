/* src/circuit/inductance.c - the inductance matrix: its entries, and whether it can be one.
 *
 * Coupled inductors store the energy i'Li/2, never negative.  Factors given one by one can break that (0.99,
 * 0.99 and 0 among three windings); solutions of such a system grow without a source.  The test is symmetric
 * elimination with diagonal pivoting on the coupling factors (L with unit diagonal).
 */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "circuit_internal.h"

void ns_circuit_each_inductance(const ns_circuit *c,
                                void (*visit)(void *to, int row, int column, double henries), void *to) {
    for (int i = 0; i < c->nelements; i++) {
        const element *e = &c->element[i];
        if (e->kind == INDUCTOR) {
            visit(to, i, i, e->value);
        } else if (e->kind == COUPLING) {
            int l1 = e->by[0], l2 = e->by[1];
            double m = e->value * sqrt(c->element[l1].value) * sqrt(c->element[l2].value);
            visit(to, l1, l2, m);
            visit(to, l2, l1, m);
        }
    }
}

static size_t ij(int n, int i, int j) {
    return (size_t)i + (size_t)j * (size_t)n;
}

/* Numbers the inductors that are coupled; place (nelements): -1 for the others.  Returns how many. */
static int number_coupled(const ns_circuit *c, int *place) {
    int count = 0;
    for (int i = 0; i < c->nelements; i++) {
        place[i] = -1;
    }
    for (int i = 0; i < c->nelements; i++) {
        for (int k = 0; c->element[i].kind == COUPLING && k < 2; k++) {
            int l = c->element[i].by[k];
            place[l] = place[l] < 0 ? count++ : place[l];
        }
    }
    return count;
}

static void fill_coupling_matrix(const ns_circuit *c, const int *place, int n, double *a) {
    for (int i = 0; i < n; i++) {
        a[ij(n, i, i)] = 1;
    }
    for (int i = 0; i < c->nelements; i++) {
        const element *e = &c->element[i];
        if (e->kind == COUPLING) {
            a[ij(n, place[e->by[0]], place[e->by[1]])] += e->value;
            a[ij(n, place[e->by[1]], place[e->by[0]])] += e->value;
        }
    }
}

/* The largest diagonal entry; rows done have theirs 0. */
static int largest_pivot(int n, const double *a) {
    int best = 0;
    for (int i = 1; i < n; i++) {
        best = a[ij(n, i, i)] > a[ij(n, best, best)] ? i : best;
    }
    return best;
}

static void eliminate(int n, double *a, int p) {
    double pivot = a[ij(n, p, p)];
    for (int j = 0; j < n; j++) {
        double f = a[ij(n, p, j)] / pivot;
        for (int i = 0; i < n && j != p && f != 0; i++) {
            if (i != p) {
                a[ij(n, i, j)] -= a[ij(n, i, p)] * f;
            }
        }
    }
    for (int i = 0; i < n; i++) {
        a[ij(n, i, p)] = a[ij(n, p, i)] = 0;
    }
}

/* Index of a row that shows a (n*n, unit diagonal, overwritten) to be indefinite, -1 if none does. */
static int indefinite_row(int n, double *a) {
    double zero = 64 * DBL_EPSILON * n;
    for (int step = 0; step < n; step++) {
        int p = largest_pivot(n, a);
        if (a[ij(n, p, p)] <= zero) {
            break;
        }
        eliminate(n, a, p);
    }
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < n; i++) {
            if (i == j ? a[ij(n, i, i)] < -zero : fabs(a[ij(n, i, j)]) > zero) {
                return j;
            }
        }
    }
    return -1;
}

/* Two rows without a coupling that are both coupled with a third one: *i < *k; 0: there are none. */
static int find_missing(int n, const double *a, int *i, int *k) {
    for (*k = 1; *k < n; ++*k) {
        for (*i = 0; *i < *k; ++*i) {
            for (int j = 0; j < n && a[ij(n, *i, *k)] == 0; j++) {
                if (j != *i && j != *k && a[ij(n, *i, j)] != 0 && a[ij(n, *k, j)] != 0) {
                    return 1;
                }
            }
        }
    }
    return 0;
}

static const char *name_of(const ns_circuit *c, const int *place, int row) {
    int e = 0;
    while (e + 1 < c->nelements && place[e] != row) {
        e++;
    }
    return c->element[e].name;
}

/* a: the coupling factors; bad: the row that shows that they contradict each other. */
static int refuse_couplings(ns_circuit *c, const int *place, int n, const double *a, int bad) {
    static const char why[] =
        "its coupling factors and those of the inductors it is coupled with contradict each "
        "other (the stored energy could be negative)";
    const char *name = name_of(c, place, bad);
    int i, k;
    if (find_missing(n, a, &i, &k)) {
        return ns_circuit_complain(c, NS_E_RANGE, "%.80s: %s: there is no K between %.40s and %.40s", name,
                                   why, name_of(c, place, i), name_of(c, place, k));
    }
    return ns_circuit_complain(c, NS_E_RANGE, "%.80s: %s", name, why);
}

static int check_couplings(ns_circuit *c, int *place) {
    int n = number_coupled(c, place), bad, status = NS_OK;
    double *a = n > 0 ? calloc((size_t)n * (size_t)n, sizeof *a) : NULL;
    if (n == 0) {
        return NS_OK;
    }
    if (!a) {
        return ns_circuit_complain(c, NS_E_MEMORY, "out of memory");
    }
    fill_coupling_matrix(c, place, n, a);
    bad = indefinite_row(n, a);
    if (bad >= 0) {
        memset(a, 0, (size_t)n * (size_t)n * sizeof *a); /* indefinite_row() overwrote it */
        fill_coupling_matrix(c, place, n, a);
        status = refuse_couplings(c, place, n, a, bad);
    }
    free(a);
    return status;
}

int ns_circuit_check_inductances(ns_circuit *c) {
    int status, *place = calloc((size_t)c->nelements + 1, sizeof *place);
    if (!place) {
        return ns_circuit_complain(c, NS_E_MEMORY, "out of memory");
    }
    status = check_couplings(c, place);
    free(place);
    return status;
}
