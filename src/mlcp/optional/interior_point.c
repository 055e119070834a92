/* src/mlcp/optional/interior_point.c - primal-dual interior point method for monotone problems, Mehrotra's
 * predictor first.
 *
 *   W x + q = v - w,   s = x - l > 0,  t = u - x > 0,   s v = mu,  t w = mu      (no v where l = -inf, no w
 *   where u = inf, neither where both are)
 *
 * A Newton step for these equations, with mu driven to 0, is one system
 *
 *   (W + diag(v/s + w/t)) dx = -(W x + q) + c/s - d/t,     c = sigma mu - corr_s,  d = sigma mu - corr_t
 *
 * followed by the longest step that keeps s, t, v, w positive.  (Mehrotra, SIAM J. Optim. 2 (1992); Wright,
 * "Primal-Dual Interior-Point Methods", ch. 10.)
 */
#include <math.h>
#include <string.h>

#include "mlcp/verify/residual.h"
#include "scaled.h"

enum { STEPS = 100 };
static const double KEEP = 0.995;  /* least part of the way to the nearest bound */
static const double FAR = 1e20;    /* products or slacks beyond this, in units of the problem: it diverges */
static const double CLOSE = 1e-5;  /* of the first mu: from here on a mode is worth trying */
static const double DONE = 1e-40;  /* of the first mu: pairs with lambda = y = 0 are then below 1e-20 */
static const double RCOND = 1e-14; /* a system worse than this is singular */
static const double RIDGE = 1e-10; /* added to the diagonal of free rows where the system is singular */
static const double STUCK = 1e-9;  /* a step this short, SHORTS times running: no way on */
enum { SHORTS = 6 };

/* One iterate, in the workspace. */
typedef struct iterate {
    ns_scaled *z;
    double *s, *t, *v, *w; /* m: slacks and multipliers, 1 where there is no such bound */
    double *ds, *dt, *dx;  /* m: products of the predictor, the step */
    int n;                 /* finite bounds */
    double mu;             /* mean of s v and t w */
} iterate;

static int has_lower(const iterate *p, int i) {
    int law = ns_mlcp_scaled_law(p->z, i);
    return law == NS_LAW_LOWER || law == NS_LAW_BOX;
}

static int has_upper(const iterate *p, int i) {
    int law = ns_mlcp_scaled_law(p->z, i);
    return law == NS_LAW_UPPER || law == NS_LAW_BOX;
}

static void set_mu(iterate *p) {
    double sum = 0.0;
    for (int i = 0; i < p->z->m; i++)
        sum += (has_lower(p, i) ? p->s[i] * p->v[i] : 0.0) + (has_upper(p, i) ? p->t[i] * p->w[i] : 0.0);
    p->mu = p->n > 0 ? sum / p->n : 0.0;
}

/* x at least 1 away from its bounds, or in the middle of a narrow box; multipliers as y has them, but at
 * least 1. */
static void set_first_point(ns_mlcp_solver *ws, ns_scaled *z, iterate *p) {
    *p = (iterate){.z = z, .s = z->work[0], .t = z->work[1], .v = z->work[2], .w = z->work[3]};
    p->dx = ws->g;
    p->ds = ws->ysize;
    p->dt = ws->lsize;
    for (int i = 0; i < z->m; i++) {
        double half = 0.5 * (z->u[i] - z->l[i]), by = fmin(1.0, half);
        if (ns_mlcp_scaled_law(z, i) != NS_LAW_FIXED)
            z->x[i] = fmin(fmax(z->x[i], z->l[i] + by), z->u[i] - by);
    }
    ns_mlcp_scaled_product(z);
    for (int i = 0; i < z->m; i++) {
        int lower = has_lower(p, i), upper = has_upper(p, i);
        p->n += lower + upper;
        p->s[i] = lower ? z->x[i] - z->l[i] : 1.0;
        p->t[i] = upper ? z->u[i] - z->x[i] : 1.0;
        p->v[i] = lower ? fmax(1.0, z->y[i]) : 0.0;
        p->w[i] = upper ? fmax(1.0, -z->y[i]) : 0.0;
    }
    set_mu(p);
}

/* W + diag(v/s + w/t) into G, and its factors. */
static int factor_system(ns_mlcp_solver *ws, const iterate *p, double ridge) {
    const ns_scaled *z = p->z;
    size_t m = (size_t)z->m;
    memcpy(ws->G, z->W, m * m * sizeof *ws->G);
    for (size_t i = 0; i < m; i++) {
        int law = ns_mlcp_scaled_law(z, (int)i);
        ws->G[i + i * m] += p->v[i] / p->s[i] + p->w[i] / p->t[i] + (law == NS_LAW_FREE ? ridge : 0.0);
        if (law != NS_LAW_FIXED)
            continue;
        for (size_t j = 0; j < m; j++)
            ws->G[i + j * m] = ws->G[j + i * m] = i == j ? 1.0 : 0.0;
    }
    double rcond;
    int status = ns_mlcp_basis_factor_of(ws, z->m, ws->G, &rcond);
    return status == NS_OK && ridge == 0.0 && !(rcond > RCOND) ? NS_E_SINGULAR : status;
}

