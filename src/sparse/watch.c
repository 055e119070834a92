/* src/sparse/watch.c - the point of a trial that is being made, shown to who judges it (engine/watch.h). */
#include "sparse_internal.h"

#include <string.h>

/* v (n+m) where a step begins: all Laguerre's polynomials are 1 (E1). */
static void point_at_begin(const ns_sparse *m, const ns_dense_step *step, double *v) {
    const int stages = step->stages < NS_ORDER ? step->stages : NS_ORDER, size = m->f->size;
    memcpy(v, step->images, sizeof *v * (size_t)size);
    for (int i = 1; i < stages; i++) {
        const double *image = step->images + (size_t)i * (size_t)size;
        if (i % 2)
            for (int k = 0; k < size; k++)
                v[k] -= image[k];
        else
            for (int k = 0; k < size; k++)
                v[k] += image[k];
    }
}

/* By the stages that the step has; not what is output_only. */
static void read_pairs(ns_sparse *m, double *x, double *lambda) {
    const ns_output_only *o = m->output_only;
    if (m->trial.tau == 0 && !m->trial.step->is_euler)
        point_at_begin(m, m->trial.step, m->inside.v);
    else
        ns_sparse_step_point(m, m->trial.step, m->trial.tau, m->inside.v);
    for (int i = 0; i < m->f->n; i++)
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

int ns_sparse_watch_show(ns_sparse *m, ns_watch_side side) {
    const ns_watch *w = m->watch;
    const ns_watch_part part = ns_watch_wants(w, side, m->trial.step->mode);
    if (part == NS_WATCH_NOTHING)
        return NS_OK;
    if (part == NS_WATCH_PAIRS) {
        read_pairs(m, w->x, w->lambda);
        const int seen = w->sees(w->data, side, m->trial.t);
        if (seen != NS_GUARD)
            return seen;
    }
    int status = read_all(m, side == NS_WATCH_LEFT ? NS_LEFT : NS_RIGHT, w->x, w->lambda);
    if (status == NS_OK)
        status = ns_sparse_impulse(m, w->X, w->Lambda);
    return status == NS_OK ? w->sees(w->data, side, m->trial.t) : status;
}
