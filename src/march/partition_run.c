/* src/march/partition_run.c - a run for each island, as one: made, started. */
#include "partition_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* For what islands keep of their modes, all together: twice what one marcher has. */
static const size_t shared_bytes = (size_t)256 << 20;

static ns_partition_run *run_of(ns_engine *e) {
    return (ns_partition_run *)(void *)e;
}

static const ns_partition_run *run_in(const ns_engine *e) {
    return (const ns_partition_run *)(const void *)e;
}

/* --- made --- */

static int allocate(ns_partition_run *f) {
    const size_t n = (size_t)f->s->n, m = (size_t)f->s->m;
    f->part = calloc((size_t)f->islands.count, sizeof *f->part);
    f->numbers = calloc(n + 2 * m + (size_t)f->s->nz + 1, sizeof(double));
    f->mode = calloc(m + 1, sizeof *f->mode);
    f->seen = calloc(n + 1, 1);
    f->closed = calloc((size_t)f->s->nc + 1, 1);
    if (!f->part || !f->numbers || !f->mode || !f->seen || !f->closed)
        return NS_E_MEMORY;
    f->x = f->numbers;
    f->lambda = f->x + n;
    f->y = f->lambda + m;
    f->z = f->y + m;
    return NS_OK;
}

static int make_runs(ns_partition_run *f, const ns_march_options *o) {
    ns_march_options each = *o;
    int status = allocate(f);
    each.whole = 1;
    each.map_bytes = (o->map_bytes ? o->map_bytes : shared_bytes) / (size_t)f->islands.count;
    for (int k = 0; k < f->islands.count && status == NS_OK; k++) {
        ns_part_run *s = &f->part[k];
        s->island = &f->islands.island[k];
        for (int i = 0; i < s->island->s->n; i++)
            s->shares |= f->islands.shared[s->island->unknown[i]];
        status = ns_march_run_create(s->island->s, &each, &s->run, NULL); /* the whole was checked */
    }
    return status;
}

/* --- started --- */

static int begin_together(ns_partition_run *f) {
    f->accepted = -INFINITY;
    f->started = 0;
    for (int k = 0; k < f->islands.count; k++) {
        ns_part_run *s = &f->part[k];
        const int status = ns_engine_read(s->run, &s->accepted, NULL, NULL, NULL);
        if (status != NS_OK)
            return ns_march_partition_fail(f, k, status);
        s->trial = s->seen = s->accepted;
        s->at_event = s->tried = s->lags = 0;
        f->accepted = fmax(f->accepted, s->accepted);
    }
    f->trial = f->accepted;
    f->has_trial = f->at_event = 0;
    f->started = 1;
    return NS_OK;
}

/* The charge of what islands share counts in the first. */
static void charges_of(ns_partition_run *f, int island, const double *w0) {
    const ns_island *i = &f->islands.island[island];
    for (int k = 0; k < i->s->n; k++) {
        const int whole = i->unknown[k];
        f->x[k] = f->seen[whole] ? 0 : w0[whole];
        f->seen[whole] = 1;
    }
}

/* The commanded switches of an island that are closed (nc of the whole), as its own. */
static const unsigned char *closed_of(ns_partition_run *f, const ns_island *i, const unsigned char *closed) {
    if (!closed)
        return NULL;
    for (int c = 0; c < f->s->nc; c++)
        f->mode[f->s->command[c].pair] = closed[c] ? NS_INSIDE : NS_LOWER;
    for (int c = 0; c < i->s->nc; c++)
        f->closed[c] = f->mode[i->pair[i->s->command[c].pair]] == NS_INSIDE;
    return f->closed;
}

static int start(ns_engine *e, double t0, const double *w0, const unsigned char *closed) {
    ns_partition_run *f = run_of(e);
    memset(f->seen, 0, (size_t)f->s->n);
    for (int k = 0; k < f->islands.count; k++) {
        charges_of(f, k, w0);
        const int status =
            f->part[k].run->table->start(f->part[k].run, t0, f->x, closed_of(f, f->part[k].island, closed));
        if (status != NS_OK)
            return ns_march_partition_fail(f, k, status);
    }
    return begin_together(f);
}

