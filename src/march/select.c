/* src/march/select.c - which engine goes the way. */
#include "exact/exact_internal.h"
#include "sparse/sparse.h"
#include "system/dense_copy.h"

#include <math.h>
#include <stdlib.h>

/* Matrices of modes, with their few states, are fastest up to so many unknowns; then one sparse factor is. */
enum { EXACT_MOST = 64 };
/* h is what the scheme needs for its accuracy; legs of the sparse engine, which knows its errors, may be so
 * many times as long. */
enum { RUNGS = 6, AT_MOST = 1 << RUNGS };
/* Unknowns and pairs up to which large systems are also written out for the dense engines, which get slow. */
enum { DENSE_MOST = 1500 };

static int too_large(const ns_system *s) {
    return s->large && s->n + s->m > DENSE_MOST;
}

static int allocate(ns_march *m) {
    const size_t nz = (size_t)m->s->nz, nc = (size_t)m->s->nc;
    m->past = calloc(ns_theta_past_size(m->step) + 1, sizeof(double));
    m->z = calloc(nz + 1, sizeof(double));
    m->z_left = calloc(nz + 1, sizeof(double));
    m->flip = calloc(nc + 1, 1);
    m->due = calloc(nc + 1, 1);
    m->crossed = calloc(nc + 1, 1);
    m->kept_flip = calloc(nc + 1, 1);
    m->closed = calloc(nc + 1, 1);
    const int made =
        m->past && m->z && m->z_left && m->flip && m->due && m->crossed && m->kept_flip && m->closed;
    return made ? ns_reinit_jump_create(m->step, &m->jump) : NS_E_MEMORY;
}

static int make_dense(ns_march *m, ns_fault *fault) {
    const ns_march_options *o = &m->options;
    const ns_theta_options options = {o->theta, o->gamma, o->map_bytes};
    int status = too_large(m->s) ? NS_E_SIZE : NS_OK;
    if (status == NS_OK && m->s->large)
        status = ns_system_check(m->s, fault);
    if (status == NS_OK && m->s->large)
        status = ns_system_dense_copy(m->s, &m->own);
    if (m->own)
        m->s = m->own;
    if (status == NS_OK)
        status = ns_theta_create(m->s, &options, &m->step, fault);
    if (status == NS_OK)
        status = allocate(m);
    if (status == NS_OK && o->method != NS_THETA)
        status = ns_exact_create(m, &m->exact);
    return status;
}

/* The scheme by sparse factors: with one matrix for theta and gamma. */
static int steps_sparsely(const ns_march_options *o) {
    return o->method == NS_THETA && o->theta > 0 && o->theta <= 1 && o->theta == o->gamma;
}

/* theta: of the scheme's steps; 0: legs. */
static ns_sparse_options sparse_options(const ns_march_options *o, double theta) {
    const int rungs = o->method == NS_AUTO ? RUNGS : 0;
    return (ns_sparse_options){.h = ldexp(o->h, rungs),
                               .reltol = theta > 0 ? 0 : o->reltol,
                               .bytes = o->map_bytes,
                               .finer = rungs,
                               .theta = theta};
}

int ns_march_make_engines(ns_march *m, ns_fault *fault) {
    const ns_march_options *o = &m->options;
    const int large = m->s->large || m->s->n + m->s->m > EXACT_MOST;
    const int steps = steps_sparsely(o) && (too_large(m->s) || o->capture);
    if (o->method == NS_SPARSE || (o->method == NS_AUTO && large) || steps) {
        const ns_sparse_options options = sparse_options(o, steps ? o->theta : 0);
        return ns_sparse_create(m->s, &options, &m->sparse, fault);
    }
    return make_dense(m, fault);
}

int ns_march_leaves_sparse(const ns_march *m, int status) {
    const int refused = status == NS_E_SINGULAR || status == NS_E_INFEASIBLE || status == NS_E_LIMIT ||
                        status == NS_E_RESIDUAL || status == NS_E_OVERFLOW;
    return refused && m->options.method != NS_SPARSE && !too_large(m->s);
}

void ns_march_sum_counts(const ns_march *m, ns_counts *counts) {
    const long *before = (const long *)(const void *)&m->before;
    long *sum = (long *)(void *)counts;
    for (size_t i = 0; i < sizeof *counts / sizeof *sum; i++)
        sum[i] += before[i];
}

