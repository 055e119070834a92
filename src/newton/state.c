/* src/newton/state.c - the accepted point: started, moved to by a step or a jump, read. */
#include <math.h>
#include <string.h>

#include "newton_internal.h"

static ns_mode mode_of(double lambda, double l, double u) {
    return lambda == l ? NS_LOWER : lambda == u ? NS_UPPER : NS_INSIDE;
}

/* s->at becomes the accepted point. */
static void accept_iterate(ns_newton *s) {
    memcpy(s->xk, s->at.x, sizeof(double) * (size_t)s->n);
    memcpy(s->rk, s->at.r, sizeof(double) * (size_t)s->n);
    memcpy(s->lk, s->at.lambda, sizeof(double) * (size_t)s->m);
    memcpy(s->yk, s->at.y, sizeof(double) * (size_t)s->m);
    s->has_fk = s->has_trial = 0;
}

int ns_newton_start(ns_newton *s, double t0, const double *x, const double *lambda) {
    static const ns_newton_options implicit = {.theta = 1, .gamma = 1};
    if (!s || (!x && s->n > 0))
        return NS_E_NULL;
    ns_newton_begin_trial(s, t0); /* s->at is written below */
    if (!isfinite(t0) || !ns_linalg_finite((size_t)s->n, x) ||
        (lambda && !ns_linalg_finite((size_t)s->m, lambda)))
        return ns_newton_fail(s, NS_E_NUMBER);
    ns_newton_set(s, 0, t0, &implicit, NS_RIGHT);
    ns_linalg_copy((size_t)s->n, x, s->at.x);
    for (int i = 0; i < s->m; i++)
        s->at.lambda[i] = fmin(fmax(lambda ? lambda[i] : 0, s->model->l[i]), s->model->u[i]);
    int status = ns_newton_values(s, &s->at);
    if (status == NS_OK)
        status = ns_newton_jacobians(s, &s->at);
    if (status != NS_OK)
        return ns_newton_fail(s, status == NS_DIVERGED ? NS_E_RANGE : status);
    memcpy(s->at.y, s->at.h, sizeof(double) * (size_t)s->m); /* (S3) */
    for (int i = 0; i < s->m; i++)
        s->mode[i] = mode_of(s->at.lambda[i], s->model->l[i], s->model->u[i]);
    accept_iterate(s);
    s->t = t0;
    s->started = 1;
    return NS_OK;
}

int ns_newton_accept(ns_newton *s) {
    if (!s)
        return NS_E_NULL;
    if (!s->has_trial)
        return NS_E_STATE;
    accept_iterate(s);
    memcpy(s->mode, s->trial_mode, (size_t)s->m);
    s->t = s->t1;
    s->counts.steps++;
    return NS_OK;
}

static void copy_out(double *to, const double *from, int count) {
    if (to)
        memcpy(to, from, sizeof(double) * (size_t)count);
}

int ns_newton_read(const ns_newton *s, double *t, double *x, double *lambda, double *y, double *r) {
    if (!s)
        return NS_E_NULL;
    if (!s->started)
        return NS_E_STATE;
    copy_out(t, &s->t, 1);
    copy_out(x, s->xk, s->n);
    copy_out(lambda, s->lk, s->m);
    copy_out(y, s->yk, s->m);
    copy_out(r, s->rk, s->n);
    return NS_OK;
}

const ns_newton_counts *ns_newton_counts_of(const ns_newton *s) {
    return &s->counts;
}

const ns_fault *ns_newton_fault(const ns_newton *s) {
    return &s->fault;
}