/* dx for s v = t w = target, the products of the predictor taken off where second. */
static void solve_direction(const ns_mlcp_solver *ws, iterate *p, double target, int second) {
    const ns_scaled *z = p->z;
    for (int i = 0; i < z->m; i++) {
        double b = -z->y[i];
        if (has_lower(p, i))
            b += (target - (second ? p->ds[i] : 0.0)) / p->s[i];
        if (has_upper(p, i))
            b -= (target - (second ? p->dt[i] : 0.0)) / p->t[i];
        p->dx[i] = ns_mlcp_scaled_law(z, i) == NS_LAW_FIXED ? 0.0 : b;
    }
    ns_linalg_lu_solve(ws->lu, 1, p->dx);
}

/* Changes of v and w that go with dx. */
static double change_v(const iterate *p, int i, double target, int second) {
    return (target - (second ? p->ds[i] : 0.0) - p->v[i] * p->dx[i]) / p->s[i] - p->v[i];
}

static double change_w(const iterate *p, int i, double target, int second) {
    return (target - (second ? p->dt[i] : 0.0) + p->w[i] * p->dx[i]) / p->t[i] - p->w[i];
}

static double step_to_zero(double value, double change, double most) {
    return change < 0.0 ? fmin(most, -value / change) : most;
}

/* The longest step that keeps all positive; nothing asks for more than 2. */
static double longest_step(const iterate *p, double target, int second) {
    double most = 2.0;
    for (int i = 0; i < p->z->m; i++) {
        if (has_lower(p, i)) {
            most = step_to_zero(p->s[i], p->dx[i], most);
            most = step_to_zero(p->v[i], change_v(p, i, target, second), most);
        }
        if (has_upper(p, i)) {
            most = step_to_zero(p->t[i], -p->dx[i], most);
            most = step_to_zero(p->w[i], change_w(p, i, target, second), most);
        }
    }
    return most;
}

/* mu after the whole predictor; its products into ds and dt. */
static double predict_mu(iterate *p, double step) {
    double sum = 0.0;
    for (int i = 0; i < p->z->m; i++) {
        double dx = p->dx[i];
        if (has_lower(p, i)) {
            double dv = change_v(p, i, 0.0, 0);
            sum += (p->s[i] + step * dx) * (p->v[i] + step * dv);
            p->ds[i] = dx * dv;
        }
        if (has_upper(p, i)) {
            double dw = change_w(p, i, 0.0, 0);
            sum += (p->t[i] - step * dx) * (p->w[i] + step * dw);
            p->dt[i] = -dx * dw;
        }
    }
    return p->n > 0 ? sum / p->n : 0.0;
}

static void move_point(iterate *p, double step, double target) {
    ns_scaled *z = p->z;
    for (int i = 0; i < z->m; i++) {
        double dx = p->dx[i];
        if (has_lower(p, i)) {
            double dv = change_v(p, i, target, 1);
            p->s[i] += step * dx;
            p->v[i] += step * dv;
        }
        if (has_upper(p, i)) {
            double dw = change_w(p, i, target, 1);
            p->t[i] -= step * dx;
            p->w[i] += step * dw;
        }
        z->x[i] += step * dx;
    }
    ns_mlcp_scaled_product(z);
    set_mu(p);
}

/* One step; its length, 0 where there is none. */
static double take_step(ns_mlcp_solver *ws, iterate *p) {
    if (factor_system(ws, p, 0.0) != NS_OK && factor_system(ws, p, RIDGE) != NS_OK)
        return 0.0;
    solve_direction(ws, p, 0.0, 0);
    double step = fmin(1.0, longest_step(p, 0.0, 0)), ahead = predict_mu(p, step);
    double sigma = p->mu > 0.0 ? pow(fmin(ahead / p->mu, 1.0), 3.0) : 0.0;
    double target = sigma * p->mu;
    solve_direction(ws, p, target, 1);
    step = fmin(1.0, KEEP * longest_step(p, target, 1));
    if (!(step > 0.0))
        return 0.0;
    move_point(p, step, target);
    return step;
}

/* The mode that the iterate tends to: of slack and multiplier the smaller goes to 0. */
static int finish_in_mode(ns_mlcp_solver *ws, const iterate *p) {
    double *y = p->z->work[4];
    for (int i = 0; i < p->z->m; i++)
        y[i] = p->v[i] - p->w[i];
    return ns_mlcp_scaled_finish(ws, p->z, p->z->x, y);
}

int ns_mlcp_interior(ns_mlcp_solver *s) {
    ns_scaled z;
    iterate p;
    int shorts = 0, status = NS_E_LIMIT;
    ns_mlcp_scaled_load(s, &z);
    set_first_point(s, &z, &p);
    double first = p.mu, next = CLOSE * first;
    for (int k = 0; k < STEPS; k++) {
        double step = take_step(s, &p);
        s->iterations++;
        shorts = step < STUCK ? shorts + 1 : 0;
        if (shorts >= SHORTS || p.mu < DONE * first || !(step > 0.0) || !isfinite(p.mu) || p.mu > FAR * first)
            break;
        if (p.mu > next)
            continue;
        status = finish_in_mode(s, &p);
        if (status == NS_OK)
            return NS_OK;
        next = fmin(1e-2 * next, p.mu);
    }
    return isfinite(p.mu) ? finish_in_mode(s, &p) : NS_E_LIMIT;
}
