/* src/march/dense_sample.c - the point anywhere on the way of the dense engines' last trial: as the exact
 * engine has it, or on a straight line along a step of the ladder. */
#include "dense_internal.h"
#include "linalg/simd.h"
#include "theta/name_fault.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static ns_dense_run *run_of(ns_engine *e) {
    return (ns_dense_run *)(void *)e;
}

static int read_at(ns_dense_run *r, double *x_lambda) {
    const int status = ns_theta_read(r->step, x_lambda, x_lambda + r->s->n, NULL);
    return status == NS_E_OVERFLOW ? NS_OK : status; /* it is written all the same */
}

/* Right after an event all of the (very short) way is as at its end. */
int ns_march_dense_begin_line(ns_dense_run *r, int from_event) {
    const size_t all = (size_t)r->s->n + (size_t)r->s->m;
    if (!r->way.begin)
        r->way.begin = calloc(3 * all + 1, sizeof *r->way.begin);
    if (!r->way.begin)
        return NS_E_MEMORY;
    r->way.end = r->way.begin + all;
    r->way.at = r->way.end + all;
    r->way.is_line = 1;
    r->way.is_after_event = from_event;
    r->way.end_known = 0;
    return from_event ? NS_OK : read_at(r, r->way.begin);
}

/* 1 if t is on the way of a trial with NS_TO_STEP, else *status. */
static int is_on_way(const ns_dense_run *r, double t, int *status) {
    const double to = r->trial.now.t;
    *status = !r->has_trial || r->until != NS_TO_STEP || !(to > r->engine.way_from) ? NS_E_STATE
              : !(t >= r->engine.way_from && t <= to)                               ? NS_E_RANGE
                                                                                    : NS_OK;
    return *status == NS_OK;
}

/* 1: modes changed where a start ended, in no time; the way is that of the start alone. */
static int is_start_alone(const ns_dense_run *r) {
    return !(r->trial.now.t > r->accepted.now.t);
}

/* r->way.at: between the two ends. */
static int sample_line(ns_dense_run *r, double t) {
    const int all = r->s->n + r->s->m, status = r->way.end_known ? NS_OK : read_at(r, r->way.end);
    const double from = r->accepted.now.t, part = (t - from) / (r->trial.now.t - from);
    const double *a = r->way.is_after_event ? r->way.end : r->way.begin, *b = r->way.end;
    r->way.end_known = status == NS_OK;
    for (int i = 0; i < all; i++)
        r->way.at[i] = (1 - part) * a[i] + part * b[i];
    return status;
}

/* x and lambda at t, x_lambda (n+m), are copied out; they may have overflowed before the charges. */
static int give(ns_dense_run *r, double t, const double *x_lambda, double *x, double *lambda) {
    const int n = r->s->n, m = r->s->m;
    if (x)
        memcpy(x, x_lambda, sizeof *x * (size_t)n);
    if (lambda)
        memcpy(lambda, x_lambda + n, sizeof *x * (size_t)m);
    if (ns_sums_finite(n + m, x_lambda))
        return NS_OK;
    ns_fault found = {.status = NS_E_OVERFLOW, .t = t};
    found.nunknowns = ns_theta_name_infinite(n, x_lambda, found.unknown);
    found.npairs = ns_theta_name_infinite(m, x_lambda + n, found.pair);
    if (found.nunknowns + found.npairs == 0)
        return NS_OK;
    r->fault = found;
    return NS_E_OVERFLOW;
}

/* As at its end all along: the steps of a start are not kept. */
static int sample_start(ns_dense_run *r, const double **x_lambda) {
    *x_lambda = r->sampled[1].at;
    r->sampled[1].known = 0;
    return read_at(r, r->sampled[1].at);
}

/* As the exact engine has it; answers at both ends are kept. */
static int sample_exact(ns_dense_run *r, double t, const double **x_lambda) {
    const int end = t == r->trial.now.t, is_end = end || t == r->accepted.now.t;
    if (is_end && r->sampled[end].known) {
        *x_lambda = r->sampled[end].at;
        return NS_OK;
    }
    const int status = ns_exact_sample(r->exact, t, x_lambda);
    if (is_end && status == NS_OK) {
        memcpy(r->sampled[end].at, *x_lambda, sizeof(double) * ((size_t)r->s->n + (size_t)r->s->m));
        r->sampled[end].known = 1;
    }
    return status;
}

int ns_march_dense_sample(ns_engine *e, double t, double *x, double *lambda) {
    ns_dense_run *r = run_of(e);
    const double *x_lambda;
    int status;
    if (!is_on_way(r, t, &status))
        return ns_march_dense_fail(r, status);
    t = fmax(t, r->accepted.now.t);
    x_lambda = r->way.at;
    status = is_start_alone(r) ? sample_start(r, &x_lambda)
             : r->way.is_line  ? sample_line(r, t)
                               : sample_exact(r, t, &x_lambda);
    return status == NS_OK ? give(r, t, x_lambda, x, lambda) : ns_march_dense_fail(r, status);
}

double ns_march_dense_shortest(ns_engine *e, double t, double *until) {
    ns_dense_run *r = run_of(e);
    int status;
    *until = INFINITY;
    if (!is_on_way(r, t, &status))
        return NAN;
    t = fmax(t, r->accepted.now.t);
    return r->way.is_line || is_start_alone(r) ? INFINITY : ns_exact_shortest(r->exact, t, until);
}
