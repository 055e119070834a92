/* src/mlcp/optional/semismooth_newton.c - semismooth Newton on the Fischer-Burmeister function, with a line
 * search.
 *
 *   phi(a,b) = a + b - sqrt(a^2 + b^2) = 0   if and only if   a >= 0, b >= 0, a b = 0
 *
 *   free:       Phi_i = y_i
 *   one bound:  Phi_i = phi(x_i - l_i, y_i)   or   -phi(u_i - x_i, -y_i)
 *   both:       Phi_i = phi(x_i - l_i, -phi(u_i - x_i, -y_i))
 *
 * Phi is semismooth and 1/2 |Phi|^2 smooth; an element of the B-subdifferential of Phi is
 * H = diag(da) + diag(db) W.  (De Luca, Facchinei, Kanzow, Math. Programming 75 (1996); Billups for boxes.)
 * Where H is singular or its direction no descent: Levenberg and Marquardt's, then the gradient's.
 */
#include <float.h>
#include <math.h>
#include <string.h>

#include "mlcp/verify/residual.h"
#include "scaled.h"

enum { STEPS = 60, HALVINGS = 30, DAMPINGS = 8, STARTS = 3 };
static const double DESCENT = 1e-4; /* Armijo: part of the decrease that the slope promises */
static const double ANGLE = 1e-10;  /* least cosine between direction and gradient, about */
static const double CLOSE = 1e-3;   /* |Phi| from which on a mode is worth trying */
static const double SMALL = 1e-15;  /* |Phi| below which nothing is left to do */

/* phi without cancellation. */
static double phi(double a, double b) {
    double r = hypot(a, b);
    if (isinf(a))
        return b;
    return a + b > 0.0 ? 2.0 * a * (b / (a + b + r)) : a + b - r;
}

/* Derivatives of phi by a and b; at the kink those of the direction (pa, pb). */
static void slopes(double a, double b, double pa, double pb, double *da, double *db) {
    double r = hypot(a, b);
    if (r < DBL_MIN) {
        a = pa;
        b = pb;
        r = hypot(a, b);
    }
    *da = r > 0.0 ? 1.0 - a / r : 1.0;
    *db = r > 0.0 ? 1.0 - b / r : 0.0;
}

static double phi_of_row(const ns_scaled *z, int i) {
    double a = z->x[i] - z->l[i], c = z->u[i] - z->x[i], y = z->y[i];
    switch (ns_mlcp_scaled_law(z, i)) {
    case NS_LAW_FIXED:
        return z->x[i];
    case NS_LAW_FREE:
        return y;
    case NS_LAW_LOWER:
        return phi(a, y);
    case NS_LAW_UPPER:
        return -phi(c, -y);
    default:
        return phi(a, -phi(c, -y));
    }
}

/* Phi at x; returns 1/2 |Phi|^2. */
static double merit_at_x(ns_scaled *z, double *Phi) {
    double sum = 0.0;
    ns_mlcp_scaled_product(z);
    for (int i = 0; i < z->m; i++) {
        Phi[i] = phi_of_row(z, i);
        sum += Phi[i] * Phi[i];
    }
    return 0.5 * sum;
}

/* da, db of row i; at a kink those of the direction in which x_i moves by 1 and y_i by py. */
static void row_slopes(const ns_scaled *z, int i, double py, double *da, double *db) {
    double a = z->x[i] - z->l[i], c = z->u[i] - z->x[i], y = z->y[i], ga, gb, fa, fb;
    int law = ns_mlcp_scaled_law(z, i);
    *da = law == NS_LAW_FIXED ? 1.0 : 0.0;
    *db = law == NS_LAW_FREE ? 1.0 : 0.0;
    if (law == NS_LAW_FIXED || law == NS_LAW_FREE)
        return;
    if (law == NS_LAW_LOWER) {
        slopes(a, y, 1.0, py, da, db);
        return;
    }
    slopes(c, -y, -1.0, -py, &ga, &gb); /* of -phi(c,-y): ga by x, gb by y */
    *da = ga;
    *db = gb;
    if (law == NS_LAW_UPPER)
        return;
    slopes(a, -phi(c, -y), 1.0, ga + gb * py, &fa, &fb);
    *da = fa + fb * ga;
    *db = fb * gb;
}

/* H into G, its diagonals into da and db. */
static void make_jacobian(ns_mlcp_solver *s, const ns_scaled *z, double *da, double *db) {
    size_t m = (size_t)z->m;
    double *kink = s->g, *py = s->ysize;
    for (int i = 0; i < z->m; i++)
        kink[i] = hypot(z->x[i] - z->l[i], z->y[i]) < DBL_MIN || hypot(z->u[i] - z->x[i], z->y[i]) < DBL_MIN;
    ns_linalg_matvec(z->m, z->m, z->W, kink, py);
    for (int i = 0; i < z->m; i++)
        row_slopes(z, i, py[i], &da[i], &db[i]);
    for (size_t j = 0; j < m; j++) {
        const double *w = z->W + j * m;
        double *h = s->G + j * m;
        for (size_t i = 0; i < m; i++)
            h[i] = db[i] * w[i];
        h[j] += da[j];
    }
}

/* g = H' Phi */
static void merit_gradient(const ns_scaled *z, const double *G, const double *Phi, double *g) {
    size_t m = (size_t)z->m;
    for (size_t j = 0; j < m; j++) {
        double sum = 0.0;
        for (size_t i = 0; i < m; i++)
            sum += G[i + j * m] * Phi[i];
        g[j] = sum;
    }
}

