/* src/march/partition_run.c - marchers side by side: made, started, read. */
#include "partition_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* For what islands keep of their modes, all together: twice what one marcher has. */
static const size_t shared_bytes = (size_t)64 << 20;

/* --- made and freed --- */

static int allocate(ns_partition_run *f) {
    const size_t n = (size_t)f->s->n, m = (size_t)f->s->m;
    f->ship = calloc((size_t)f->islands.count, sizeof *f->ship);
    f->numbers = calloc(n + 2 * m + 1, sizeof(double));
    f->mode = calloc(m + 1, sizeof *f->mode);
    f->seen = calloc(n + 1, 1);
    if (!f->ship || !f->numbers || !f->mode || !f->seen)
        return NS_E_MEMORY;
    f->x = f->numbers;
    f->lambda = f->x + n;
    f->y = f->lambda + m;
    return NS_OK;
}

/* A fault of an island, in indices of the whole. */
static void translate(const ns_island *i, ns_fault *fault) {
    for (int k = 0; k < fault->npairs; k++)
        fault->pair[k] = i->pair[fault->pair[k]];
    for (int k = 0; k < fault->nunknowns; k++)
        fault->unknown[k] = i->unknown[fault->unknown[k]];
}

static void keep_fault(ns_partition_run *f, int ship) {
    f->fault = *ns_march_fault(f->ship[ship].march);
    translate(f->ship[ship].island, &f->fault);
    f->failed = ship;
}

int ns_march_partition_fail(ns_partition_run *f, int ship, int status) {
    keep_fault(f, ship);
    f->has_trial = 0;
    return status;
}

int ns_march_partition_fail_here(ns_partition_run *f, int status) {
    f->fault = (ns_fault){.status = (ns_status)status, .t = f->kept};
    f->failed = -1;
    return status;
}

static int launch(ns_partition_run *f, const ns_march_options *o, ns_fault *fault) {
    ns_march_options each = *o;
    int status = allocate(f);
    each.whole = 1;
    each.map_bytes = (o->map_bytes ? o->map_bytes : shared_bytes) / (size_t)f->islands.count;
    for (int k = 0; k < f->islands.count && status == NS_OK; k++) {
        ship *s = &f->ship[k];
        s->island = &f->islands.island[k];
        status = ns_march_create(s->island->s, &each, &s->march, fault);
        if (status != NS_OK && fault)
            translate(s->island, fault);
    }
    return status;
}

int ns_march_partition_create(const ns_system *s, const ns_march_options *o, ns_partition_run **out,
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
    f->s = s;
    f->islands = islands;
    f->failed = -1;
    status = launch(f, o, fault);
    if (status != NS_OK) {
        ns_march_partition_free(f);
        return status;
    }
    *out = f;
    return NS_OK;
}

void ns_march_partition_free(ns_partition_run *f) {
    if (!f)
        return;
    for (int k = 0; f->ship && k < f->islands.count; k++)
        ns_march_free(f->ship[k].march);
    ns_system_partition_free(&f->islands);
    free(f->ship);
    free(f->numbers);
    free(f->mode);
    free(f->seen);
    free(f);
}

/* --- started --- */

