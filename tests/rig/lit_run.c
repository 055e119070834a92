/* tests/rig/lit_run.c - a system run from t = 0 and read at equal intervals. */
#include "lit_run.h"

#include <math.h>
#include <stdlib.h>

static int step(ns_theta *t, double h, const double *z, int implicit) {
    const int status = ns_theta_try(t, h, z, implicit, NS_RESOLVE);
    return status == NS_OK ? ns_theta_accept(t) : status;
}

/* The jump, whose lambda is an impulse, and once more, for the lambda after it. */
static int start(ns_theta *t, const ns_system *s, const double *w0, double h, double *z) {
    int status = ns_theta_start(t, w0, NULL);
    ns_system_inputs(s, 0, NS_RIGHT, z);
    for (int k = 0; k < 2 && status == NS_OK; k++)
        status = step(t, h * 1e-9, z, 1);
    return status;
}

static int capture(ns_theta *t, const ns_system *s, const double *w0, const lit_plan *plan, double *X) {
    double z[8];
    const long steps = lround(plan->every / plan->h);
    int status = start(t, s, w0, plan->h, z);
    for (int k = 0; k < plan->samples && status == NS_OK; k++) {
        for (long j = 1; j <= steps && status == NS_OK; j++) {
            ns_system_inputs(s, plan->every * k + plan->h * (double)j, NS_LEFT, z);
            status = step(t, plan->h, z, 0);
        }
        if (status == NS_OK)
            status = ns_theta_read(t, X + (size_t)k * (size_t)s->n, NULL, NULL);
    }
    return status;
}

int lit_capture(const ns_system *s, const double *w0, const lit_plan *plan, double *X, ns_counts *counts) {
    const ns_theta_options o = {plan->theta, plan->gamma, 0};
    ns_theta *t;
    int status = ns_theta_create(s, &o, &t, NULL);
    if (status != NS_OK)
        return status;
    status = capture(t, s, w0, plan, X);
    *counts = *ns_theta_counts(t);
    ns_theta_free(t);
    return status;
}

int lit_march(const ns_system *s, const double *w0, const lit_plan *plan, double *X, ns_counts *counts) {
    const ns_march_options o = {.theta = plan->theta, .gamma = plan->gamma, .h = plan->h, .method = NS_THETA};
    ns_march *m;
    double reached;
    int status = ns_march_create(s, &o, &m, NULL);
    if (status != NS_OK)
        return status;
    status = ns_march_start(m, 0, w0);
    for (int k = 0; k < plan->samples && status == NS_OK; k++) {
        status = ns_march_try(m, plan->every * (k + 1), NS_TO_TIME, &reached);
        if (status == NS_OK)
            status = ns_march_accept(m);
        if (status == NS_OK)
            status = ns_march_read(m, NULL, X + (size_t)k * (size_t)s->n, NULL, NULL);
    }
    *counts = *ns_march_counts(m);
    ns_march_free(m);
    return status;
}
