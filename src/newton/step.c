/* src/newton/step.c - one Newton step, tried; many, advanced. */
#include <math.h>
#include <string.h>

#include "newton_internal.h"

enum { STEP_HALVINGS = 20 };

/* To t1 > t, by the length that t really moves by: t + h is a rounded one. */
static int try_to(ns_newton *s, double t1) {
    ns_newton_begin_trial(s, t1);
    s->counts.trials++;
    if (s->o.theta < 1 && ns_newton_slope(s) != NS_OK)
        return ns_newton_fail(s, NS_DIVERGED);
    ns_newton_set(s, t1 - s->t, t1, &s->o, NS_LEFT);
    memcpy(s->trial_mode, s->mode, (size_t)s->m);
    const int status = ns_newton_loop(s);
    if (status != NS_OK)
        return ns_newton_fail(s, status);
    s->has_trial = 1;
    return NS_OK;
}

int ns_newton_try(ns_newton *s, double h) {
    if (!s)
        return NS_E_NULL;
    s->has_trial = 0;
    if (!s->started)
        return ns_newton_fail(s, NS_E_STATE);
    const double t1 = s->t + h;
    if (!isfinite(t1) || !(t1 > s->t))
        return ns_newton_fail(s, NS_E_RANGE);
    return try_to(s, t1);
}

/* The end of the next step towards t, which equal ones of at most h reach: t grows by its last bit at least.
 */
static double next_end(double now, double t, double h) {
    const double steps = ceil((t - now) / h * (1 - 1e-12));
    return steps > 1 ? fmin(fmax(now + (t - now) / steps, nextafter(now, t)), t) : t;
}

/* Takes one step towards t, of at most *h, which is halved until Newton's loop converges. */
static int step_towards(ns_newton *s, double t, double *h, double shortest) {
    for (;;) {
        const double t1 = next_end(s->t, t, *h);
        const int status = try_to(s, t1);
        if (status == NS_OK)
            return ns_newton_accept(s);
        if (status < 0 || *h <= shortest || t1 == nextafter(s->t, t))
            return status;
        *h = fmin(*h, t - s->t) / 2;
    }
}

int ns_newton_advance(ns_newton *s, double t, double h) {
    if (!s)
        return NS_E_NULL;
    s->has_trial = 0;
    if (!s->started)
        return ns_newton_fail(s, NS_E_STATE);
    if (!(h > 0) || !isfinite(h) || !isfinite(t) || !(t >= s->t) || !isfinite(t - s->t))
        return ns_newton_fail(s, NS_E_RANGE);
    const double shortest = fmin(h, t - s->t) * ldexp(1.5, -STEP_HALVINGS);
    double now = h;
    int status = NS_OK;
    while (status == NS_OK && s->t < t) {
        status = step_towards(s, t, &now, shortest);
        now = fmin(h, 2 * now);
    }
    return status;
}