static double dot(int n, const double *a, const double *b) {
    double sum = 0.0;
    for (int i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* 1 if d goes down. */
static int descends(int n, const double *d, const double *g) {
    double slope = dot(n, d, g), sizes = sqrt(dot(n, d, d) * dot(n, g, g));
    return isfinite(sizes) && slope < -ANGLE * sizes;
}

/* d = -(H'H + nu)^-1 H' Phi */
static int levenberg(ns_mlcp_solver *s, const ns_scaled *z, const double *g, double nu, double *d) {
    int n = z->m;
    size_t m = (size_t)n;
    for (size_t j = 0; j < m; j++)
        for (size_t i = 0; i <= j; i++)
            s->elim.mag[i + j * m] = s->elim.mag[j + i * m] =
                dot(n, s->G + i * m, s->G + j * m) + (i == j ? nu : 0.0);
    if (ns_mlcp_basis_factor_of(s, n, s->elim.mag, NULL) != NS_OK)
        return 0;
    for (int i = 0; i < n; i++)
        d[i] = -g[i];
    ns_linalg_lu_solve(s->lu, 1, d);
    return descends(n, d, g);
}

static void newton_direction(ns_mlcp_solver *s, const ns_scaled *z, const double *Phi, const double *g,
                             double *d) {
    int n = z->m;
    double rcond;
    for (int i = 0; i < n; i++)
        d[i] = -Phi[i];
    if (ns_mlcp_basis_factor_of(s, n, s->G, &rcond) == NS_OK && rcond > DBL_EPSILON) {
        ns_linalg_lu_solve(s->lu, 1, d);
        if (descends(n, d, g))
            return;
    }
    double nu = fmin(1e-6, sqrt(dot(n, Phi, Phi)));
    for (int k = 0; k < DAMPINGS && nu < 10.0; k++) {
        if (levenberg(s, z, g, nu, d))
            return;
        nu *= 1e3;
    }
    for (int i = 0; i < n; i++)
        d[i] = -g[i];
}

/* x + t d with the first t = 1, 1/2, ... that lowers the merit enough; 0 if none does. */
static int line_search(ns_scaled *z, const double *d, double slope, double *Phi, double *from, double *f) {
    memcpy(from, z->x, (size_t)z->m * sizeof *from);
    double t = 1.0;
    for (int k = 0; k < HALVINGS; k++, t *= 0.5) {
        for (int i = 0; i < z->m; i++)
            z->x[i] = from[i] + t * d[i];
        double now = merit_at_x(z, Phi);
        if (now <= *f + DESCENT * t * slope) {
            *f = now;
            return 1;
        }
    }
    memcpy(z->x, from, (size_t)z->m * sizeof *from);
    (void)merit_at_x(z, Phi);
    return 0;
}

/* 1 if the mode at x is other than the one last looked at (kept in first_y, as mode + 1). */
static int new_mode(ns_mlcp_solver *s, const ns_scaled *z) {
    int changed = 0;
    ns_mlcp_scaled_mode(s, z, z->x, z->y);
    for (int i = 0; i < z->m; i++) {
        unsigned char mode = (unsigned char)(s->mode[i] + 1);
        changed |= s->tab.first_y[i] != mode;
        s->tab.first_y[i] = mode;
    }
    return changed;
}

static int iterate_from(ns_mlcp_solver *s, ns_scaled *z) {
    double *Phi = z->work[0], *g = z->work[1], *d = z->work[2], *da = z->work[3], *db = z->work[4];
    double f = merit_at_x(z, Phi);
    memset(s->tab.first_y, 0xff, (size_t)z->m);
    for (int k = 0; k < STEPS; k++) {
        s->iterations++;
        double norm = sqrt(2.0 * f);
        int fresh = new_mode(s, z), tried = s->tab.first_y[z->m];
        if (fresh)
            s->tab.first_y[z->m] = 0;
        if ((!fresh && !tried) || norm < CLOSE || norm < SMALL) {
            if (!tried && ns_mlcp_scaled_finish(s, z, z->x, z->y) == NS_OK)
                return NS_OK;
            s->tab.first_y[z->m] = 1;
        }
        if (norm < SMALL || !isfinite(norm))
            break;
        make_jacobian(s, z, da, db);
        merit_gradient(z, s->G, Phi, g);
        newton_direction(s, z, Phi, g, d);
        if (!line_search(z, d, dot(z->m, d, g), Phi, z->work[5], &f))
            break;
    }
    return ns_mlcp_scaled_finish(s, z, z->x, z->y);
}

/* Starts: the answer of the mode, then 0 or the bound next to it, then a point inside the bounds. */
int ns_mlcp_newton(ns_mlcp_solver *s) {
    ns_scaled z;
    int status = NS_E_LIMIT;
    ns_mlcp_scaled_load(s, &z);
    for (int start = 0; start < STARTS && status != NS_OK; start++) {
        if (start == 0 && !ns_mlcp_scaled_start(s, &z))
            continue;
        for (int i = 0; i < z.m && start > 0; i++) {
            double inside = start == 2 ? 1.0 : 0.0;
            z.x[i] = z.l[i] == z.u[i] ? 0.0 : fmin(fmax(inside, z.l[i]), z.u[i]);
        }
        status = iterate_from(s, &z);
    }
    return status;
}