/* The holds of an island, as its own. */
static int holds_of(const ns_island *i, int nhold, const int *hold, const double *hold_x, int *own,
                    double *own_x) {
    int n = 0;
    for (int h = 0; h < nhold; h++)
        for (int k = 0; k < i->s->n; k++)
            if (i->unknown[k] == hold[h]) {
                own[n] = k;
                own_x[n++] = hold_x[h];
            }
    return n;
}

static int start_dc(ns_engine *e, double t0, int nhold, const int *hold, const double *hold_x, double *x) {
    ns_partition_run *f = run_of(e);
    if (nhold < 0 || nhold > f->s->n)
        return ns_march_partition_fail_here(f, NS_E_SIZE);
    for (int h = 0; h < nhold; h++)
        if (hold[h] < 0 || hold[h] >= f->s->n)
            return ns_march_partition_fail_here(f, NS_E_SIZE);
    int *own = calloc((size_t)nhold + 1, sizeof *own), status = NS_OK;
    double *own_x = calloc((size_t)nhold + 1, sizeof *own_x);
    if (!own || !own_x)
        status = ns_march_partition_fail_here(f, NS_E_MEMORY);
    memset(f->seen, 0, (size_t)f->s->n);
    for (int k = 0; own && own_x && k < f->islands.count && status == NS_OK; k++) {
        const int n = holds_of(f->part[k].island, nhold, hold, hold_x, own, own_x);
        status = f->part[k].run->table->start_dc(f->part[k].run, t0, n, own, own_x, f->x);
        if (status != NS_OK)
            ns_march_partition_fail(f, k, status);
        else if (x)
            ns_march_partition_put(f, k, x);
    }
    free(own);
    free(own_x);
    return status == NS_OK ? begin_together(f) : status;
}

static const ns_counts *counts(ns_engine *e) {
    ns_partition_run *f = run_of(e);
    f->counts = (ns_counts){0};
    for (int k = 0; k < f->islands.count; k++)
        ns_march_add_counts(&f->counts, f->part[k].run->table->counts(f->part[k].run));
    f->counts.islands = f->islands.count;
    return &f->counts;
}

static const ns_fault *fault(const ns_engine *e) {
    return &run_in(e)->fault;
}

static int problem(const ns_engine *e, ns_mlcp *p, double *h) {
    const ns_partition_run *f = run_in(e);
    return f->failed < 0 ? NS_E_STATE : ns_engine_problem(f->part[f->failed].run, p, h);
}

static void free_run(ns_engine *e) {
    ns_partition_run *f = run_of(e);
    if (!f)
        return;
    for (int k = 0; f->part && k < f->islands.count; k++)
        if (f->part[k].run)
            f->part[k].run->table->free(f->part[k].run);
    ns_system_partition_free(&f->islands);
    free(f->part);
    free(f->numbers);
    free(f->mode);
    free(f->seen);
    free(f->closed);
    free(f);
}

static const ns_engine_table table = {
    .free = free_run,
    .start = start,
    .start_dc = start_dc,
    .try_to = ns_march_partition_try,
    .drop = ns_march_partition_drop,
    .accept = ns_march_partition_accept,
    .read = ns_march_partition_read,
    .impulse = ns_march_partition_impulse,
    .mode = ns_march_partition_mode,
    .at_event = ns_march_partition_at_event,
    .method = ns_march_partition_method,
    .counts = counts,
    .fault = fault,
    .sample = ns_march_partition_sample,
    .shortest = ns_march_partition_shortest,
    .problem = problem,
    .set_input = ns_march_partition_set_input,
};

int ns_march_partition_create(const ns_system *s, const ns_march_options *o, ns_engine **out,
                              ns_fault *fault) {
    ns_islands islands = {0};
    *out = NULL;
    int status = ns_system_check(s, fault);
    if (status == NS_OK)
        status = ns_system_partition(s, &islands);
    if (status != NS_OK || islands.count == 0)
        return status;
    ns_partition_run *f = calloc(1, sizeof *f);
    if (!f) {
        ns_system_partition_free(&islands);
        return NS_E_MEMORY;
    }
    f->engine.table = &table;
    f->s = s;
    f->islands = islands;
    f->failed = -1;
    status = make_runs(f, o);
    if (status != NS_OK) {
        free_run(&f->engine);
        return status;
    }
    *out = &f->engine;
    return NS_OK;
}
