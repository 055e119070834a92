/* src/newton/jump.c - the impulse problem of a model: what a step with theta = gamma = 1 tends to as h
 * goes to 0.
 *
 * First a step of negligible length takes charges and fluxes across, w+ = M x+; what is impulsive in it grows
 * like 1/h and is dropped.  From w+, which is consistent, a second one finds x, lambda and y at t+.  Either
 * step is taken at h, h/2 and h/4 and extrapolated to 0, which leaves what is of third order in h.
 *
 * Lengths are exact, whatever t + h rounds to: powers of two.  Time stands still in the first step and
 * moves in the second, where lambda may depend on the slopes of inputs; steps shorter than the last bits of t
 * take these from a secant.
 */
#include <math.h>
#include <string.h>

#include "newton_internal.h"

/* Lengths against the fastest time constant: the first for conservation alone; the second also so long that
 * M (x - x_k)/h keeps digits. */
enum { ACROSS = -40, AFTER = -16 };
/* The secant, against t: some hundred of its last bits. */
enum { SECANT = -45 };

static const ns_newton_options implicit = {.theta = 1, .gamma = 1};

/* The fastest rate of the model linearised at s->at, with all relations closed: of A against M row by row, in
 * the units of the unknowns.  Unknowns that only differential rows contain do not count: impulses of these
 * are what we look for.  The step at hand has h = 0. */
static double fastest_rate(ns_newton *s) {
    const int n = s->n, all = s->n + s->m;
    double rate = 0;
    ns_newton_form(s);
    (void)ns_linalg_lu_scale(s->lu, all, s->G);
    const double *units = ns_linalg_lu_units(s->lu);
    for (int i = 0; i < s->rank; i++) {
        double flow = 0, weight = 0;
        for (int j = 0; j < n; j++)
            weight = fmax(weight, fabs(s->M[i + j * n]) * units[j]);
        for (int j = 0; j < all; j++) {
            int given = 0;
            for (int k = 0; k < all; k++)
                given |= s->G[k + j * all] != 0;
            const double a = j < n ? s->A[i + j * n] + s->K[i + j * n] : s->B[i + (j - n) * n];
            flow = fmax(flow, given ? fabs(a) * units[j] : 0);
        }
        rate = fmax(rate, flow / weight);
    }
    return rate;
}

/* Time in a step of length h. */
typedef enum time_of_step {
    TIME_STANDS,     /* t */
    TIME_MOVES,      /* t + h */
    INPUTS_BY_SECANT /* t, but for inputs at t + h by their slopes */
} time_of_step;

static int t_resolves(const ns_newton *s, double h) {
    return s->t + h - s->t == h;
}

/* The inputs at t + h by the secant from t. */
static void set_inputs_by_secant(ns_newton *s, double h) {
    const double wide = ldexp(fabs(s->t), SECANT), t2 = s->t + wide;
    for (int i = 0; i < s->model->nz; i++) {
        const double z = ns_signal_value(&s->model->z[i], s->t, NS_RIGHT),
                     z2 = ns_signal_value(&s->model->z[i], t2, NS_LEFT);
        s->z1[i] = s->zr[i] = z + h / (t2 - s->t) * (z2 - z);
    }
}

/* One implicit step of length h from the charges of `from`; Newton starts at x_k, before the jump: what is
 * left of impulses in `from` is no place to start at. */
static int short_step(ns_newton *s, const double *from, double h, time_of_step time) {
    const int moves = time == TIME_MOVES;
    ns_newton_set(s, h, moves ? s->t + h : s->t, &implicit, moves ? NS_LEFT : NS_RIGHT);
    if (time == INPUTS_BY_SECANT)
        set_inputs_by_secant(s, h);
    s->from = from;
    memcpy(s->trial_mode, s->mode, (size_t)s->m);
    return ns_newton_loop(s);
}

/* v(0) from v(h), v(h/2) and v(h/4).  Where modes differ between these, lambda is near 0 or a bound and
 * x smooth nevertheless; what is not linear in h is not extrapolated. */