void ns_march_free_dense(ns_march *m) {
    ns_exact_free(m->exact);
    ns_theta_free(m->step);
    ns_reinit_jump_free(&m->jump);
    m->jump = (ns_jump){0};
    m->exact = NULL;
    m->step = NULL;
    free(m->past);
    free(m->z);
    free(m->z_left);
    free(m->flip);
    free(m->due);
    free(m->crossed);
    free(m->kept_flip);
    free(m->closed);
    m->past = m->z = m->z_left = NULL;
    m->flip = m->due = m->crossed = m->kept_flip = m->closed = NULL;
}

/* The counts so far, before one engine goes and another begins at zero. */
static void keep_counts(ns_march *m) {
    m->before = *ns_march_counts(m);
    m->counts = (ns_counts){0};
    m->events = m->seen_events = m->seen_modes = 0;
}

/* The sparse engine may be asked again four times as much later as the last time. */
static void put_off(ns_march *m, double t) {
    m->pause = m->pause > 0 ? 4 * m->pause : AT_MOST * m->h;
    m->back = t + m->pause;
}

int ns_march_use_dense(ns_march *m, double t) {
    ns_sparse *const was = m->sparse;
    keep_counts(m);
    const int status = make_dense(m, &m->fault);
    if (status == NS_OK) {
        ns_sparse_free(was);
        m->sparse = NULL;
        put_off(m, t);
    } else
        ns_march_free_dense(m);
    return status;
}

/* The accepted point, as charges and fluxes (n) and commands that are closed (nc), in one block. */
static int read_point(ns_march *m, double *t, double **w, unsigned char **closed) {
    const size_t n = (size_t)m->s->n;
    double *x = calloc(2 * n + 1, sizeof *x);
    *closed = calloc((size_t)m->s->nc + 1, 1);
    *w = x;
    const int status = x && *closed ? ns_march_read(m, t, x + n, NULL, NULL) : NS_E_MEMORY;
    for (int c = 0; *closed && c < m->s->nc; c++)
        (*closed)[c] = ns_march_mode(m)[m->s->command[c].pair] == NS_INSIDE;
    if (status == NS_OK)
        ns_system_charges(m->s, x + n, x);
    return status;
}

int ns_march_leave_sparse(ns_march *m) {
    double t, *w;
    unsigned char *closed;
    int status = read_point(m, &t, &w, &closed);
    if (status == NS_OK)
        status = ns_march_use_dense(m, t);
    if (status == NS_OK)
        status = ns_march_start_as(m, t, w, closed);
    free(closed);
    free(w);
    return status;
}

/* Of the events since this was last looked at, most came to modes that matrices had to be made for; the first
 * ones do in any circuit. */
static int modes_do_not_recur(ns_march *m) {
    enum { ENOUGH = 64, FEW = 24 };
    if (m->s->n + m->s->m < FEW)
        return 0;
    const ns_counts *c = ns_theta_counts(m->step);
    const long events = m->events - m->seen_events, modes = c->modes - m->seen_modes;
    const int first = m->seen_events == 0;
    if (events < ENOUGH)
        return 0;
    m->seen_events = m->events;
    m->seen_modes = c->modes;
    return !first && 2 * modes > events;
}

/* Where the dense engines have come to, the sparse one begins; it may refuse. */
static int hand_over(ns_march *m) {
    const ns_sparse_options options = sparse_options(&m->options, 0);
    double t, *w;
    unsigned char *closed;
    ns_sparse *sparse = NULL;
    int status = read_point(m, &t, &w, &closed);
    if (status == NS_OK)
        status = ns_sparse_create(m->s, &options, &sparse, NULL);
    if (status == NS_OK)
        status = ns_sparse_start_as(sparse, t, w, closed);
    free(closed);
    free(w);
    if (status != NS_OK) {
        ns_sparse_free(sparse);
        return status;
    }
    keep_counts(m);
    ns_march_free_dense(m);
    m->sparse = sparse;
    return NS_OK;
}

int ns_march_hands_over(const ns_march *m) {
    enum { OFTEN = 64 };
    return m->options.method == NS_AUTO && m->pause == 0 && !m->kept.at_event && m->exact &&
           m->exact->timed && m->exact->past.stuck >= OFTEN;
}

void ns_march_return_to_sparse(ns_march *m) {
    if (m->options.method != NS_AUTO || !m->started || m->has_trial || m->kept.at_event)
        return;
    const int due = m->kept.t >= m->back;
    if (!due && !(m->pause == 0 && m->exact && (m->tired || modes_do_not_recur(m))))
        return;
    m->tired = 0;
    if (hand_over(m) != NS_OK)
        put_off(m, m->kept.t);
}
