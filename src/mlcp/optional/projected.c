/* src/mlcp/optional/projected.c - projected Gauss-Seidel, successive overrelaxation.
 *
 *   x_i := proj_[l,u]( x_i - omega y_i / W_ii ),   i = 1 .. m, with y up to date (free x_i: no projection)
 *
 * Converges for M-matrices and dominant diagonals (omega <= 1), and for symmetric positive definite W
 * (0 < omega < 2; Cottle, Pang, Stone, 5.3).  omega is 1 at first, then what Young's formula makes of the
 * rate that is seen, and less where that does not go well.
 */
#include <math.h>
#include <string.h>

#include "mlcp/verify/residual.h"
#include "scaled.h"

enum { SWEEPS = 4000, WINDOW = 20 };
static const double TINY = 1e-14;  /* of the largest entry of a row: no diagonal */
static const double STILL = 1e-16; /* a sweep that moves no x by more, in units of the problem, is the last */
static const double FAR = 1e30;    /* x beyond this: it diverges */

/* 1 / W_ii into d; 0 if one is of no use. */
static int diagonals(const ns_scaled *z, double *d) {
    size_t m = (size_t)z->m;
    for (size_t i = 0; i < m; i++) {
        double top = 0.0, w = z->W[i + i * m];
        int law = ns_mlcp_scaled_law(z, (int)i);
        for (size_t j = 0; j < m; j++)
            top = fmax(top, fabs(z->W[i + j * m]));
        if (law == NS_LAW_FIXED)
            continue;
        if (!((law == NS_LAW_FREE ? fabs(w) : w) > TINY * top))
            return 0;
        d[i] = 1.0 / w;
    }
    return 1;
}

/* One sweep; the largest move. */
static double sweep_rows(ns_scaled *z, const double *d, double omega) {
    double most = 0.0;
    for (int i = 0; i < z->m; i++) {
        if (ns_mlcp_scaled_law(z, i) == NS_LAW_FIXED)
            continue;
        double x = fmin(fmax(z->x[i] - omega * z->y[i] * d[i], z->l[i]), z->u[i]), by = x - z->x[i];
        if (by == 0.0)
            continue;
        z->x[i] = x;
        ns_linalg_matvec_add(z->m, 1, z->W + (size_t)i * (size_t)z->m, &by, z->y);
        most = fmax(most, fabs(by));
    }
    return most;
}

/* The best omega where Gauss-Seidel gains `rate` a sweep (Young, for consistently ordered matrices). */
static double young_omega(double rate) {
    return rate < 1.0 ? 2.0 / (1.0 + sqrt(1.0 - rate)) : 1.0;
}

/* omega after a window of sweeps in which moves shrank by `gain` in all. */
static double adapt_omega(double omega, double gain, int *tuned) {
    double rate = pow(gain, 1.0 / WINDOW);
    if (!(gain < 1.0)) {
        *tuned = 1;
        return omega > 1.0 ? 1.0 : fmax(0.5 * omega, 0.05);
    }
    if (*tuned || rate < 0.5)
        return omega;
    *tuned = 1;
    return young_omega(rate);
}

static int moved_far(const ns_scaled *z) {
    for (int i = 0; i < z->m; i++)
        if (!(fabs(z->x[i]) < FAR))
            return 1;
    return 0;
}

int ns_mlcp_projected(ns_mlcp_solver *s) {
    ns_scaled z;
    int tuned = 0, next = 8;
    double omega = 1.0, before = 0.0;
    ns_mlcp_scaled_load(s, &z);
    if (!diagonals(&z, z.work[1]))
        return NS_E_SINGULAR;
    (void)ns_mlcp_scaled_start(s, &z);
    for (int k = 1; k <= SWEEPS; k++) {
        double most = sweep_rows(&z, z.work[1], omega);
        s->iterations++;
        if (k % WINDOW == 0) {
            if (before > 0.0)
                omega = adapt_omega(omega, most / before, &tuned);
            before = most;
            ns_mlcp_scaled_product(&z); /* y anew: rounding does not add up */
        }
        if (most > STILL && k < next)
            continue;
        if (moved_far(&z))
            return NS_E_LIMIT;
        if (ns_mlcp_scaled_finish(s, &z, z.x, z.y) == NS_OK)
            return NS_OK;
        if (!(most > STILL))
            return NS_E_LIMIT;
        next *= 2;
    }
    return NS_E_LIMIT;
}
