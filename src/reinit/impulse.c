/* src/reinit/impulse.c - the impulse problem (J1)-(J4): which mode it is.
 *
 * (P1) at some small h proposes one; that impulses, values and rates in it (order_expansion.c) satisfy (J4)
 * proves it, whatever that h was.
 */
#include "impulse.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "events/guard.h"
#include "order_expansion.h"

/* Steps that propose a mode: log2 of their lengths against the fastest time constant; the fractions of leaks
 * (theta/regularise.h) that each is tried with. */
static const int length_exponents[] = {-20, -8, -36, -52};
static const double fractions[] = {0, 1e-7};
/* Rounding of a sum, of the sizes of its terms. */
static const double sum_eps = 16 * DBL_EPSILON;

/* y of pair j (S3) from one of the orders of (x, lambda); z: inputs of that order (NULL: none).  *tol: by how
 * much it may be off. */
static double y_of(const ns_order_expansion *k, int j, int order, const double *z, double *tol) {
    const ns_system *s = k->s->s;
    const int n = s->n, m = s->m;
    const double *v = k->at[order], *error = k->error[order];
    double sum = order == NS_VALUE ? s->e[j] : 0, terms = fabs(sum), errors = 0;
    for (int i = 0; i < n + m; i++) {
        const double c = i < n ? s->C[j + i * m] : s->D[j + (i - n) * m];
        sum += c * v[i];
        terms += fabs(c * v[i]);
        errors += fabs(c) * error[i];
    }
    for (int c = 0; z && c < s->nz; c++) {
        sum += s->F[j + c * m] * z[c];
        terms += fabs(s->F[j + c * m] * z[c]);
    }
    *tol = errors + sum_eps * terms;
    return sum;
}

/* lambda of pair j less a bound, likewise. */
static double lambda_of(const ns_order_expansion *k, int j, int order, double bound, double *tol) {
    const int at = k->s->s->n + j;
    const double from = order == NS_VALUE ? bound : 0;
    *tol = k->error[order][at] + sum_eps * fabs(from);
    return k->at[order][at] - from;
}

/* (J4) for pair j, inside. */
static int lambda_satisfies(const ns_order_expansion *k, int j) {
    const double bound[2] = {k->s->l[j], k->s->u[j]};
    for (int side = 0; side < 2; side++) {
        double number[3] = {0}, tol[3] = {0};
        for (int order = 0; order < 3; order++)
            number[order] = lambda_of(k, j, order, bound[side], &tol[order]);
        if (isfinite(bound[side]) && ns_events_sign(k->orders, number, tol) == (side ? 1 : -1))
            return 0;
    }
    return 1;
}

/* (J4) for pair j, at a bound. */
static int y_satisfies(const ns_order_expansion *k, int j, const double *z, const double *slope) {
    const double *const inputs[] = {NULL, z, slope};
    double number[3] = {0}, tol[3] = {0};
    for (int order = 0; order < 3; order++)
        number[order] = y_of(k, j, order, inputs[order], &tol[order]);
    return ns_events_sign(k->orders, number, tol) != k->mode[j];
}

/* (J4) */
static int satisfies_laws(const ns_order_expansion *k, const double *z, const double *slope) {
    const ns_theta *s = k->s;
    for (int j = 0; j < s->s->m; j++) {
        const int inside = k->mode[j] == NS_INSIDE, one_sided = s->l[j] < s->u[j];
        if (inside ? !lambda_satisfies(k, j) : one_sided && !y_satisfies(k, j, z, slope))
            return 0;
    }
    return 1;
}

/* OK if k->mode satisfies (J4), else RESIDUAL. */
static int judge_mode(ns_order_expansion *k, const double *z, const double *slope) {
    const int status = ns_reinit_orders_expand(k, z, slope);
    return status != NS_OK ? status : satisfies_laws(k, z, slope) ? NS_OK : NS_E_RESIDUAL;
}

/* The mode of (P1) of a step of length h, judged. */
static int try_mode_of_step(ns_order_expansion *k, double h, double fraction, const double *z,
                            const double *slope) {
    for (int i = 0; i < k->s->r; i++)
        k->v[i] = (double)k->w[i];
    memcpy(k->mode, k->left_mode, (size_t)k->s->s->m);
    const int status = ns_theta_lcp_propose(k->s, h, fraction, k->v, z, slope, k->mode);
    return status == NS_OK ? judge_mode(k, z, slope) : status;
}

/* The first length to propose a mode with. */
static double first_step(ns_order_expansion *k) {
    const double rate = ns_reinit_orders_rate(k), time = rate > 0 && isfinite(1 / rate) ? 1 / rate : 1;
    return ldexp(time, length_exponents[0]);
}

/* k->mode: the mode before the jump if it satisfies (J4), else the first one proposed that does.  *h (NULL:
 * not asked for): length of the step that proposed it.  If none does: the error of the first step, or that it
 * has no answer (lengths beyond the second lose too many digits to show that); two lengths without an answer
 * are enough to say that there is none. */
