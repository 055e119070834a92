/* src/engine/open.c - guards of which only sums are determined.
 *
 * Of two blocking diodes between which an island floats each has any voltage, while both together have one;
 * of two conducting ones in parallel each carries any share.  Leaks settle such guards, to the digits that a
 * small leak has, but it is enough that the mode holds for some other share:
 *
 *     guard + N alpha >= 0,    column j of N: what changes the guards and satisfies (P2) all the same
 *
 * The least such alpha is N^T lambda,  0 <= lambda  _|_  N N^T lambda + guard >= 0,  |alpha|^2 = -guard'
 * lambda.
 */
#include "open.h"

#include "nonsmooth/mlcp.h"

#include <math.h>
#include <stdlib.h>

/* An alpha so much larger than the guards are is made of rounding in N. */
static const double largest_alpha = 1e4;

/* Rows of N, made ones of length 1, and the problem of their guards. */
typedef struct least {
    double *S; /* m*count */
    double *W, *q, *l, *u, *lambda, *y;
    ns_mode *mode;
    int count;
} least;

static int make(least *p, int guards, int m) {
    const size_t g = (size_t)guards;
    p->S = calloc(g * (size_t)m + g * g + 7 * g + 1, sizeof(double));
    if (!p->S)
        return NS_E_MEMORY;
    p->W = p->S + g * (size_t)m;
    p->q = p->W + g * g;
    p->l = p->q + g;
    p->u = p->l + g;
    p->lambda = p->u + g;
    p->y = p->lambda + g;
    p->mode = (ns_mode *)(p->y + g);
    p->count = 0;
    return NS_OK;
}

static void join(least *p, int g, int guards, int m, const double *N, double guard) {
    double *row = p->S + (size_t)p->count * (size_t)m, square = 0;
    for (int k = 0; k < m; k++)
        square += N[g + k * guards] * N[g + k * guards];
    if (!(square > 0))
        return;
    for (int k = 0; k < m; k++)
        row[k] = N[g + k * guards] / sqrt(square);
    p->q[p->count] = guard / sqrt(square);
    p->u[p->count] = INFINITY;
    p->mode[p->count++] = NS_LOWER;
}

static void form(least *p, int m) {
    for (int j = 0; j < p->count; j++)
        for (int i = 0; i < p->count; i++) {
            const double *a = p->S + (size_t)i * (size_t)m, *b = p->S + (size_t)j * (size_t)m;
            double sum = 0;
            for (int k = 0; k < m; k++)
                sum += a[k] * b[k];
            p->W[i + j * p->count] = sum;
        }
}

static int solve(least *p) {
    const ns_mlcp problem = {.m = p->count, .W = p->W, .q = p->q, .l = p->l, .u = p->u};
    ns_mlcp_solver *solver;
    if (ns_mlcp_create(p->count, &solver) != NS_OK)
        return NS_E_MEMORY;
    const int status = ns_mlcp_solve(solver, &problem, p->mode, p->lambda, p->y, NULL);
    ns_mlcp_free(solver);
    double square = 0, largest = 0;
    for (int g = 0; g < p->count; g++) {
        square -= p->q[g] * p->lambda[g];
        largest = fmax(largest, fabs(p->q[g]));
    }
    return status == NS_OK && sqrt(square) <= largest_alpha * largest ? NS_OK : NS_GUARD;
}

int ns_open_settle(int guards, int m, const double *N, const double *guard, const double *size) {
    least p;
    int status = make(&p, guards, m);
    if (status != NS_OK)
        return status;
    for (int g = 0; g < guards; g++)
        join(&p, g, guards, m, N, guard[g] + size[g]);
    form(&p, m);
    status = solve(&p);
    free(p.S);
    return status;
}
