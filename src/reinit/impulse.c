/* src/reinit/impulse.c - the impulse problem (J1)-(J4): which mode it is.
 *
 * (P1) at some small h proposes one; that both levels of it (order_expansion.c) satisfy (J4) proves it,
 * whatever that h was.
 */
#include "nonsmooth/impulse.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "order_expansion.h"

/* Steps that propose a mode, against the fastest time constant; the shares of leaks (modes/regularise.h) with
 * which each is asked. */
static const int rungs[] = {-20, -8, -36, -52};
static const double shares[] = {0, 1e-7, 1e-9};
/* Rounding of a sum, of the sizes of its terms. */
static const double sum_eps = 16 * DBL_EPSILON;

/* y of pair j (S3) from one of the levels of (x, lambda); z: inputs of that level (NULL: none).  *tol: what
 * of it may be rounding. */
static double y_of(const ns_order_expansion *k, int j, int level, const double *z, double *tol) {
    const ns_system *s = k->s->s;
    const int n = s->n, m = s->m;
    const double *v = k->at[level], *off = k->off[level];
    double sum = level == NS_VALUE ? s->e[j] : 0, terms = fabs(sum), offs = 0;
    for (int i = 0; i < n + m; i++) {
        const double c = i < n ? s->C[j + i * m] : s->D[j + (i - n) * m];
        sum += c * v[i];
        terms += fabs(c * v[i]);
        offs += fabs(c) * off[i];
    }
    for (int c = 0; z && c < s->nz; c++) {
        sum += s->F[j + c * m] * z[c];
        terms += fabs(s->F[j + c * m] * z[c]);
    }
    *tol = offs + sum_eps * terms;
    return sum;
}

/* lambda of pair j less a bound, likewise. */
static double lambda_of(const ns_order_expansion *k, int j, int level, double bound, double *tol) {
    const int at = k->s->s->n + j;
    const double from = level == NS_VALUE ? bound : 0;
    *tol = k->off[level][at] + sum_eps * fabs(from);
    return k->at[level][at] - from;
}

/* An impulse, a value and a rate, read as one number: -1, 0, 1. */
static int sign_of(const ns_order_expansion *k, const double *number, const double *tol) {
    for (int level = 0; level < k->orders; level++)
        if (!(fabs(number[level]) <= tol[level]))
            return number[level] > 0 ? 1 : -1;
    return 0;
}

/* (J4) for pair j, inside. */
static int lambda_fits(const ns_order_expansion *k, int j) {
    const double bound[2] = {k->s->l[j], k->s->u[j]};
    for (int side = 0; side < 2; side++) {
        double number[3] = {0}, tol[3] = {0};
        for (int level = 0; level < 3; level++)
            number[level] = lambda_of(k, j, level, bound[side], &tol[level]);
        if (isfinite(bound[side]) && sign_of(k, number, tol) == (side ? 1 : -1))
            return 0;
    }
    return 1;
}

/* (J4) for pair j, at a bound. */
static int y_fits(const ns_order_expansion *k, int j, const double *z, const double *slope) {
    const double *const inputs[] = {NULL, z, slope};
    double number[3] = {0}, tol[3] = {0};
    for (int level = 0; level < 3; level++)
        number[level] = y_of(k, j, level, inputs[level], &tol[level]);
    return sign_of(k, number, tol) != k->s->trial_mode[j];
}

/* (J4) */
static int fits(const ns_order_expansion *k, const double *z, const double *slope) {
    const ns_theta *s = k->s;
    for (int j = 0; j < s->s->m; j++) {
        const int inside = s->trial_mode[j] == NS_INSIDE, open = s->l[j] < s->u[j];
        if (inside ? !lambda_fits(k, j) : open && !y_fits(k, j, z, slope))
            return 0;
    }
    return 1;
}

/* The mode in s->trial_mode, judged. */
static int judge(ns_order_expansion *k, const double *z, const double *slope) {
    const int status = ns_reinit_orders_expand(k, z, slope);
    return status != NS_OK ? status : fits(k, z, slope) ? NS_OK : NS_E_RESIDUAL;
}

