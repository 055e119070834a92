/* src/march/partition_read.c - a run for each island, as one: read at the point, and on the way of a trial.
 *
 * An island whose own trial goes beyond the point (partition_advance.c) is read on the way of that.
 */
#include "linalg/dense.h"
#include "linalg/sparse.h"
#include "partition_internal.h"

#include <math.h>
#include <string.h>

static ns_partition_run *run_of(ns_engine *e) {
    return (ns_partition_run *)(void *)e;
}

static const ns_partition_run *run_in(const ns_engine *e) {
    return (const ns_partition_run *)(const void *)e;
}

static double time_of(const ns_partition_run *f) {
    return f->has_trial ? f->trial : f->accepted;
}

/* --- an island in the whole --- */

/* Only shared unknowns are read and written in `seen`: every sample of every island passes here, and writing
 * characters makes the compiler read all pointers again. */
void ns_march_partition_put(ns_partition_run *f, int island, double *x) {
    const ns_island *i = &f->islands.island[island];
    const int n = i->s->n, *unknown = i->unknown;
    const double *of_island = f->x; /* read once, likewise */
    if (!f->part[island].shares) {
        for (int k = 0; k < n; k++)
            x[unknown[k]] = of_island[k];
        return;
    }
    for (int k = 0; k < n; k++) {
        const int whole = unknown[k];
        const double value = of_island[k];
        if (!f->islands.shared[whole]) {
            x[whole] = value;
            continue;
        }
        x[whole] = value + (f->seen[whole] ? x[whole] : 0);
        f->seen[whole] = 1;
    }
}

static void put_pairs(const ns_partition_run *f, int island, double *lambda, double *y) {
    const ns_island *i = &f->islands.island[island];
    for (int j = 0; j < i->s->m; j++) {
        if (lambda)
            lambda[i->pair[j]] = f->lambda[j];
        if (y)
            y[i->pair[j]] = f->y[j];
    }
}

/* What was read of one is written to all of them; one that overflowed too. */
static int put_read(ns_partition_run *f, int k, int read, double *x, double *lambda, double *y) {
    if (read != NS_OK)
        ns_march_partition_keep_fault(f, k);
    if (read != NS_OK && read != NS_E_OVERFLOW)
        return read;
    if (x)
        ns_march_partition_put(f, k, x);
    put_pairs(f, k, lambda, y);
    return NS_OK;
}

/* --- the point --- */

/* f->y of f->x, f->lambda at t (S3). */
static void find_y(ns_partition_run *f, const ns_system *s, double t) {
    ns_system_inputs(s, t, NS_LEFT, f->z);
    for (int j = 0; j < s->m; j++)
        f->y[j] = s->e[j];
    if (s->large) {
        ns_linalg_csc_times_add(&s->large->C, f->x, f->y);
        ns_linalg_csc_times_add(&s->large->D, f->lambda, f->y);
        ns_linalg_csc_times_add(&s->large->F, f->z, f->y);
        return;
    }
    ns_linalg_matvec_add(s->m, s->n, s->C, f->x, f->y);
    ns_linalg_matvec_add(s->m, s->m, s->D, f->lambda, f->y);
    ns_linalg_matvec_add(s->m, s->nz, s->F, f->z, f->y);
}

/* f->x, f->lambda, f->y of an island at t. */
static int read_one(ns_partition_run *f, int k, double t) {
    const ns_part_run *s = &f->part[k];
    if (!ns_march_partition_is_on_way(s, t))
        return ns_engine_read(s->run, NULL, f->x, f->lambda, f->y);
    const int status = ns_engine_sample(s->run, fmax(t, s->accepted), f->x, f->lambda);
    find_y(f, s->island->s, t);
    return status;
}

int ns_march_partition_read(ns_engine *e, double *t, double *x, double *lambda, double *y) {
    ns_partition_run *f = run_of(e);
    int status = NS_OK;
    if (t)
        *t = time_of(f);
    memset(f->seen, 0, (size_t)f->s->n);
    for (int k = 0; k < f->islands.count; k++) {
        const int read = read_one(f, k, time_of(f)), put = put_read(f, k, read, x, lambda, y);
        if (put != NS_OK)
            return put;
        status = read != NS_OK ? read : status;
    }
    return status;
}

