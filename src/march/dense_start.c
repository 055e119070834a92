/* src/march/dense_start.c - a consistent start of the dense engines: from charges and fluxes, or from the DC
 * operating point. */
#include "dense_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static ns_dense_run *run_of(ns_engine *e) {
    return (ns_dense_run *)(void *)e;
}

static int find_consistent(ns_dense_run *r, double t0, const double *w0, ns_mode *guess) {
    ns_march_dense_clear_instant(r);
    int status = ns_ladder_restart(r->ladder, t0, w0, guess);
    if (status != NS_OK)
        return status;
    status = r->exact ? ns_exact_find_consistent(r->exact, guess == r->guess) : NS_E_STATE;
    if (status == NS_OK || status == NS_E_MEMORY)
        return status;
    return ns_ladder_find_consistent(r->ladder);
}

/* Commanded switches that the state contradicts change, and the start is made again from the same w0.  A set
 * of switches that does not come to an end chatters: it is left to the steps, unless one with hysteresis
 * contradicts itself (LIMIT). */
static int start_switches(ns_dense_run *r, double t0, const double *w0, const unsigned char *closed,
                          ns_mode *guess) {
    int status = ns_ladder_start(r->ladder, t0, w0, closed);
    for (int round = 0; status == NS_OK && round <= 2 * r->s->nc + 1; round++) {
        memset(r->trial.flip, 0, (size_t)r->s->nc);
        status = find_consistent(r, t0, w0, guess);
        if (status == NS_OK && !ns_ladder_toggle(r->ladder))
            break;
    }
    if (status == NS_OK && !ns_ladder_end_start(r->ladder))
        status = NS_E_LIMIT;
    memset(r->trial.flip, 0, (size_t)r->s->nc);
    return status;
}

/* guess (m): a mode that is kept if it holds, NULL: none. */
static int start(ns_dense_run *r, double t0, const double *w0, const unsigned char *closed, ns_mode *guess) {
    r->trial.now.t = t0;
    r->started = r->has_trial = r->carries = 0;
    ns_march_dense_bound_search(r, INFINITY);
    if (!isfinite(t0) || !(t0 + r->options.h > t0))
        return ns_march_dense_fail(r, NS_E_NUMBER);
    const int status = start_switches(r, t0, w0, closed, guess);
    r->was_cut_off = !(ns_theta_search_left(r->step) > 0);
    if (status != NS_OK)
        return ns_march_dense_fail(r, status);
    r->trial.last_event_t = r->trial.now.t; /* whatever was before, anything fast may happen now */
    r->started = r->has_trial = 1;
    const int accepted = ns_march_dense_accept(r);
    r->engine.way_from = t0;
    return accepted;
}

void ns_march_dense_guess(ns_engine *e, const ns_mode *mode) {
    ns_dense_run *r = run_of(e);
    memcpy(r->guess, mode, (size_t)r->s->m * sizeof *mode);
    r->has_guess = 1;
}

int ns_march_dense_start(ns_engine *e, double t0, const double *w0, const unsigned char *closed) {
    ns_dense_run *r = run_of(e);
    ns_mode *guess = r->has_guess ? r->guess : NULL;
    r->has_guess = 0;
    return start(r, t0, w0, closed, guess);
}

static int start_dc(ns_dense_run *r, double t0, int nhold, const int *hold, const double *hold_x, double *x,
                    double *w0, ns_mode *mode) {
    int status = ns_ladder_start(r->ladder, t0, w0, NULL);
    if (status == NS_OK)
        status = ns_ladder_operating_point(r->ladder, t0, nhold, hold, hold_x, x, mode);
    if (status != NS_OK)
        return ns_march_dense_fail(r, status);
    ns_system_charges(r->s, x, w0);
    return start(r, t0, w0, NULL,
                 mode); /* where several modes hold, as in a latch, that of the operating point */
}

int ns_march_dense_start_dc(ns_engine *e, double t0, int nhold, const int *hold, const double *hold_x,
                            double *x_out) {
    ns_dense_run *r = run_of(e);
    r->trial.now.t = t0;
    r->started = r->has_trial = 0;
    if (!isfinite(t0))
        return ns_march_dense_fail(r, NS_E_NUMBER);
    if (nhold < 0 || nhold > r->s->n)
        return ns_march_dense_fail(r, NS_E_SIZE);
    for (int k = 0; k < nhold; k++)
        if (hold[k] < 0 || hold[k] >= r->s->n)
            return ns_march_dense_fail(r, NS_E_SIZE);
    const size_t n = (size_t)r->s->n;
    double *x = calloc(2 * n + 1, sizeof *x);
    ns_mode *mode = calloc((size_t)r->s->m + 1, sizeof *mode);
    const int status = x && mode ? start_dc(r, t0, nhold, hold, hold_x, x, x + n, mode)
                                 : ns_march_dense_fail(r, NS_E_MEMORY);
    if (status == NS_OK && x && x_out)
        memcpy(x_out, x, sizeof(double) * n);
    free(x);
    free(mode);
    return status;
}
