/* src/engine/newton_jump.c - the impulse problem of a model: what a step with theta = gamma = 1 tends to as h
 * goes to 0.
 *
 * First a step of next to no length takes charges and fluxes across, w+ = M x+; what is impulsive in it grows
 * like 1/h and is dropped.  From w+, which is consistent, a second one finds x, lambda and y at t+.  Either
 * step is taken at h and at h/2 and extrapolated to 0, which leaves what is of second order in h.
 */
#include <math.h>
#include <string.h>

#include "newton.h"

/* Lengths against the fastest time constant: the first for conservation alone; the second also so long that
 * M (x - x_k)/h keeps digits. */
enum { ACROSS = -40, AFTER = -24 };

/* The fastest rate of the model linearised at s->at, with all relations closed, in the units of its scaling.
 */
static double fastest(ns_newton *s) {
    const int n = s->n, all = s->n + s->m;
    const double ht = s->ht;
    double rate = 0;
    s->ht = s->hk = s->hg = 0;
    ns_newton_form(s);
    s->ht = s->hk = s->hg = ht;
    (void)ns_lu_factor(s->lu, all, s->G, NULL, NULL); /* for its scaling */
    const double *rows = ns_lu_rows(s->lu), *units = ns_lu_units(s->lu);
    for (int j = 0; j < all; j++) {
        int given = 0;
        for (int i = 0; i < all; i++)
            given |= s->G[i + j * all] != 0;
        for (int i = 0; i < s->rank && given; i++) {
            const double a = j < n ? s->A[i + j * n] + s->K[i + j * n] : s->B[i + (j - n) * n];
            rate = fmax(rate, rows[i] * fabs(a) * units[j]);
        }
    }
    return rate;
}

/* One implicit step of length h from charges s->xk. */
static int short_step(ns_newton *s, double h) {
    const ns_newton_options implicit = {.theta = 1, .gamma = 1};
    const double t1 = s->t + h;
    ns_newton_set(s, t1 > s->t ? t1 - s->t : h, t1, &implicit, t1 > s->t ? NS_LEFT : NS_RIGHT);
    memcpy(s->trial_mode, s->mode, (size_t)s->m);
    return ns_newton_loop(s);
}

/* v(0) from v(h) in last and v(h/2) in v; h as it came out. */
static void extrapolate(int count, double *v, const double *last) {
    for (int i = 0; i < count; i++)
        v[i] += v[i] - last[i];
}

/* s->at: (x, lambda, y) at t+0. */
static int limit(ns_newton *s, double h, double *last) {
    const int n = s->n, m = s->m;
    int status = short_step(s, h);
    if (status != NS_OK)
        return status;
    memcpy(last, s->at.x, sizeof(double) * (size_t)n);
    memcpy(last + n, s->at.lambda, sizeof(double) * (size_t)m);
    memcpy(last + n + m, s->at.y, sizeof(double) * (size_t)m);
    ns_mode *mode = (ns_mode *)(last + n + 2 * m);
    memcpy(mode, s->trial_mode, (size_t)m);
    status = short_step(s, h / 2);
    if (status != NS_OK || memcmp(mode, s->trial_mode, (size_t)m) != 0)
        return status;
    extrapolate(n, s->at.x, last);
    extrapolate(m, s->at.lambda, last + n);
    extrapolate(m, s->at.y, last + n + m);
    for (int i = 0; i < m; i++) {
        s->at.lambda[i] = fmin(fmax(s->at.lambda[i], s->model->l[i]), s->model->u[i]);
        if (s->model->l[i] < s->model->u[i] && s->at.y[i] * s->trial_mode[i] > 0)
            s->at.y[i] = 0; /* (S4) */
    }
    return status;
}

/* Both steps; s->xk is on loan. */
static int both(ns_newton *s, const double *before, double time, double *last) {
    int status = limit(s, ldexp(time, ACROSS), last);
    if (status != NS_OK)
        return status;
    memcpy(s->xk, s->at.x, sizeof(double) * (size_t)s->n);
    s->guess = before; /* what is left of the impulses is no place to start from */
    status = limit(s, ldexp(time, AFTER), last);
    s->guess = s->xk;
    return status;
}

int ns_newton_jump(ns_newton *s) {
    if (!s)
        return NS_E_NULL;
    s->has_trial = 0;
    if (!s->started)
        return ns_newton_fail(s, NS_E_STATE);
    static const ns_newton_options implicit = {.theta = 1, .gamma = 1};
    const size_t bytes = sizeof(double) * (size_t)s->n;
    double *before = s->spare;
    s->counts.trials++;
    s->fault.t = s->t;
    s->fault.npairs = s->fault.nunknowns = 0;
    ns_newton_set(s, 0, s->t, &implicit, NS_RIGHT);
    memcpy(s->at.x, s->xk, bytes);
    memcpy(s->at.lambda, s->lk, sizeof(double) * (size_t)s->m);
    if (ns_newton_jacobians(s, &s->at) != NS_OK)
        return ns_newton_fail(s, NS_DIVERGED);
    const double rate = fastest(s);
    memcpy(before, s->xk, bytes);
    int status = both(s, before, rate > 0 && isfinite(1 / rate) ? 1 / rate : 1, before + s->n);
    memcpy(s->xk, before, bytes);
    ns_newton_set(s, 0, s->t, &implicit, NS_RIGHT);
    if (status == NS_OK && ns_newton_values(s, &s->at) != NS_OK) /* r */
        status = NS_DIVERGED;
    if (status != NS_OK)
        return ns_newton_fail(s, status);
    s->has_trial = 1;
    return NS_OK;
}
