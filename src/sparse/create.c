/* src/sparse/create.c - the marcher for large circuits: made, freed. */
#include "sparse_internal.h"
#include <math.h>
#include <stdlib.h>

enum { LEGS = sizeof((ns_sparse *)0)->leg / sizeof(ns_dense_step) };

static int make_leg(const ns_form *f, ns_dense_step *leg) {
    const size_t n = (size_t)f->n, size = (size_t)f->size, nz = (size_t)f->nz, s = NS_STAGES;
    leg->xi = calloc(s * size + (s + 1) * n + s * nz + 1, sizeof(double));
    leg->mode = calloc((size_t)f->m + 1, 1);
    if (!leg->xi || !leg->mode)
        return NS_E_MEMORY;
    leg->dw = leg->xi + s * size;
    leg->z = leg->dw + (s + 1) * n;
    return NS_OK;
}

static double *take(double **from, int count) {
    double *first = *from;
    *from += count;
    return first;
}

static int allocate(ns_sparse *m) {
    const int n = m->f->n, pairs = m->f->m, size = m->f->size;
    const size_t count = (size_t)(14 * n + 4 * pairs + 5 * size + 2 * m->f->nz) + 1;
    double *all = calloc(count, sizeof(double));
    m->w = all;
    m->mode = calloc(7 * (size_t)pairs + 2 * (size_t)m->s->nc + 1, 1);
    m->crowd = calloc(2 * (size_t)pairs + 1, sizeof(int));
    m->fine = calloc((size_t)size + 1, sizeof(long double));
    m->guesses = 8 * (size_t)pairs + 61;
    m->guess = calloc(m->guesses, sizeof *m->guess);
    if (!all || !m->mode || !m->crowd || !m->fine || !m->guess)
        return NS_E_MEMORY;
    m->old_mode = m->mode + pairs;
    m->shown = m->old_mode + pairs;
    m->own_mode = m->shown + pairs;
    m->flip = (unsigned char *)(m->own_mode + pairs);
    m->touched = m->flip + pairs;
    m->changed = m->touched + pairs;
    m->event_changed = m->changed + m->s->nc;
    m->event_mode = (ns_mode *)(m->event_changed + m->s->nc);
    m->w = take(&all, n);
    m->next_w = take(&all, n);
    m->before_w = take(&all, n);
    m->right_w = take(&all, n);
    m->gone = take(&all, n);
    m->finer_gone = take(&all, n);
    m->event_w = take(&all, n);
    m->scale = take(&all, 3 * n);
    m->unit = take(&all, n);
    m->kept_scale = take(&all, n);
    m->share = take(&all, n);
    m->rate = take(&all, n);
    m->l = take(&all, pairs);
    m->u = take(&all, pairs);
    m->crowd_t = take(&all, 2 * pairs);
    m->v = take(&all, size);
    m->r = take(&all, size);
    m->next_v = take(&all, size);
    m->rest = take(&all, size);
    m->fine_v = take(&all, size);
    m->z = take(&all, m->f->nz);
    m->z_none = take(&all, m->f->nz);
    int status = NS_OK;
    for (int i = 0; i < LEGS && status == NS_OK; i++)
        status = make_leg(m->f, &m->leg[i]);
    return status;
}

static void set_units(ns_sparse *m) {
    for (int i = 0; i < m->f->n; i++) {
        double most = 0;
        for (int k = m->f->Mt.start[i]; k < m->f->Mt.start[i + 1]; k++)
            most = fmax(most, fabs(m->f->Mt.value[k]));
        m->unit[i] = sqrt(most);
    }
}

static int make(ns_sparse *m, const ns_system *s) {
    int status = ns_sparse_output_create(s, &m->aside);
    m->s = status == NS_OK ? &m->aside->rest : s;
    if (status == NS_OK)
        status = ns_sparse_form_create(m->s, 0, &m->f);
    if (status == NS_OK)
        status = ns_sparse_factors_create(m->f, m->o.bytes, &m->q);
    if (status == NS_OK)
        status = ns_inputs_stages_create(m->s, &m->in);
    if (status == NS_OK)
        status = ns_sparse_shared_find(m->s, m->f, &m->twin, &m->twins);
    if (status == NS_OK)
        status = ns_sparse_factors_shared(m->q, m->twin, m->twins);
    if (status == NS_OK)
        status = allocate(m);
    if (status != NS_OK)
        return status;
    set_units(m);
    return ns_sparse_theta_create(m);
}

int ns_sparse_create(const ns_system *s, const ns_sparse_options *o, ns_sparse **out, ns_fault *fault) {
    if (!out)
        return NS_E_NULL;
    *out = NULL;
    if (!s || !o)
        return NS_E_NULL;
    if (!(o->h > 0) || !isfinite(o->h) || !(o->reltol >= 0) || !isfinite(o->reltol) ||
        !(o->theta >= 0 && o->theta <= 1))
        return NS_E_RANGE;
    int status = ns_system_check(s, fault);
    if (status != NS_OK)
        return status;
    ns_sparse *m = calloc(1, sizeof *m);
    if (!m)
        return NS_E_MEMORY;
    m->o = *o;
    m->o.reltol = o->reltol > 0 ? o->reltol : 1e-9;
    m->o.bytes = o->bytes ? o->bytes : (size_t)64 << 20;
    m->fault.t = NAN;
    status = make(m, s);
    if (status != NS_OK) {
        ns_sparse_free(m);
        return status;
    }
    *out = m;
    return NS_OK;
}

void ns_sparse_free(ns_sparse *m) {
    if (!m)
        return;
    for (int i = 0; i < LEGS; i++) {
        free(m->leg[i].xi);
        free(m->leg[i].mode);
    }
    free(m->w);
    free(m->mode);
    free(m->crowd);
    free(m->twin);
    free(m->fine);
    free(m->guess);
    ns_sparse_theta_free(m);
    ns_inputs_stages_free(m->in);
    ns_sparse_factors_free(m->q);
    ns_sparse_form_free(m->f);
    ns_sparse_output_free(m->aside);
    free(m);
}
