/* src/newton/loop.c - Newton's loop around (P1). */
#include <math.h>
#include <string.h>

#include "newton_internal.h"

/* A correction must take away at least this part of what its fraction promises. */
static const double progress = 0.1;
/* No unknown counts as less than this part of what it was at the step's start: rounding of that over the
 * tolerance that is the rule. */
static const double of_start = 1e-3;
/* An iteration that leaves no more than this part of the residuals does not count towards the bound: an
 * exponential comes down by a factor e each, and from exp(700) in 700.  So many bounds in all. */
static const double slow = 0.5;
enum { BOUNDS = 20 };
/* Linearised problems without an answer, one after the other, before that counts for the step's own. */
enum { NO_ANSWERS = 2 };

/* The larger of both residuals, against the sizes of their terms. */
static double relative_residual(const ns_newton *s, const ns_iterate *at) {
    double largest = 0;
    for (int i = 0; i < s->n + s->m; i++) {
        const double r = fabs(i < s->n ? at->R[i] : at->Ry[i - s->n]);
        if (!(r <= largest * s->size[i]))
            largest = r / s->size[i];
    }
    return largest;
}

/* The residuals at a point with y: where they overflow it is as good as outside a domain. */
static int find_residuals(ns_newton *s, ns_iterate *at) {
    ns_newton_residuals(s, at);
    return ns_linalg_finite((size_t)s->n, at->R) && ns_linalg_finite((size_t)s->m, at->Ry) ? NS_OK
                                                                                           : NS_DIVERGED;
}

static int evaluate_at(ns_newton *s, ns_iterate *at) {
    const int status = ns_newton_values(s, at);
    return status == NS_OK ? find_residuals(s, at) : status;
}

static int is_finite(const ns_newton *s, const ns_iterate *at) {
    const size_t n = (size_t)s->n, m = (size_t)s->m;
    return ns_linalg_finite(n, at->x) && ns_linalg_finite(m, at->lambda) && ns_linalg_finite(m, at->y);
}

/* (x_k, lambda_k), y as near to h as (S4) lets it be. */
static int start_iterate(ns_newton *s) {
    ns_iterate *at = &s->at;
    memcpy(at->x, s->guess, sizeof(double) * (size_t)s->n);
    memcpy(at->lambda, s->lk, sizeof(double) * (size_t)s->m);
    const int status = ns_newton_values(s, at);
    if (status != NS_OK)
        return status;
    for (int i = 0; i < s->m; i++) {
        const double l = s->model->l[i], u = s->model->u[i], h = at->h[i];
        at->y[i] = l == u               ? h
                   : at->lambda[i] == l ? fmax(h, 0)
                   : at->lambda[i] == u ? fmin(h, 0)
                                        : 0; /* (S4) */
    }
    return find_residuals(s, at);
}

/* s->next by a fraction of the correction; *now: its residuals against the sizes of s->at. */
static int try_fraction(ns_newton *s, double fraction, double *now) {
    memcpy(s->next_mode, s->trial_mode, (size_t)s->m);
    int status = ns_newton_solve(s, fraction, s->next_mode);
    if (status != NS_OK)
        return status;
    if (!is_finite(s, &s->next) || evaluate_at(s, &s->next) != NS_OK)
        return NS_DIVERGED;
    *now = relative_residual(s, &s->next);
    return NS_OK;
}

/* 1 if both residuals at a point are down to the tolerance, in sizes of their own.  Where everything is zero
 * but what rounding of the step's start leaves, that is what counts: of the unknowns alone, for the functions
 * may be anything there, an exponential of what has not followed its source yet. */
static int is_small(ns_newton *s, const ns_iterate *at, int whole) {
    ns_newton_sizes(s, at, of_start, whole);
    return relative_residual(s, at) <= s->o.tolerance;
}

/* What a correction came to. */
typedef struct outcome {
    int small;   /* the problem is solved */
    int full;    /* status of the full correction */
    double left; /* part of the residuals that is left */
} outcome;

/* From s->at to s->next: the full step if it solves the problem or brings the residuals down, or else the
 * first of its halves, quarters, ... that does.  Not damped: the first that can be taken. */
static int correct(ns_newton *s, int damped, outcome *out) {
    ns_newton_sizes(s, &s->at, 0, 0);
    const double before = relative_residual(s, &s->at);
    double fraction = 1, now = 0;
    out->full = NS_OK;
    for (int k = 0; k <= s->o.halvings; k++, fraction /= 2) {
        const int status = try_fraction(s, fraction, &now);
        s->counts.halvings += k > 0;
        if (k == 0)
            out->full = status;
        if (status != NS_OK)
            continue;
        out->left = now / before;
        out->small = is_small(s, &s->next, 0);
        if (out->small || !damped || now <= (1 - progress * fraction) * before)
            return NS_OK;
        ns_newton_sizes(s, &s->at, 0, 0);
    }
    return out->full < 0 ? out->full : NS_DIVERGED;
}

/* 1 if s->at, which no correction brought down, solves the problem but for what functions round to: much in a
 * part of the system and nothing beside the whole. */
static int is_rounding(ns_newton *s, const outcome *out) {
    return out->full == NS_OK && is_small(s, &s->at, 1);
}

static void take_next(ns_newton *s) {
    const ns_iterate at = s->at;
    s->at = s->next;
    s->next = at;
    memcpy(s->trial_mode, s->next_mode, (size_t)s->m);
}

static int linearise(ns_newton *s) {
    if (ns_newton_jacobians(s, &s->at) != NS_OK)
        return NS_DIVERGED;
    ns_newton_form(s);
    return ns_newton_reduce(s);
}

/* What a linearised problem without an answer says of the step: where it was made at the step's start, or
 * again and again, and pairs contradict each other in it, that there is none; otherwise that Newton's loop
 * met a place that is no good, and a shorter step may not. */
static int verdict(const ns_newton *s, int status, int k, int refused) {
    if (status >= 0 || (s->fault.npairs > 0 && (k == 0 || refused >= NO_ANSWERS)))
        return status;
    return NS_DIVERGED;
}

static int iterate(ns_newton *s, int damped) {
    outcome out = {0, NS_OK, 1};
    int refused = 0, counted = 0;
    int status = start_iterate(s) == NS_OK ? NS_OK : NS_DIVERGED;
    for (int k = 0; status == NS_OK && !out.small && counted < s->o.iterations; k++) {
        s->counts.iterations++;
        status = linearise(s);
        if (status == NS_OK && (status = correct(s, damped, &out)) == NS_DIVERGED && is_rounding(s, &out))
            return NS_OK;
        refused = out.full < 0 ? refused + 1 : 0;
        counted += out.left > slow || k / BOUNDS >= s->o.iterations;
        if (status == NS_OK)
            take_next(s);
        if (status == NS_OK && !out.small && refused >= NO_ANSWERS)
            status = out.full;
        status = verdict(s, status, k, refused);
    }
    return status == NS_OK && !out.small ? NS_DIVERGED : status;
}

/* Where no shortened correction makes residuals smaller, full ones may still lead to an answer, over a hill:
 * a resistance that becomes a million times as large is multiplied, once, by the current that was. */
int ns_newton_loop(ns_newton *s) {
    const int status = iterate(s, 1);
    if (status != NS_DIVERGED)
        return status;
    memcpy(s->trial_mode, s->mode, (size_t)s->m);
    return iterate(s, 0);
}