/* (P1) of a step of length h, then its mode. */
static int propose(ns_order_expansion *k, double h, double share, const double *z, const double *slope) {
    ns_theta *s = k->s;
    for (int i = 0; i < s->r; i++)
        s->trial_in[i] = s->w[i];
    for (int i = 0; i < s->s->nz; i++)
        s->trial_in[s->r + i] = z[i] + (slope ? h * slope[i] : 0);
    s->trial_in[s->q - 1] = 1;
    memcpy(s->trial_mode, s->mode, (size_t)s->s->m);
    const int status = ns_theta_lcp_solve(s, h, 1, share);
    return status == NS_OK ? judge(k, z, slope) : status;
}

/* The first length to propose a mode with. */
static double first_step(ns_order_expansion *k) {
    const double rate = ns_reinit_orders_rate(k), time = rate > 0 && isfinite(1 / rate) ? 1 / rate : 1;
    return ldexp(time, rungs[0]);
}

/* From the mode that was to one that fits.  *h (NULL: not asked for): what proposed it.  When nothing fits,
 * what the first step was refused for stands, or that one has no answer (lengths beyond the second lose too
 * many digits to tell); that there is none at other lengths either is taken from two. */
static int search_with(ns_order_expansion *k, const double *z, const double *slope, double *h) {
    ns_theta *s = k->s;
    int first = NS_OK, refused = 0;
    ns_fault fault = s->fault;
    double step = h ? first_step(k) : 0;
    if (h)
        *h = step;
    memcpy(s->trial_mode, s->mode, (size_t)s->s->m);
    int status = judge(k, z, slope);
    if (status == NS_OK || status == NS_E_MEMORY)
        return status;
    if (!h)
        step = first_step(k);
    for (size_t t = 0; t < sizeof rungs / sizeof *rungs && refused < 2; t++) {
        const double length = ldexp(step, rungs[t] - rungs[0]);
        if (h)
            *h = length;
        for (size_t i = 0; i < sizeof shares / sizeof *shares; i++) {
            s->fault.npairs = s->fault.nunknowns = 0;
            status = propose(k, length, shares[i], z, slope);
            if (status == NS_OK || status == NS_E_MEMORY)
                return status;
            const int none = i == 0 && status == NS_E_INFEASIBLE;
            refused += none;
            if (first == NS_OK || (none && t < 2)) {
                first = status;
                fault = s->fault;
            }
        }
    }
    s->fault = fault;
    return first;
}

/* Where no mode's rates fit (they take two more orders, of which rounding may leave nothing), values must do.
 */
static int search(ns_order_expansion *k, const double *z, const double *slope, double *h) {
    k->orders = 3;
    int status = search_with(k, z, slope, h);
    if (status == NS_E_RESIDUAL) {
        k->orders = 2;
        status = search_with(k, z, slope, h);
    }
    return status;
}

static void copy(double *to, const double *from, int count) {
    if (to)
        memcpy(to, from, sizeof(double) * (size_t)count);
}

/* What a level's y is. */
static void copy_y(const ns_order_expansion *k, int level, const double *z, double *y) {
    double tol;
    for (int j = 0; y && j < k->s->s->m; j++)
        y[j] = y_of(k, j, level, z, &tol);
}

/* A level of x, lambda, y. */
static void hand_out(const ns_order_expansion *k, int level, const double *z, double *x, double *lambda,
                     double *y) {
    const int n = k->s->s->n, m = k->s->s->m;
    copy(x, k->at[level], n);
    copy(lambda, k->at[level] + n, m);
    copy_y(k, level, z, y);
}

static void hand_out_values(const ns_order_expansion *k, const double *z, const ns_impulse *out) {
    const int n = k->s->s->n, m = k->s->s->m;
    hand_out(k, NS_VALUE, z, out->x, out->lambda, out->y);
    if (out->w)
        ns_linalg_matvec(n, n, k->s->s->M, k->at[NS_VALUE], out->w);
    if (out->mode)
        memcpy(out->mode, k->s->trial_mode, (size_t)m);
}

static int any_impulse(const ns_order_expansion *k) {
    for (int i = 0; i < k->s->s->n + k->s->s->m; i++)
        if (k->at[NS_IMPULSE][i] != 0)
            return 1;
    return 0;
}

