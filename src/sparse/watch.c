/* src/sparse/watch.c - the point of a trial that is being made, shown to who judges it (engine/watch.h). */
#include "sparse_internal.h"
#include "step.h"

#include <string.h>

/* By the stages that the step has; not what is output_only. */
static void read_some(ns_sparse *m, double *x, double *lambda) {
    const ns_output_only *o = m->output_only;
    ns_sparse_step_point(m, m->trial.step, m->trial.tau, m->inside.v);
    if (o->count == 0)
        memcpy(x, m->inside.v, sizeof *x * (size_t)m->f->n);
    for (int i = 0; o->count > 0 && i < m->f->n; i++)
        x[o->stays[i]] = m->inside.v[i];
    memcpy(lambda, m->inside.v + m->f->n, sizeof *lambda * (size_t)m->f->m);
}

/* By one more stage, as ns_sparse_read(). */
static int read_all(ns_sparse *m, ns_side side, double *x, double *lambda) {
    const ns_sparse_point *at = &m->trial;
    const int status = ns_sparse_step_shown(m, at->step, at->tau, m->inside.v);
    if (status != NS_OK)
        return status;
    for (int k = 0; k < m->f->nz; k++)
        m->inside.z[k] = ns_signal_value(&m->s->z[k], at->t, side);
    ns_sparse_output_join(m->output_only, m->inside.v, m->inside.z, x);
    memcpy(lambda, m->inside.v + m->f->n, sizeof(double) * (size_t)m->f->m);
    return NS_OK;
}

int ns_sparse_peek(ns_engine *e, double *x, double *lambda) {
    ns_sparse *m = ns_sparse_of(e);
    if (!m->started || m->o.theta > 0)
        return NS_E_STATE;
    read_some(m, x, lambda);
    return NS_OK;
}

void ns_sparse_watch(ns_engine *e, const ns_watch *w) {
    ns_sparse_of(e)->watch = w;
}

/* What jumped so far. */
static int tell(ns_sparse *m, ns_watch_side side) {
    const ns_watch *w = m->watch;
    if (*w->jumped)
        (void)ns_sparse_impulse(&m->engine, w->X, w->Lambda);
    return w->sees(w->data, side, m->trial.t);
}

int ns_sparse_watch_show(ns_sparse *m, ns_watch_side side) {
    const ns_watch *w = m->watch;
    if (w)
        *w->jumped = m->instant.any;
    const ns_watch_part part = ns_watch_wants(w, side, m->trial.step->mode);
    if (part == NS_WATCH_NOTHING)
        return NS_OK;
    if (part == NS_WATCH_SOME) {
        read_some(m, w->x, w->lambda);
        const int seen = tell(m, side);
        if (seen != NS_GUARD)
            return seen;
    }
    const int status = read_all(m, side == NS_WATCH_LEFT ? NS_LEFT : NS_RIGHT, w->x, w->lambda);
    return status == NS_OK ? tell(m, side) : status;
}
