/* src/engine/choice.c - which engine goes the way. */
#include "flight.h"
#include "sparse_engine.h"

#include <stdlib.h>

/* Matrices of modes, with their few states, are fastest up to so many unknowns; then one sparse factor is. */
enum { FLIGHT_MOST = 64 };
/* h is what the scheme needs for its accuracy; legs of the sparse engine, which knows its errors, may be so
 * many times as long. */
enum { AT_MOST = 64 };

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
    return made ? ns_jump_create(m->step, &m->jump) : NS_E_MEMORY;
}

static int make_dense(ns_march *m, ns_fault *fault) {
    const ns_march_options *o = &m->options;
    const ns_theta_options options = {o->theta, o->gamma, o->map_bytes};
    int status = ns_theta_create(m->s, &options, &m->step, fault);
    if (status == NS_OK)
        status = allocate(m);
    if (status == NS_OK && o->method != NS_THETA)
        status = ns_flight_create(m, &m->flight);
    return status;
}

int ns_choice_make(ns_march *m, ns_fault *fault) {
    const ns_march_options *o = &m->options;
    const int most = m->s->n + m->s->m;
    if (o->method == NS_SPARSE || (o->method == NS_AUTO && (m->s->large || most > FLIGHT_MOST))) {
        const double h = o->method == NS_AUTO ? AT_MOST * o->h : o->h;
        const ns_sparse_options options = {h, o->reltol, o->map_bytes};
        return ns_sparse_create(m->s, &options, &m->sparse, fault);
    }
    return make_dense(m, fault);
}

int ns_choice_leaves(const ns_march *m, int status) {
    const int refused = status == NS_E_SINGULAR || status == NS_E_INFEASIBLE || status == NS_E_LIMIT ||
                        status == NS_E_RESIDUAL || status == NS_E_OVERFLOW;
    return refused && m->options.method == NS_AUTO && !m->s->large;
}

int ns_choice_dense(ns_march *m) {
    const int status = make_dense(m, &m->fault);
    if (status == NS_OK) {
        ns_sparse_free(m->sparse);
        m->sparse = NULL;
    }
    m->options.method = NS_SPARSE; /* this was asked for once */
    return status;
}

int ns_choice_leave(ns_march *m) {
    const size_t n = (size_t)m->s->n;
    double t, *x = calloc(2 * n + 1, sizeof *x);
    unsigned char *closed = calloc((size_t)m->s->nc + 1, 1);
    int status = x && closed ? ns_sparse_read(m->sparse, &t, x, NULL, NULL) : NS_E_MEMORY;
    for (int c = 0; closed && c < m->s->nc; c++)
        closed[c] = ns_sparse_mode(m->sparse)[m->s->command[c].pair] == NS_INSIDE;
    if (status == NS_OK) {
        ns_system_charges(m->s, x, x + n);
        status = ns_choice_dense(m);
    }
    if (status == NS_OK)
        status = ns_march_start_as(m, t, x + n, closed);
    free(closed);
    free(x);
    return status;
}
