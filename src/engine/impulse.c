/* src/engine/impulse.c - the impulse problem (J1)-(J4): which mode it is.
 *
 * (P1) at some small h proposes one; that both levels of it (levels.c) satisfy (J4) proves it, whatever that
 * h was.
 */
#include "nonsmooth/impulse.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "levels.h"

/* Steps that propose a mode, against the fastest time constant; the shares of leaks (leak.h) with which each
 * is asked. */
static const int rungs[] = {-20, -8, -36, -52};
static const double shares[] = {0, 1e-7, 1e-9};
/* Rounding of a sum, of the sizes of its terms. */
static const double sum_eps = 16 * DBL_EPSILON;

/* y of pair j (S3) from (x, lambda) in v, or from their impulses (z and e play no part then).  *tol: what of
 * it may be rounding. */
static double y_of(const ns_levels *k, int j, const double *v, const double *z, double *tol) {
    const ns_system *s = k->s->s;
    const int n = s->n, m = s->m, finite = v == k->x;
    const double *off = finite ? k->Ex : k->EX;
    double sum = finite ? s->e[j] : 0, terms = fabs(sum), offs = 0;
    for (int i = 0; i < n + m; i++) {
        const double c = i < n ? s->C[j + i * m] : s->D[j + (i - n) * m];
        sum += c * v[i];
        terms += fabs(c * v[i]);
        offs += fabs(c) * off[i];
    }
    for (int c = 0; finite && c < s->nz; c++) {
        sum += s->F[j + c * m] * z[c];
        terms += fabs(s->F[j + c * m] * z[c]);
    }
    *tol = offs + sum_eps * terms;
    return sum;
}

/* lambda of pair j less a bound, likewise. */
static double lambda_of(const ns_levels *k, int j, double bound, double *tol) {
    const int n = k->s->s->n;
    *tol = k->Ex[n + j] + sum_eps * fabs(bound);
    return k->x[n + j] - bound;
}

/* An impulse and a finite value, read as one number. */
static int not_negative(double impulse, double tol, double value, double value_tol) {
    return impulse > tol || (impulse >= -tol && value >= -value_tol);
}

/* (J4) for pair j, inside. */
static int lambda_fits(const ns_levels *k, int j) {
    const double bound[2] = {k->s->l[j], k->s->u[j]};
    for (int side = 0; side < 2; side++) {
        double tol = 0;
        if (!isfinite(bound[side]))
            continue;
        const double sign = side ? -1 : 1, value = sign * lambda_of(k, j, bound[side], &tol);
        const int at = k->s->s->n + j;
        if (!not_negative(sign * k->X[at], k->EX[at], value, tol))
            return 0;
    }
    return 1;
}

/* (J4) */
static int fits(const ns_levels *k, const double *z) {
    const ns_theta *s = k->s;
    for (int j = 0; j < s->s->m; j++) {
        double tol1 = 0, tol0 = 0;
        const ns_mode mode = s->trial_mode[j];
        if (mode == NS_INSIDE) {
            if (!lambda_fits(k, j))
                return 0;
        } else if (s->l[j] < s->u[j]) {
            const double impulse = -mode * y_of(k, j, k->X, z, &tol1),
                         value = -mode * y_of(k, j, k->x, z, &tol0);
            if (!not_negative(impulse, tol1, value, tol0))
                return 0;
        }
    }
    return 1;
}

/* The mode in s->trial_mode, judged. */
static int judge(ns_levels *k, const double *z, const double *slope) {
    const int status = ns_levels_expand(k, z, slope);
    return status != NS_OK ? status : fits(k, z) ? NS_OK : NS_E_RESIDUAL;
}

/* (P1) of a step of length h, then its mode. */
static int propose(ns_levels *k, double h, double share, const double *z, const double *slope) {
    ns_theta *s = k->s;
    for (int i = 0; i < s->r; i++)
        s->trial_in[i] = s->w[i];
    for (int i = 0; i < s->s->nz; i++)
        s->trial_in[s->r + i] = z[i] + (slope ? h * slope[i] : 0);
    s->trial_in[s->q - 1] = 1;
    memcpy(s->trial_mode, s->mode, (size_t)s->s->m);
    const int status = ns_problem_solve(s, h, 1, share);
    return status == NS_OK ? judge(k, z, slope) : status;
}

/* From the mode that was to one that fits.  *h: what proposed it.  What a step was refused for stands when
 * nothing fits; that a problem without an answer has none at other lengths either is taken from two. */