static double extrapolate_to_0(double whole, double half, double quarter, int same_modes) {
    const double first = whole - half, second = half - quarter;
    if (!same_modes && !(fabs(first - 2 * second) <= fabs(second)))
        return quarter;
    return quarter + (first - 5 * second) / 3;
}

static void store_point(const ns_newton *s, double *point) {
    const size_t n = (size_t)s->n, m = (size_t)s->m;
    memcpy(point, s->at.x, sizeof(double) * n);
    memcpy(point + n, s->at.lambda, sizeof(double) * m);
    memcpy(point + n + m, s->at.y, sizeof(double) * m);
}

/* Rounding of the extrapolation may violate (S4). */
static void restore_laws(ns_newton *s) {
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
        s->at.x[i] = extrapolate_to_0(whole[i], half[i], s->at.x[i], same);
    for (int i = 0, j = n, k = n + m; i < m; i++, j++, k++) {
        if (modes[0][i] != modes[2][i] || modes[1][i] != modes[2][i])
            continue; /* (S4): that of h/4 */
        s->at.lambda[i] = extrapolate_to_0(whole[j], half[j], s->at.lambda[i], same);
        s->at.y[i] = extrapolate_to_0(whole[k], half[k], s->at.y[i], same);
    }
    restore_laws(s);
}

/* s->at: the limit of steps from the charges of `from` (n).  room: 2 (n+2m) and 2m modes. */
static int extrapolate_steps(ns_newton *s, const double *from, double h, time_of_step time, double *room) {
    const size_t m = (size_t)s->m, all = (size_t)s->n + 2 * m;
    ns_mode *mode = (ns_mode *)(room + 2 * all);
    for (int k = 0; k < 3; k++, h /= 2) {
        const int status = short_step(s, from, h, time);
        if (status != NS_OK)
            return status;
        if (k == 2)
            break;
        store_point(s, room + (size_t)k * all);
        memcpy(mode + (size_t)k * m, s->trial_mode, m);
    }
    extrapolate(s, room, room + all, mode);
    return NS_OK;
}

/* Both steps; time: the fastest time constant, s. */
static int jump_in_two_steps(ns_newton *s, double time) {
    const double unit = ldexp(1, ilogb(time)), h = ldexp(unit, AFTER);
    double *across = s->spare, *room = across + s->n;
    int status = extrapolate_steps(s, s->xk, ldexp(unit, ACROSS), TIME_STANDS, room);
    if (status != NS_OK)
        return status;
    memcpy(across, s->at.x, sizeof(double) * (size_t)s->n);
    const int resolved = t_resolves(s, h) && t_resolves(s, h / 2) && t_resolves(s, h / 4);
    return extrapolate_steps(s, across, h, resolved ? TIME_MOVES : INPUTS_BY_SECANT, room);
}

int ns_newton_jump(ns_newton *s) {
    if (!s)
        return NS_E_NULL;
    s->has_trial = 0;
    if (!s->started)
        return ns_newton_fail(s, NS_E_STATE);
    ns_newton_begin_trial(s, s->t);
    s->counts.trials++;
    ns_newton_set(s, 0, s->t, &implicit, NS_RIGHT);
    memcpy(s->at.x, s->xk, sizeof(double) * (size_t)s->n);
    memcpy(s->at.lambda, s->lk, sizeof(double) * (size_t)s->m);
    if (ns_newton_jacobians(s, &s->at) != NS_OK)
        return ns_newton_fail(s, NS_DIVERGED);
    const double rate = fastest_rate(s);
    int status = jump_in_two_steps(s, isfinite(1 / rate) ? 1 / rate : 1);
    ns_newton_set(s, 0, s->t, &implicit, NS_RIGHT);
    if (status == NS_OK && ns_newton_values(s, &s->at) != NS_OK) /* r */
        status = NS_DIVERGED;
    if (status != NS_OK)
        return ns_newton_fail(s, status);
    s->has_trial = 1;
    return NS_OK;
}
