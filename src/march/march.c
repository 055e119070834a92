/* src/march/march.c - the public calls: of one run, or of one for each island. */
#include "march_internal.h"
#include "system/active_inputs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int make_engine(ns_march *m, const ns_march_options *o, ns_fault *fault) {
    const ns_system *s = m->s;
    m->corner = calloc((size_t)s->nz + 1, sizeof *m->corner);
    m->closed = calloc((size_t)s->nc + 1, sizeof *m->closed);
    m->followed = calloc((size_t)s->nz + 1, 1);
    int status = m->corner && m->closed && m->followed ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK)
        memset(m->followed, 1, (size_t)s->nz);
    if (status == NS_OK && !o->whole && o->method != NS_THETA)
        status = ns_march_partition_create(s, o, &m->engine, fault);
    if (status == NS_OK && !m->engine)
        status = ns_march_run_create(s, o, &m->engine, fault);
    return status;
}

static int create(const ns_system *s, const ns_march_options *o, ns_march **out, ns_fault *fault) {
    if (!s || !o || !out)
        return NS_E_NULL;
    if (!(o->h > 0) || !isfinite(o->h))
        return NS_E_RANGE;
    ns_march *m = calloc(1, sizeof *m);
    if (!m)
        return NS_E_MEMORY;
    m->s = s;
    const int status = make_engine(m, o, fault);
    if (status == NS_OK)
        *out = m;
    else
        ns_march_free(m);
    return status;
}

int ns_march_create(const ns_system *s, const ns_march_options *o, ns_march **out, ns_fault *fault) {
    ns_fault found = {.t = NAN};
    if (out)
        *out = NULL;
    const int status = create(s, o, out, &found);
    found.status = status;
    if (status != NS_OK && fault)
        *fault = found;
    return status;
}

void ns_march_free(ns_march *m) {
    if (m && m->engine)
        m->engine->table->free(m->engine);
    if (m) {
        ns_march_watched_free(m);
        free(m->corner);
        free(m->closed);
        free(m->followed);
    }
    free(m);
}

int ns_march_look_at(ns_march *m, const unsigned char *looked) {
    if (!m)
        return NS_E_NULL;
    m->corners_from = INFINITY;
    if (looked)
        return ns_system_followed_inputs(m->s, looked, m->followed);
    memset(m->followed, 1, (size_t)m->s->nz);
    return NS_OK;
}

/* No corner of an input is known, and t0 is where it starts, or a little before. */
static void begin_at(ns_march *m, double t0) {
    m->accepted = t0;
    m->corners_from = INFINITY;
    ns_march_watched_free(m);
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

int ns_march_try(ns_march *m, double t, ns_until until, double *reached) {
    if (!m || !reached)
        return NS_E_NULL;
    return m->watched ? ns_march_watched_try(m, t, until, reached)
                      : ns_march_try_unwatched(m, t, until, reached);
}

int ns_march_accept(ns_march *m) {
    const int status = m ? ns_engine_accept(m->engine) : NS_E_NULL;
    if (status == NS_OK)
        m->accepted = m->reached;
    if (status == NS_OK && m->watched)
        ns_march_watched_accept(m);
    return status;
}

/* Left of t both signals are alike, but for rounding. */
static int joins(const ns_signal *was, const ns_signal *now, double t) {
    const double a = ns_signal_value(was, t, NS_LEFT), b = ns_signal_value(now, t, NS_LEFT);
    return fabs(a - b) <= 1e-9 * fmax(fabs(a), fabs(b));
}

int ns_march_set_input(ns_march *m, int input, const ns_signal *signal) {
    double t;
    if (!m || !signal)
        return NS_E_NULL;
    if (input < 0 || input >= m->s->nz)
        return NS_E_SIZE;
    int status = ns_signal_check(signal);
    if (status != NS_OK)
        return status;
    ns_engine_drop(m->engine);
    status = ns_engine_read(m->engine, &t, NULL, NULL, NULL);
    if (status != NS_OK)
        return status;
    m->accepted = t;
    if (signal->kind != NS_PWL || m->s->z[input].kind != NS_PWL || !joins(&m->s->z[input], signal, t))
        return NS_E_RANGE;
    status = ns_system_set_input((ns_system *)m->s, input, signal);
    if (status == NS_OK)
        status = m->engine->table->set_input(m->engine, input, signal);
    m->corners_from = INFINITY;
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
    const ns_counts *counts = m->engine->table->counts(m->engine);
    const long looks = m->counts.looks;
    if (looks == 0)
        return counts;
    m->counts = *counts;
    m->counts.looks = looks;
    return &m->counts;
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