int ns_march_partition_impulse(ns_engine *e, double *x, double *lambda) {
    ns_partition_run *f = run_of(e);
    memset(f->seen, 0, (size_t)f->s->n);
    for (int k = 0; k < f->islands.count; k++) {
        const int status = ns_engine_impulse(f->part[k].run, f->x, f->lambda);
        if (status != NS_OK)
            return status;
        if (x)
            ns_march_partition_put(f, k, x);
        put_pairs(f, k, lambda, NULL);
    }
    return NS_OK;
}

const ns_mode *ns_march_partition_mode(ns_engine *e) {
    ns_partition_run *f = run_of(e);
    for (int k = 0; k < f->islands.count; k++) {
        const ns_island *i = f->part[k].island;
        const ns_mode *mode = ns_engine_mode(f->part[k].run);
        for (int j = 0; j < i->s->m; j++)
            f->mode[i->pair[j]] = mode[j];
    }
    return f->mode;
}

int ns_march_partition_at_event(const ns_engine *e) {
    const ns_partition_run *f = run_in(e);
    int any = 0;
    for (int k = 0; k < f->islands.count; k++)
        any |= ns_engine_at_event(f->part[k].run) && !ns_march_partition_is_on_way(&f->part[k], time_of(f));
    return any;
}

/* The least accurate one in use. */
ns_method ns_march_partition_method(const ns_engine *e) {
    const ns_partition_run *f = run_in(e);
    ns_method worst = NS_EXACT;
    for (int k = 0; k < f->islands.count; k++) {
        const ns_method engine = ns_engine_method(f->part[k].run);
        if (engine == NS_THETA || worst == NS_EXACT)
            worst = engine;
    }
    return worst;
}

/* --- on the way --- */

/* 1 if t is on the way of a trial with NS_TO_STEP, else *status. */
static int is_on_way(const ns_partition_run *f, double t, int *status) {
    *status = !f->has_trial || f->until != NS_TO_STEP || !(f->trial > f->accepted) ? NS_E_STATE
              : !(t >= f->accepted && t <= f->trial)                               ? NS_E_RANGE
                                                                                   : NS_OK;
    return *status == NS_OK;
}

/* An island's own trial begins before the whole one, or some rounding after, and ends likewise. */
static double time_in(const ns_part_run *s, double t) {
    return fmin(fmax(t, s->accepted), s->trial);
}

/* Its trial has a way; others were asked to come after, a little beyond an event. */
static int has_way(const ns_part_run *s) {
    return s->tried && s->is_step && s->trial > s->accepted;
}

int ns_march_partition_sample(ns_engine *e, double t, double *x, double *lambda) {
    ns_partition_run *f = run_of(e);
    int status;
    if (!is_on_way(f, t, &status))
        return ns_march_partition_fail_here(f, status);
    memset(f->seen, 0, (size_t)f->s->n);
    for (int k = 0; k < f->islands.count; k++) {
        ns_part_run *s = &f->part[k];
        const int read = has_way(s) ? ns_engine_sample(s->run, time_in(s, t), f->x, f->lambda)
                                    : ns_engine_read(s->run, NULL, f->x, f->lambda, NULL);
        const int put = put_read(f, k, read, x, lambda, NULL);
        if (put != NS_OK)
            return put;
        status = read != NS_OK ? read : status;
    }
    return status;
}

double ns_march_partition_shortest(ns_engine *e, double t, double *until) {
    ns_partition_run *f = run_of(e);
    double shortest = INFINITY, own;
    int status;
    *until = INFINITY;
    if (!is_on_way(f, t, &status))
        return NAN;
    for (int k = 0; k < f->islands.count; k++) {
        ns_part_run *s = &f->part[k];
        if (!has_way(s))
            continue;
        shortest = fmin(shortest, ns_engine_shortest(s->run, time_in(s, t), &own));
        *until = fmin(*until, own);
    }
    return shortest;
}
