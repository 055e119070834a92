/* src/engine/newton_jump.c - the impulse problem of a model: what a step with theta = gamma = 1 tends to as h
 * goes to 0.
 *
 * First a step of next to no length takes charges and fluxes across, w+ = M x+; what is impulsive in it grows
 * like 1/h and is dropped.  From w+, which is consistent, a second one finds x, lambda and y at t+.  Either
 * step is taken at h, h/2 and h/4 and extrapolated to 0, which leaves what is of third order in h.
 */
#include <math.h>
#include <string.h>

#include "newton.h"

/* Lengths against the fastest time constant: the first for conservation alone; the second also so long that
 * M (x - x_k)/h keeps digits. */
enum { ACROSS = -40, AFTER = -16 };

/* The fastest rate of the model linearised at s->at, with all relations closed: of A against M row by row, in
 * the units of the unknowns.  What only the differential rows know (impulses of it are what we look for) has
 * no say. */
static double fastest(ns_newton *s) {
    const int n = s->n, all = s->n + s->m;
    double rate = 0;
    s->ht = s->hk = s->hg = 0;
    ns_newton_form(s);
    (void)ns_lu_factor(s->lu, all, s->G, NULL, NULL); /* for its scaling */
    const double *units = ns_lu_units(s->lu);
    for (int i = 0; i < s->rank; i++) {
        double most = 0, weight = 0;
        for (int j = 0; j < n; j++)
            weight = fmax(weight, fabs(s->M[i + j * n]) * units[j]);
        for (int j = 0; j < all; j++) {
            int given = 0;
            for (int k = 0; k < all; k++)
                given |= s->G[k + j * all] != 0;
            const double a = j < n ? s->A[i + j * n] + s->K[i + j * n] : s->B[i + (j - n) * n];
            most = fmax(most, given ? fabs(a) * units[j] : 0);
        }
        rate = fmax(rate, most / weight);
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

/* v(0) from v(h), v(h/2) and, in v, v(h/4). */
static void extrapolate(int count, double *v, const double *whole, const double *half) {
    for (int i = 0; i < count; i++)
        v[i] += (5 * (v[i] - half[i]) + (whole[i] - half[i])) / 3;
}

static void store(const ns_newton *s, double *point) {
    const size_t n = (size_t)s->n, m = (size_t)s->m;
    memcpy(point, s->at.x, sizeof(double) * n);
    memcpy(point + n, s->at.lambda, sizeof(double) * m);
    memcpy(point + n + m, s->at.y, sizeof(double) * m);
}

/* What extrapolation has taken beyond (S4), by rounding. */
static void put_back(ns_newton *s) {
    for (int i = 0; i < s->m; i++) {
        const double l = s->model->l[i], u = s->model->u[i];
        s->at.lambda[i] = fmin(fmax(s->at.lambda[i], l), u);
        if (l < u && s->at.y[i] * s->trial_mode[i] > 0)
            s->at.y[i] = 0;
    }
}

/* s->at: (x, lambda, y) at t+0.  room: 2 (n+2m) + m. */
static int limit(ns_newton *s, double h, double *room) {
    const int n = s->n, m = s->m;
    double *const whole = room, *const half = room + n + 2 * m;
    ns_mode *mode = (ns_mode *)(half + n + 2 * m);
    int status = short_step(s, h), same = 1;
    if (status != NS_OK)
        return status;
    store(s, whole);
    memcpy(mode, s->trial_mode, (size_t)m);
    if ((status = short_step(s, h / 2)) != NS_OK)
        return status;
    store(s, half);
    same = memcmp(mode, s->trial_mode, (size_t)m) == 0;
    if ((status = short_step(s, h / 4)) != NS_OK)
        return status;
    if (!same || memcmp(mode, s->trial_mode, (size_t)m) != 0)
        return NS_OK; /* h/4 must do */
    extrapolate(n, s->at.x, whole, half);
    extrapolate(m, s->at.lambda, whole + n, half + n);
    extrapolate(m, s->at.y, whole + n + m, half + n + m);
    put_back(s);
    return NS_OK;
}

/* Both steps; s->xk is on loan. */
static int both(ns_newton *s, const double *before, double time, double *room) {
    int status = limit(s, ldexp(time, ACROSS), room);
    if (status != NS_OK)
        return status;
    memcpy(s->xk, s->at.x, sizeof(double) * (size_t)s->n);
    s->guess = before; /* what is left of the impulses is no place to start from */
    status = limit(s, ldexp(time, AFTER), room);
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