static int search_with(ns_order_expansion *k, const double *z, const double *slope, double *h) {
    ns_theta *s = k->s;
    int first = NS_OK, refused = 0;
    ns_fault fault = s->fault;
    double step = h ? first_step(k) : 0;
    if (h)
        *h = step;
    memcpy(k->mode, k->left_mode, (size_t)s->s->m);
    int status = judge_mode(k, z, slope);
    if (status == NS_OK || status == NS_E_MEMORY)
        return status;
    if (!h)
        step = first_step(k);
    for (size_t t = 0; t < sizeof length_exponents / sizeof *length_exponents && refused < 2; t++) {
        const double length = ldexp(step, length_exponents[t] - length_exponents[0]);
        if (h)
            *h = length;
        for (size_t i = 0; i < sizeof fractions / sizeof *fractions; i++) {
            s->fault.npairs = s->fault.nunknowns = 0;
            status = try_mode_of_step(k, length, fractions[i], z, slope);
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

/* If no mode's rates satisfy (J4), impulses and values alone decide: rates take two more orders, of which
 * rounding may leave nothing. */
static int find_mode(ns_order_expansion *k, const double *z, const double *slope, double *h) {
    k->orders = 3;
    int status = search_with(k, z, slope, h);
    if (status == NS_E_RESIDUAL) {
        k->orders = 2;
        status = search_with(k, z, slope, h);
    }
    return status;
}

static void copy_out(double *to, const double *from, int count) {
    if (to)
        memcpy(to, from, sizeof(double) * (size_t)count);
}

/* One order of x, lambda, y. */
static void copy_order(const ns_order_expansion *k, int order, const double *z, double *x, double *lambda,
                       double *y) {
    const int n = k->s->s->n, m = k->s->s->m;
    double tol;
    copy_out(x, k->at[order], n);
    copy_out(lambda, k->at[order] + n, m);
    for (int j = 0; y && j < m; j++)
        y[j] = y_of(k, j, order, z, &tol);
}

static void copy_answer(const ns_order_expansion *k, const double *z, const ns_impulse *out) {
    const int n = k->s->s->n;
    copy_order(k, NS_VALUE, z, out->x, out->lambda, out->y);
    copy_order(k, NS_IMPULSE, NULL, out->X, out->Lambda, out->Y);
    if (out->w)
        ns_linalg_matvec(n, n, k->s->s->M, k->at[NS_VALUE], out->w);
    if (out->mode)
        memcpy(out->mode, k->mode, (size_t)k->s->s->m);
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

/* The left side becomes what was the right side. */
static void begin_at_right_side(ns_order_expansion *k) {
    const ns_theta *s = k->s;
    const int n = s->s->n;
    const double *x = k->at[NS_VALUE];
    for (int i = 0; i < s->r; i++) {
        k->w[i] = k->terms_w[i] = 0;
        for (int j = 0; j < n; j++) {
            k->w[i] += (long double)s->M[i + j * n] * x[j];
            k->terms_w[i] += fabs(s->M[i + j * n]) * (fabs(x[j]) + k->error[NS_VALUE][j]);
        }
    }
    memcpy(k->guess, x, sizeof(double) * (size_t)n);
    memcpy(k->left_mode, k->mode, (size_t)s->s->m);
}

static void exchange(double **a, double **b) {
    double *was = *a;
    *a = *b;
    *b = was;
}

/* The mode and values right after a jump: a device that an impulse went through need not conduct any longer.
 * If no mode is found (its charges are exact only to the rounding of the terms they were summed from) those
 * of the jump stay. */
static int find_mode_after(ns_order_expansion *k, const double *z, const double *slope) {
    begin_at_right_side(k);
    exchange(&k->at[NS_IMPULSE], &k->jump[0]);
    exchange(&k->at[NS_VALUE], &k->jump[1]);
    const int status = find_mode(k, z, slope, NULL);
    exchange(&k->at[NS_IMPULSE], &k->jump[0]);
    if (status != NS_OK) {
        exchange(&k->at[NS_VALUE], &k->jump[1]);
        memcpy(k->mode, k->left_mode, (size_t)k->s->s->m);
    }
    return status == NS_E_MEMORY ? status : NS_OK;
}

static int solve_jump(ns_order_expansion *k, const double *z, const double *slope, const ns_impulse *out,
                      int *jumps) {
    double h = 0;
    int status = find_mode(k, z, slope, out->h ? &h : NULL);
    *jumps = status == NS_OK && any_impulse(k);
    if (*jumps && any_judged_by_impulse(k))
        status = find_mode_after(k, z, slope);
    if (status != NS_OK)
        return status;
    copy_answer(k, z, out);
    if (out->h)
        *out->h = h;
    return NS_OK;
}

int ns_reinit_impulse_solve(ns_theta *s, const double *z, const double *slope, const double *near,
                            const ns_impulse *out, int *jumps) {
    ns_order_expansion k;
    ns_theta_discard(s);
    int status = ns_reinit_orders_create(s, s->past.w, &k);
    k.near = near;
    if (status == NS_OK)
        status = solve_jump(&k, z, slope, out, jumps);
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
