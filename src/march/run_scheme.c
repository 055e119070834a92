/* src/march/run_scheme.c - the theta scheme in place of a kernel, for a whole trial: nobody judges how the
 * errors of its steps add up, so it is believed where shorter steps come to the same.
 */
#include "run_internal.h"

#include <math.h>
#include <stdlib.h>

/* Charges and fluxes of an engine's point: w (n); x: n. */
static int read_charges(const ns_run *r, ns_engine *e, double *x, double *w) {
    const int status = ns_engine_read(e, NULL, x, NULL, NULL);
    ns_system_charges(r->s, x, w);
    return status;
}

double ns_march_run_finer_step(const ns_run *r, double length) {
    return fmin(ns_march_run_scheme_step(r), length) / 4;
}

/* The same by shorter steps. */
static int read_finer(ns_run *r, const ns_run_start *from, double end, double *x, double *w) {
    const double step = r->scheme_step;
    ns_engine *e = NULL;
    double reached;
    r->scheme_step = ns_march_run_finer_step(r, end - from->t);
    int status = ns_march_run_make(r, NS_RUN_SCHEME, &e);
    r->scheme_step = step;
    if (status != NS_OK)
        return status;
    status = e->table->start(e, from->t, from->w, from->closed);
    if (status == NS_OK)
        status = e->table->try_to(e, end, NS_TO_TIME, &reached);
    if (status == NS_OK)
        status = read_charges(r, e, x, w);
    e->table->free(e);
    return status;
}

/* How far charges and fluxes may be from what shorter steps come to, of the largest: steps are of first
 * order, so that their error is a third more.  Of the scheme where kernels failed; of the ladder, instead of
 * which they may be asked. */
static const double of_scheme = 7e-4, of_ladder = 1e-4;

/* 1: these charges and fluxes, w (n), are those that shorter steps come to. */
static int is_same(ns_run *r, const ns_run_start *from, double end, const double *w, double same) {
    const int n = r->s->n;
    double *x = calloc(2 * (size_t)n + 1, sizeof *x), *finer = x ? x + n : NULL, most = INFINITY;
    if (x && read_finer(r, from, end, x, finer) == NS_OK) {
        most = 0;
        for (int i = 0; i < n; i++)
            most = fmax(most, fabs(w[i] - finer[i]) / ns_verify_most_charge(r->check.verify, i));
    }
    free(x);
    return most <= same;
}

int ns_march_run_is_believed(ns_run *r, const ns_run_start *from, double end) {
    const size_t n = (size_t)r->s->n;
    if (!(end > from->t))
        return 1;
    double *x = calloc(2 * n + 1, sizeof *x);
    const int same =
        x && read_charges(r, r->at_work, x, x + n) == NS_OK && is_same(r, from, end, x + n, of_scheme);
    free(x);
    return same;
}

/* The trial was dropped for what it began with, and is made again. */
static int make_again(ns_run *r, double t, ns_until until, double end) {
    double reached;
    if (r->at_work->table->try_to(r->at_work, t, until, &reached) != NS_OK || reached != end)
        return 0;
    ns_march_dense_believe(r->at_work);
    return 1;
}

/* After each that was believed so many more are not judged: where the ladder goes on, events follow each
 * other without end. */
static int is_to_be_judged(ns_run *r) {
    enum { MOST = 64 };
    if (r->ladder_rests-- > 0)
        return 0;
    r->ladder_rest = r->ladder_rest < MOST ? r->ladder_rest + 1 : MOST;
    r->ladder_rests = r->ladder_rest - 1;
    return 1;
}

int ns_march_run_ladder_is_believed(ns_run *r, double t, ns_until until, double end) {
    if (!is_to_be_judged(r))
        return 1;
    const size_t n = (size_t)r->s->n;
    double *x = calloc(2 * n + 1, sizeof *x), *left = NULL;
    unsigned char *closed = NULL;
    ns_run_start from = {.t = end};
    int believed = x && read_charges(r, r->at_work, x, x + n) == NS_OK;
    ns_engine_drop(r->at_work);
    believed = believed && ns_march_run_read_accepted(r, &from.t, &left, &closed) == NS_OK;
    from.w = left;
    from.closed = closed;
    believed = believed && (!(end > from.t) || is_same(r, &from, end, x + n, of_ladder)) &&
               make_again(r, t, until, end);
    free(x);
    free(left);
    free(closed);
    if (!believed)
        r->ladder_rests = r->ladder_rest /= 2;
    return believed;
}