static int search(ns_levels *k, const double *z, const double *slope, double *h) {
    ns_theta *s = k->s;
    const double rate = ns_levels_rate(k), time = rate > 0 && isfinite(1 / rate) ? 1 / rate : 1;
    int first = NS_OK, refused = 0;
    ns_fault fault = s->fault;
    *h = ldexp(time, rungs[0]);
    memcpy(s->trial_mode, s->mode, (size_t)s->s->m);
    int status = judge(k, z, slope);
    if (status == NS_OK || status == NS_E_MEMORY)
        return status;
    for (size_t t = 0; t < sizeof rungs / sizeof *rungs && refused < 2; t++) {
        *h = ldexp(time, rungs[t]);
        for (size_t i = 0; i < sizeof shares / sizeof *shares; i++) {
            s->fault.npairs = s->fault.nunknowns = 0;
            status = propose(k, *h, shares[i], z, slope);
            if (status == NS_OK || status == NS_E_MEMORY)
                return status;
            refused += i == 0 && status == NS_E_INFEASIBLE;
            if (first == NS_OK) {
                first = status;
                fault = s->fault;
            }
        }
    }
    s->fault = fault;
    return first;
}

static void copy(double *to, const double *from, int count) {
    if (to)
        memcpy(to, from, sizeof(double) * (size_t)count);
}

/* What a level's y is. */
static void copy_y(const ns_levels *k, const double *v, const double *z, double *y) {
    double tol;
    for (int j = 0; y && j < k->s->s->m; j++)
        y[j] = y_of(k, j, v, z, &tol);
}

static void hand_out_impulses(const ns_levels *k, const double *z, double h, const ns_impulse *out) {
    const int n = k->s->s->n, m = k->s->s->m;
    copy(out->X, k->X, n);
    copy(out->Lambda, k->X + n, m);
    copy_y(k, k->X, z, out->Y);
    if (out->h)
        *out->h = h;
}

static void hand_out_values(const ns_levels *k, const double *z, const ns_impulse *out) {
    const int n = k->s->s->n, m = k->s->s->m;
    copy(out->x, k->x, n);
    copy(out->lambda, k->x + n, m);
    copy_y(k, k->x, z, out->y);
    if (out->w)
        ns_matvec(n, n, k->s->s->M, k->x, out->w);
    if (out->mode)
        memcpy(out->mode, k->s->trial_mode, (size_t)m);
}

static int any_impulse(const ns_levels *k) {
    for (int i = 0; i < k->s->s->n + k->s->s->m; i++)
        if (k->X[i] != 0)
            return 1;
    return 0;
}

/* The past moves to t+, from which there is nothing to jump any more: a device that an impulse went through
 * need not go on conducting. */
static void move_on(ns_levels *k) {
    ns_theta *s = k->s;
    const int n = s->s->n;
    for (int i = 0; i < s->r; i++) {
        k->w[i] = k->terms_w[i] = 0;
        for (int j = 0; j < n; j++) {
            k->w[i] += (long double)s->M[i + j * n] * k->x[j];
            k->terms_w[i] += fabs(s->M[i + j * n] * k->x[j]);
        }
        s->w[i] = (double)k->w[i];
    }
    memcpy(k->guess, k->x, sizeof(double) * (size_t)n);
    memcpy(s->mode, s->trial_mode, (size_t)s->s->m);
}

/* Two problems: the jump, and what holds right after it.  Where the second finds no mode, for it stands on
 * charges that are good to rounding of what they were summed from, the finite level of the first is as good:
 * it is where a step ends. */
static int solve(ns_levels *k, double *past, const double *z, const double *slope, const ns_impulse *out) {
    double h = 0, again = 0;
    int status = search(k, z, slope, &h);
    if (status != NS_OK)
        return status;
    double *first = past + ns_theta_past_size(k->s);
    memcpy(first, k->X, sizeof(double) * ((size_t)k->s->s->n + (size_t)k->s->s->m));
    hand_out_values(k, z, out);
    if (any_impulse(k)) {
        ns_theta_save(k->s, past);
        move_on(k);
        status = search(k, z, slope, &again);
        ns_theta_restore(k->s, past);
        if (status == NS_OK)
            hand_out_values(k, z, out);
    }
    memcpy(k->X, first, sizeof(double) * ((size_t)k->s->s->n + (size_t)k->s->s->m));
    hand_out_impulses(k, z, h, out);
    return NS_OK;
}

int ns_theta_impulse(ns_theta *s, const double *z, const double *slope, const ns_impulse *out) {
    if (!s || !out || (!z && s->s->nz > 0))
        return NS_E_NULL;
    const size_t nz = (size_t)s->s->nz;
    if (!ns_finite(nz, z) || (slope && !ns_finite(nz, slope)))
        return ns_theta_fail(s, NS_E_NUMBER);
    ns_levels k;
    s->has_trial = 0;
    s->failed = 0; /* its place is used */
    int status = ns_levels_create(s, &k);
    double *past = calloc(ns_theta_past_size(s) + (size_t)s->s->n + (size_t)s->s->m + 1, sizeof *past);
    if (status == NS_OK)
        status = past ? solve(&k, past, z, slope, out) : NS_E_MEMORY;
    free(past);
    ns_levels_free(&k);
    return status == NS_OK ? NS_OK : ns_theta_fail(s, status);
}
