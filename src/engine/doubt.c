/* src/engine/doubt.c - guards that only the bound on their rounding excuses, looked at together.
 *
 * Where a part of the circuit floats, or nearly does, the rounding of a guard is far larger than the terms of
 * the guard itself.  A bound on it excuses each of them, one by one, while sums of them are known to the last
 * digit: of two blocking diodes, between which something floats, each has any voltage, both together have
 * one.  But all come from one solution of (P2).  So the mode holds if one rounding r of its rows makes all of
 * them hold,
 *
 *     guard + S r >= 0,    |r_i| <= 1,    S_gi = tol (K^-T c_g)_i (|K| |X| |in|)_i
 *
 * The least such r is S^T lambda,  0 <= lambda  _|_  S S^T lambda + guard >= 0,  |r|^2 = -guard' lambda.
 */
#include "doubt.h"

#include "nonsmooth/mlcp.h"

#include <math.h>
#include <stdlib.h>

ns_doubt *ns_doubt_create(int size, int guards, int q) {
    const size_t z = (size_t)size * (size_t)guards, terms = (size_t)size * (size_t)q,
                 own = (size_t)guards * (size_t)q;
    ns_doubt *d = malloc(sizeof *d + sizeof(double) * (z + terms + own));
    if (!d)
        return NULL;
    d->size = size;
    d->guards = guards;
    d->q = q;
    d->Z = (double *)(void *)(d + 1);
    d->terms = d->Z + z;
    d->own = d->terms + terms;
    return d;
}

/* sum_k a_ik |in_k|, row i of a (rows*q). */
static double of_inputs(const double *a, int rows, int i, int q, const double *in) {
    double sum = 0;
    for (int k = 0; k < q; k++)
        sum += a[i + k * rows] * fabs(in[k]);
    return sum;
}

/* The problem of d->guards pairs, and room for its answer. */
typedef struct least {
    double *S; /* count*size: a row a guard, of length 1 */
    double *W, *q, *l, *u, *lambda, *y;
    ns_mode *mode;
    int count; /* guards that some r breaks, or mends */
} least;

static int make(least *p, int guards, int size) {
    const size_t m = (size_t)guards;
    p->S = calloc(m * (size_t)size + m * m + 7 * m + 1, sizeof(double));
    if (!p->S)
        return NS_E_MEMORY;
    p->W = p->S + m * (size_t)size;
    p->q = p->W + m * m;
    p->l = p->q + m;
    p->u = p->l + m;
    p->lambda = p->u + m;
    p->y = p->lambda + m;
    p->mode = (ns_mode *)(p->y + m);
    p->count = 0;
    return NS_OK;
}

/* Row g of S, made one of length 1, joins if some |r| <= 1 breaks guard g.  terms (size). */
static void join(least *p, const ns_doubt *d, int g, double guard, const double *terms) {
    double *row = p->S + (size_t)p->count * (size_t)d->size, square = 0, sum = 0;
    for (int i = 0; i < d->size; i++) {
        row[i] = d->Z[i + g * d->size] * terms[i];
        square += row[i] * row[i];
        sum += fabs(row[i]);
    }
    const double length = sqrt(square);
    if (guard >= sum || !(length > 0))
        return;
    for (int i = 0; i < d->size; i++)
        row[i] /= length;
    p->q[p->count] = guard / length;
    p->l[p->count] = 0;
    p->u[p->count] = INFINITY;
    p->mode[p->count++] = NS_LOWER;
}

static void form(least *p, int size) {
    for (int j = 0; j < p->count; j++)
        for (int i = 0; i < p->count; i++) {
            const double *a = p->S + (size_t)i * (size_t)size, *b = p->S + (size_t)j * (size_t)size;
            long double sum = 0;
            for (int k = 0; k < size; k++)
                sum += (long double)a[k] * b[k];
            p->W[i + j * p->count] = (double)sum;
        }
}

/* |r|^2 against what |r_i| <= 1 allows: as much as there are rows. */
static int solve(least *p, int size) {
    const ns_mlcp problem = {.m = p->count, .W = p->W, .q = p->q, .l = p->l, .u = p->u};
    ns_mlcp_solver *solver;
    int status = ns_mlcp_create(p->count, &solver);
    if (status != NS_OK)
        return status;
    status = ns_mlcp_solve(solver, &problem, p->mode, p->lambda, p->y, NULL);
    ns_mlcp_free(solver);
    double square = 0;
    for (int g = 0; g < p->count; g++)
        square -= p->q[g] * p->lambda[g];
    return status == NS_OK && square <= size ? NS_OK : NS_GUARD;
}

int ns_doubt_settle(const ns_doubt *d, const double *guard, const double *in, double tol) {
    least p;
    double *terms = malloc(sizeof(double) * ((size_t)d->size + 1));
    int status = terms ? make(&p, d->guards, d->size) : NS_E_MEMORY;
    if (status == NS_OK) {
        for (int i = 0; i < d->size; i++)
            terms[i] = tol * of_inputs(d->terms, d->size, i, d->q, in);
        for (int g = 0; g < d->guards; g++)
            join(&p, d, g, guard[g] + tol * of_inputs(d->own, d->guards, g, d->q, in), terms);
        form(&p, d->size);
        status = solve(&p, d->size);
        free(p.S);
    }
    free(terms);
    return status;
}
