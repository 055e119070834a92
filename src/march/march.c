/* src/march/march.c - the public calls: of one run, or of one for each island. */
#include "march_internal.h"

#include <math.h>
#include <stdlib.h>

int ns_march_create(const ns_system *s, const ns_march_options *o, ns_march **out, ns_fault *fault) {
    if (!out)
        return NS_E_NULL;
    *out = NULL;
    if (!s || !o)
        return NS_E_NULL;
    if (!(o->h > 0) || !isfinite(o->h))
        return NS_E_RANGE;
    ns_march *m = calloc(1, sizeof *m);
    if (!m)
        return NS_E_MEMORY;
    m->s = s;
    m->corner = calloc((size_t)s->nz + 1, sizeof *m->corner);
    m->closed = calloc((size_t)s->nc + 1, sizeof *m->closed);
    int status = m->corner && m->closed ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK && !o->whole && o->method != NS_THETA)
        status = ns_march_partition_create(s, o, &m->engine, fault);
    if (status == NS_OK && !m->engine)
        status = ns_march_run_create(s, o, &m->engine, fault);
    if (status != NS_OK) {
        ns_march_free(m);
        return status;
    }
    *out = m;
    return NS_OK;
}

void ns_march_free(ns_march *m) {
    if (m && m->engine)
        m->engine->table->free(m->engine);
    if (m) {
        free(m->corner);
        free(m->closed);
    }
    free(m);
}

/* No corner of an input is known, and t0 is where it starts, or a little before. */
static void begin_at(ns_march *m, double t0) {
    m->accepted = t0;
    m->corners_from = INFINITY;
}

int ns_march_start(ns_march *m, double t0, const double *w0) {
    return ns_march_start_as(m, t0, w0, NULL);
}

int ns_march_start_as(ns_march *m, double t0, const double *w0, const ns_mode *mode) {
    if (!m || (!w0 && m->s->n > 0))
        return NS_E_NULL;
    begin_at(m, t0);
    for (int c = 0; mode && c < m->s->nc; c++)
        m->closed[c] = mode[m->s->command[c].pair] == NS_INSIDE;
    return m->engine->table->start(m->engine, t0, w0, mode ? m->closed : NULL);
}

int ns_march_start_dc(ns_march *m, double t0, int nhold, const int *hold, const double *hold_x, double *x) {
    if (!m || (nhold > 0 && (!hold || !hold_x)))
        return NS_E_NULL;
    begin_at(m, t0);
    return m->engine->table->start_dc(m->engine, t0, nhold, hold, hold_x, x);
}

/* The first corner of any input after the accepted point. */
static double find_corner(ns_march *m) {
    if (m->accepted >= m->corners_from && m->accepted < m->first_corner)
        return m->first_corner;
    const int anew = !(m->accepted >= m->corners_from);
    m->first_corner = INFINITY;
    for (int k = 0; k < m->s->nz; k++) {
        if (anew || m->corner[k] <= m->accepted)
            m->corner[k] = ns_signal_next_corner(&m->s->z[k], m->accepted);
        m->first_corner = fmin(m->first_corner, m->corner[k]);
    }
    m->corners_from = m->accepted;
    return m->first_corner;
}

/* A start may end some steps of h/2^20 after t0, beyond a corner: that one does not count then. */
static int try_step(ns_march *m, double t, double *reached) {
    enum { MOST = 4 };
    int status = NS_E_RANGE;
    for (int k = 0; k < MOST && status == NS_E_RANGE; k++) {
        const double corner = find_corner(m);
        status = m->engine->table->try_to(m->engine, fmin(t, corner), NS_TO_STEP, reached);
        if (!(corner < t))
            break;
        if (status == NS_E_RANGE)
            m->accepted = corner;
    }
    return status;
}

int ns_march_try(ns_march *m, double t, ns_until until, double *reached) {
    if (!m || !reached)
        return NS_E_NULL;
    const int status = until == NS_TO_STEP && t > m->accepted
                           ? try_step(m, t, reached)
                           : m->engine->table->try_to(m->engine, t, until, reached);
    if (status == NS_OK)
        m->reached = *reached;
    return status;
}

int ns_march_accept(ns_march *m) {
    const int status = m ? ns_engine_accept(m->engine) : NS_E_NULL;
    if (status == NS_OK)
        m->accepted = m->reached;
    return status;
}

int ns_march_read(ns_march *m, double *t, double *x, double *lambda, double *y) {
    return m ? ns_engine_read(m->engine, t, x, lambda, y) : NS_E_NULL;
}

int ns_march_impulse(ns_march *m, double *x, double *lambda) {
    return m ? ns_engine_impulse(m->engine, x, lambda) : NS_E_NULL;
}

const ns_mode *ns_march_mode(const ns_march *m) {
    return ns_engine_mode(m->engine);
}

int ns_march_at_event(const ns_march *m) {
    return ns_engine_at_event(m->engine);
}

ns_method ns_march_engine(const ns_march *m) {
    return ns_engine_method(m->engine);
}

const ns_counts *ns_march_counts(ns_march *m) {
    return m->engine->table->counts(m->engine);
}

int ns_march_sample(ns_march *m, double t, double *x, double *lambda) {
    return m ? ns_engine_sample(m->engine, t, x, lambda) : NS_E_NULL;
}

double ns_march_shortest(ns_march *m, double t, double *until) {
    double ignored;
    return ns_engine_shortest(m->engine, t, until ? until : &ignored);
}

int ns_march_problem(const ns_march *m, ns_mlcp *p, double *h) {
    return m && p ? ns_engine_problem(m->engine, p, h) : NS_E_NULL;
}

const ns_fault *ns_march_fault(const ns_march *m) {
    return ns_engine_fault(m->engine);
}
