/* src/newton/jump.c - the impulse problem of a model: what a step with theta = gamma = 1 tends to as h
 * goes to 0.
 *
 * First a step of next to no length takes charges and fluxes across, w+ = M x+; what is impulsive in it grows
 * like 1/h and is dropped.  From w+, which is consistent, a second one finds x, lambda and y at t+.  Either
 * step is taken at h, h/2 and h/4 and extrapolated to 0, which leaves what is of third order in h.
 *
 * Lengths are exact, whatever t + h rounds to: powers of two.  Time stands still in the first step and goes
 * on in the second, where lambda may hang on the slopes of inputs; steps that t does not show have these from
 * a secant.
 */
#include <math.h>
#include <string.h>

#include "newton_internal.h"

/* Lengths against the fastest time constant: the first for conservation alone; the second also so long that
 * M (x - x_k)/h keeps digits. */
enum { ACROSS = -40, AFTER = -16 };
/* The secant, against t: some hundred of its last bits. */
enum { SECANT = -45 };

/* The fastest rate of the model linearised at s->at, with all relations closed: of A against M row by row, in
 * the units of the unknowns.  What only the differential rows know (impulses of it are what we look for) has
 * no say. */
static double fastest(ns_newton *s) {
    const int n = s->n, all = s->n + s->m;
    double rate = 0;
    s->ht = s->hk = s->hg = 0;
    ns_newton_form(s);
    (void)ns_linalg_lu_factor(s->lu, all, s->G, NULL, NULL); /* for its scaling */
    const double *units = ns_linalg_lu_units(s->lu);
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

/* What t does in a step of length h. */
typedef enum moving { STANDS, GOES_ON, BY_SECANT } moving;

static int t_shows(const ns_newton *s, double h) {
    return s->t + h - s->t == h;
}

/* The inputs at t + h by the secant from t. */
static void inputs_by_secant(ns_newton *s, double h) {
    const double wide = ldexp(fabs(s->t), SECANT), t2 = s->t + wide;
    for (int i = 0; i < s->model->nz; i++) {
        const double z = ns_signal_value(&s->model->z[i], s->t, NS_RIGHT),
                     z2 = ns_signal_value(&s->model->z[i], t2, NS_LEFT);
        s->z1[i] = s->zr[i] = z + h / (t2 - s->t) * (z2 - z);
    }
}

/* One implicit step of length h from charges s->xk; Newton starts from the point before the jump, for what is
 * left of impulses in xk is no place to. */
static int short_step(ns_newton *s, const double *before, double h, moving time) {
    const ns_newton_options implicit = {.theta = 1, .gamma = 1};
    ns_newton_set(s, h, time == GOES_ON ? s->t + h : s->t, &implicit, time == GOES_ON ? NS_LEFT : NS_RIGHT);
    if (time == BY_SECANT)
        inputs_by_secant(s, h);
    s->guess = before;
    memcpy(s->trial_mode, s->mode, (size_t)s->m);
    return ns_newton_loop(s);
}

/* v(0) from v(h), v(h/2) and v(h/4).  Where modes differ between these, lambda is next to 0 or to a bound and
 * x smooth nevertheless; what does not go as h goes is no such thing, and left. */
static double at_0(double whole, double half, double quarter, int same_modes) {
    const double first = whole - half, second = half - quarter;
    if (!same_modes && !(fabs(first - 2 * second) <= fabs(second)))
        return quarter;
    return quarter + (first - 5 * second) / 3;
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

/* s->at: (x, lambda, y) at t+0, from what three lengths gave. */
static void extrapolate(ns_newton *s, const double *whole, const double *half, const ns_mode *mode) {
    const int n = s->n, m = s->m;
    const ns_mode *modes[] = {mode, mode + m, s->trial_mode};
    const int same = memcmp(modes[0], modes[2], (size_t)m) == 0 && memcmp(modes[1], modes[2], (size_t)m) == 0;
    for (int i = 0; i < n; i++)
        s->at.x[i] = at_0(whole[i], half[i], s->at.x[i], same);
    for (int i = 0, j = n, k = n + m; i < m; i++, j++, k++) {
        if (modes[0][i] != modes[2][i] || modes[1][i] != modes[2][i])
            continue; /* (S4): that of h/4 */
        s->at.lambda[i] = at_0(whole[j], half[j], s->at.lambda[i], same);
        s->at.y[i] = at_0(whole[k], half[k], s->at.y[i], same);
    }
    put_back(s);
}

/* before: n, and room of 2 (n+2m) + m behind it. */
static int limit(ns_newton *s, double *before, double h, moving time) {
    double *room = before + s->n;
    const size_t m = (size_t)s->m, all = (size_t)s->n + 2 * m;
    ns_mode *mode = (ns_mode *)(room + 2 * all);
    for (int k = 0; k < 3; k++, h /= 2) {
        const int status = short_step(s, before, h, time);
        if (status != NS_OK)
            return status;
        if (k == 2)
            break;
        store(s, room + (size_t)k * all);
        memcpy(mode + (size_t)k * m, s->trial_mode, m);
    }
    extrapolate(s, room, room + all, mode);
    return NS_OK;
}

/* Both steps; s->xk is on loan. */
static int both(ns_newton *s, double *before, double time) {
    const double unit = ldexp(1, ilogb(time)), after = ldexp(unit, AFTER);
    int status = limit(s, before, ldexp(unit, ACROSS), STANDS);
    if (status != NS_OK)
        return status;
    memcpy(s->xk, s->at.x, sizeof(double) * (size_t)s->n);
    const int shown = t_shows(s, after) && t_shows(s, after / 2) && t_shows(s, after / 4);
    return limit(s, before, after, shown ? GOES_ON : BY_SECANT);
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
    int status = both(s, before, rate > 0 && isfinite(1 / rate) ? 1 / rate : 1);
    memcpy(s->xk, before, bytes);
    ns_newton_set(s, 0, s->t, &implicit, NS_RIGHT);
    if (status == NS_OK && ns_newton_values(s, &s->at) != NS_OK) /* r */
        status = NS_DIVERGED;
    if (status != NS_OK)
        return ns_newton_fail(s, status);
    s->has_trial = 1;
    return NS_OK;
}