static int begin(ns_partition_run *f) {
    f->kept = -INFINITY;
    f->started = 0;
    for (int k = 0; k < f->islands.count; k++) {
        ship *s = &f->ship[k];
        const int status = ns_march_read(s->march, &s->kept, NULL, NULL, NULL);
        if (status != NS_OK)
            return ns_march_partition_fail(f, k, status);
        s->live = s->seen = s->kept;
        s->at_event = s->tried = s->event = 0;
        f->kept = fmax(f->kept, s->kept);
    }
    f->live = f->kept;
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

int ns_march_partition_start(ns_partition_run *f, double t0, const double *w0) {
    memset(f->seen, 0, (size_t)f->s->n);
    for (int k = 0; k < f->islands.count; k++) {
        charges_of(f, k, w0);
        const int status = ns_march_start(f->ship[k].march, t0, f->x);
        if (status != NS_OK)
            return ns_march_partition_fail(f, k, status);
    }
    return begin(f);
}

static void put_unknowns(ns_partition_run *f, int island, double *x) {
    const ns_island *i = &f->islands.island[island];
    for (int k = 0; k < i->s->n; k++) {
        const int whole = i->unknown[k];
        x[whole] = f->x[k] + (f->islands.shared[whole] && f->seen[whole] ? x[whole] : 0);
        f->seen[whole] = 1;
    }
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

int ns_march_partition_start_dc(ns_partition_run *f, double t0, int nhold, const int *hold,
                                const double *hold_x, double *x) {
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
    for (int k = 0; k < f->islands.count && status == NS_OK; k++) {
        const int n = holds_of(f->ship[k].island, nhold, hold, hold_x, own, own_x);
        status = ns_march_start_dc(f->ship[k].march, t0, n, own, own_x, f->x);
        if (status != NS_OK)
            ns_march_partition_fail(f, k, status);
        else if (x)
            put_unknowns(f, k, x);
    }
    free(own);
    free(own_x);
    return status == NS_OK ? begin(f) : status;
}

/* --- read --- */

static void put_pairs(const ns_partition_run *f, int island, double *lambda, double *y) {
    const ns_island *i = &f->islands.island[island];
    for (int j = 0; j < i->s->m; j++) {
        if (lambda)
            lambda[i->pair[j]] = f->lambda[j];
        if (y)
            y[i->pair[j]] = f->y[j];
    }
}

int ns_march_partition_read(ns_partition_run *f, double *t, double *x, double *lambda, double *y) {
    int status = NS_OK;
    if (t)
        *t = f->has_trial ? f->live : f->kept;
    memset(f->seen, 0, (size_t)f->s->n);
    for (int k = 0; k < f->islands.count; k++) {
        const int read = ns_march_read(f->ship[k].march, NULL, f->x, f->lambda, f->y);
        if (read != NS_OK) {
            status = read;
            keep_fault(f, k);
        }
        if (read != NS_OK && read != NS_E_OVERFLOW) /* which is written all the same */
            return status;
        if (x)
            put_unknowns(f, k, x);
        put_pairs(f, k, lambda, y);
    }
    return status;
}

const ns_mode *ns_march_partition_mode(ns_partition_run *f) {
    for (int k = 0; k < f->islands.count; k++) {
        const ns_island *i = f->ship[k].island;
        const ns_mode *mode = ns_march_mode(f->ship[k].march);
        for (int j = 0; j < i->s->m; j++)
            f->mode[i->pair[j]] = mode[j];
    }
    return f->mode;
}

int ns_march_partition_at_event(const ns_partition_run *f) {
    int any = 0;
    for (int k = 0; k < f->islands.count; k++)
        any |= ns_march_at_event(f->ship[k].march);
    return any;
}

ns_method ns_march_partition_engine(const ns_partition_run *f) {
    ns_method worst = NS_EXACT;
    for (int k = 0; k < f->islands.count; k++) {
        const ns_method engine = ns_march_engine(f->ship[k].march);
        if (engine == NS_THETA || worst == NS_EXACT)
            worst = engine;
    }
    return worst;
}

const ns_counts *ns_march_partition_counts(ns_partition_run *f) {
    f->counts = (ns_counts){0};
    long *sum = (long *)(void *)&f->counts;
    for (int k = 0; k < f->islands.count; k++) {
        const long *own = (const long *)(const void *)ns_march_counts(f->ship[k].march);
        for (size_t i = 0; i < sizeof f->counts / sizeof *sum; i++)
            sum[i] += own[i];
    }
    f->counts.islands = f->islands.count;
    return &f->counts;
}

const ns_fault *ns_march_partition_fault(const ns_partition_run *f) {
    return &f->fault;
}

int ns_march_partition_problem(const ns_partition_run *f, ns_mlcp *p, double *h) {
    return f->failed < 0 ? NS_E_STATE : ns_march_problem(f->ship[f->failed].march, p, h);
}
