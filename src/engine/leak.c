/* src/engine/leak.c - what the ideal laws leave open, settled as the limit of real devices.
 *
 * Two closed ideal switches in parallel share a current in no particular way; a part of a circuit behind open
 * ones floats.  Real switches have a resistance and real open ones leak: with conductances g across the open
 * pairs and resistances rho in series with the others (P2) is regular, K_g, and
 *
 *     X <- X + K_g^-1 (rhs - K X),   from X = 0
 *
 * converges to a solution of K X = rhs, the limit g, rho -> 0: what is determined to rounding in a few
 * rounds, what is open as the leaks share it.
 */
#include "leak.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS = 12 };
/* Leaks take this share of what is there: small enough that each round gains some digits, large enough that
 * K_g keeps half of them. */
static const double share = 1e-7;
/* An equation is met when its residual is below this, relative to the sizes of its terms: some hundred eps.
 */
static const double met_tol = 1e-13;
static const double contradiction_tol = 1e-9;

static double row_factor(const ns_theta *s, double h, int implicit, int i) {
    return i < s->r ? (implicit ? h : h * s->theta) : 1;
}

/* The conductance that row i shows the devices: its largest entry in W, per unit of device current. */
static double row_size(const ns_theta *s, double h, int implicit, int i) {
    const int n = s->s->n;
    const double factor = row_factor(s, h, implicit, i);
    double size = 0;
    for (int j = 0; j < n; j++)
        size = fmax(size, fabs((i < s->r ? s->M[i + j * n] : 0) - factor * s->A[i + j * n]));
    return size / factor;
}

void ns_leak_sizes(const ns_theta *s, double h, int implicit, double part, double *g, double *rho) {
    const int n = s->s->n, m = s->s->m;
    double smallest = INFINITY;
    for (int i = 0; i < n; i++) {
        const double size = row_size(s, h, implicit, i);
        if (size > 0)
            smallest = fmin(smallest, size);
    }
    if (!isfinite(smallest))
        smallest = 1;
    for (int j = 0; j < m; j++) {
        double low = INFINITY, high = 0;
        for (int i = 0; i < n; i++) {
            const double size = s->B[i + j * n] != 0 ? row_size(s, h, implicit, i) : 0;
            if (size > 0) {
                low = fmin(low, size);
                high = fmax(high, size);
            }
        }
        g[j] = part * (isfinite(low) ? low : smallest);
        rho[j] = part / (high > 0 ? high : smallest);
    }
}

/* s->K becomes K_g. */
static void add_leaks(ns_theta *s, double h, int implicit, const ns_mode *mode, int size, const double *g,
                      const double *rho) {
    const int n = s->s->n, m = s->s->m;
    for (int j = 0, inside = 0; j < m; j++) {
        if (mode[j] == NS_INSIDE) {
            s->K[(n + inside) * (size + 1)] += rho[j];
            inside++;
            continue;
        }
        for (int k = 0; k < n; k++)
            for (int i = 0; i < n; i++)
                s->K[i + k * size] +=
                    row_factor(s, h, implicit, i) * g[j] * s->B[i + j * n] * s->s->C[j + k * m];
    }
}

/* residual = rhs - K X, one column; its size against its terms. */
static double residual_of(int size, const double *K, const double *rhs, const double *X, double *residual) {
    double worst = 0;
    for (int i = 0; i < size; i++) {
        double sum = rhs[i], terms = fabs(rhs[i]);
        for (int j = 0; j < size; j++) {
            const double term = K[i + j * size] * X[j];
            sum -= term;
            terms += fabs(term);
        }
        residual[i] = sum;
        if (terms > 0)
            worst = fmax(worst, fabs(sum) / terms);
    }
    return worst;
}

/* Rounds on column rhs: X and the work vector step have size entries. */
static int settle(ns_theta *s, int size, const double *K, const double *rhs, double *X, double *step) {
    double worst = INFINITY;
    memset(X, 0, sizeof(double) * (size_t)size);
    memcpy(step, rhs, sizeof(double) * (size_t)size);
    for (int round = 0; round < ROUNDS && worst > met_tol; round++) {
        ns_lu_solve(s->lu, 1, step);
        for (int i = 0; i < size; i++)
            X[i] += step[i];
        worst = residual_of(size, K, rhs, X, step);
    }
    return worst <= contradiction_tol ? NS_OK : NS_E_SINGULAR;
}

static int solve_columns(ns_theta *s, int size, int nrhs, const double *K, double *rhs) {
    double *step = rhs + size;
    int status = NS_OK;
    for (int k = 0; k < nrhs && status == NS_OK; k++) {
        double *X = s->X + (size_t)k * (size_t)size;
        memcpy(rhs, X, sizeof(double) * (size_t)size);
        status = settle(s, size, K, rhs, X, step);
    }
    return status;
}

int ns_leak_solve(ns_theta *s, double h, int implicit, const ns_mode *mode, int nj, int nrhs) {
    const int size = s->s->n + nj, m = s->s->m;
    const size_t square = (size_t)size * (size_t)size;
    double *K = malloc(sizeof(double) * (square + 2 * (size_t)size + 2 * (size_t)m + 1));
    if (!K)
        return NS_E_MEMORY;
    double *rhs = K + square, *g = rhs + 2 * size, *rho = g + m;
    memcpy(K, s->K, sizeof(double) * square);
    ns_leak_sizes(s, h, implicit, share, g, rho);
    add_leaks(s, h, implicit, mode, size, g, rho);
    s->counts.factors++;
    int status = ns_lu_factor(s->lu, size, s->K, NULL, NULL);
    if (status == NS_OK)
        status = solve_columns(s, size, nrhs, K, rhs);
    free(K);
    return status;
}