/* An impulse was what (J4) judged a pair by: from t+ on it may be in another mode. */
static int any_judged_by_impulse(const ns_order_expansion *k) {
    const ns_theta *s = k->s;
    double tol = 0;
    for (int j = 0; j < s->s->m; j++) {
        if (!(s->l[j] < s->u[j]) || (isinf(s->l[j]) && isinf(s->u[j])))
            continue;
        if (k->at[NS_IMPULSE][s->s->n + j] != 0 || fabs(y_of(k, j, NS_IMPULSE, NULL, &tol)) > tol)
            return 1;
    }
    return 0;
}

/* The past moves to t+, from which there is nothing to jump any more: a device that an impulse went through
 * need not go on conducting. */
static void move_on(ns_order_expansion *k) {
    ns_theta *s = k->s;
    const int n = s->s->n;
    const double *x = k->at[NS_VALUE];
    for (int i = 0; i < s->r; i++) {
        k->w[i] = k->terms_w[i] = 0;
        for (int j = 0; j < n; j++) {
            k->w[i] += (long double)s->M[i + j * n] * x[j];
            k->terms_w[i] += fabs(s->M[i + j * n]) * (fabs(x[j]) + k->off[NS_VALUE][j]);
        }
        s->w[i] = (double)k->w[i];
    }
    memcpy(k->guess, x, sizeof(double) * (size_t)n);
    memcpy(s->mode, s->trial_mode, (size_t)s->s->m);
}

/* What holds right after the jump.  Where that finds no mode, for it stands on charges that are good to
 * rounding of what they were summed from, the values of the jump are as good: they are where a step ends.
 * room: a past, 2 (n+m) and m modes. */
static int after(ns_order_expansion *k, const double *z, const double *slope, double *room) {
    ns_theta *s = k->s;
    const size_t all = (size_t)s->s->n + (size_t)s->s->m, bytes = sizeof(double) * all, m = (size_t)s->s->m;
    double *impulse = room + ns_theta_past_size(s), *value = impulse + all;
    ns_mode *mode = (ns_mode *)(value + all);
    memcpy(impulse, k->at[NS_IMPULSE], bytes);
    memcpy(value, k->at[NS_VALUE], bytes);
    memcpy(mode, s->trial_mode, m);
    ns_theta_save(s, room);
    move_on(k);
    const int status = search(k, z, slope, NULL);
    ns_theta_restore(s, room);
    memcpy(k->at[NS_IMPULSE], impulse, bytes);
    if (status != NS_OK) {
        memcpy(k->at[NS_VALUE], value, bytes);
        memcpy(s->trial_mode, mode, m);
    }
    return status == NS_E_MEMORY ? status : NS_OK;
}

static int solve(ns_order_expansion *k, const double *z, const double *slope, double *room,
                 const ns_impulse *out, int *jumps) {
    double h = 0;
    int status = search(k, z, slope, out->h ? &h : NULL);
    *jumps = status == NS_OK && any_impulse(k);
    if (*jumps && any_judged_by_impulse(k))
        status = after(k, z, slope, room);
    if (status != NS_OK)
        return status;
    hand_out_values(k, z, out);
    hand_out(k, NS_IMPULSE, NULL, out->X, out->Lambda, out->Y);
    if (out->h)
        *out->h = h;
    return NS_OK;
}

int ns_reinit_impulse_solve(ns_theta *s, const double *z, const double *slope, const double *open,
                            const ns_impulse *out, int *jumps) {
    ns_order_expansion k;
    s->has_trial = 0;
    s->failed = 0; /* its place is used */
    int status = ns_reinit_orders_create(s, &k);
    k.open = open;
    double *room =
        calloc(ns_theta_past_size(s) + 2 * (size_t)s->s->n + 3 * (size_t)s->s->m + 1, sizeof *room);
    if (status == NS_OK)
        status = room ? solve(&k, z, slope, room, out, jumps) : NS_E_MEMORY;
    free(room);
    ns_reinit_orders_free(&k);
    return status == NS_OK ? NS_OK : ns_theta_fail(s, status);
}

int ns_theta_impulse(ns_theta *s, const double *z, const double *slope, const ns_impulse *out) {
    if (!s || !out || (!z && s->s->nz > 0))
        return NS_E_NULL;
    const size_t nz = (size_t)s->s->nz;
    int jumps;
    if (!ns_linalg_finite(nz, z) || (slope && !ns_linalg_finite(nz, slope)))
        return ns_theta_fail(s, NS_E_NUMBER);
    return ns_reinit_impulse_solve(s, z, slope, NULL, out, &jumps);
}
