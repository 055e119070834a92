/* src/sparse/chatter.c - changes of pairs and Euler steps, counted: too many within one step are chatter. */
#include "sparse_internal.h"

#include <string.h>

/* So many within the length of a step are chatter. */
enum { MOST_FLIPS = 1000, MOST_EULERS = 64 };

static void copy_counts(const ns_sparse *m, const ns_sparse_chatter *from, ns_sparse_chatter *to) {
    const size_t pairs = (size_t)m->f->m;
    memcpy(to->flips, from->flips, sizeof(int) * pairs);
    memcpy(to->flip_t, from->flip_t, sizeof(double) * pairs);
    to->euler_t = from->euler_t;
    to->eulers = from->eulers;
}

void ns_sparse_chatter_reset(ns_sparse *m) {
    for (int j = 0; j < m->f->m; j++)
        m->chatter.flip_t[j] = -INFINITY;
    m->chatter.euler_t = -INFINITY;
    m->chatter.eulers = 0;
    copy_counts(m, &m->chatter, &m->accepted_chatter);
    m->chatter_changed = 0;
}

void ns_sparse_chatter_accept(ns_sparse *m) {
    if (m->chatter_changed)
        copy_counts(m, &m->chatter, &m->accepted_chatter);
    m->chatter_changed = 0;
}

void ns_sparse_chatter_drop(ns_sparse *m) {
    if (m->chatter_changed)
        copy_counts(m, &m->accepted_chatter, &m->chatter);
    m->chatter_changed = 0;
}

int ns_sparse_chatter_event(ns_sparse *m, const ns_dense_step *step, double t) {
    const double h = ldexp(m->o.h, -step->next_exponent);
    int status = NS_OK;
    for (int j = 0; j < m->f->m; j++) {
        if (m->mode[j] == step->mode[j])
            continue;
        if (!(t - m->chatter.flip_t[j] <= h)) {
            m->chatter.flip_t[j] = t;
            m->chatter.flips[j] = 0;
        }
        m->chatter_changed = 1;
        if (++m->chatter.flips[j] > MOST_FLIPS)
            status = NS_E_LIMIT;
    }
    return status;
}

int ns_sparse_chatter_euler(ns_sparse *m, const ns_dense_step *step, double t) {
    if (!(t - m->chatter.euler_t <= ldexp(m->o.h, -step->length_exponent))) {
        m->chatter.euler_t = t;
        m->chatter.eulers = 0;
    }
    m->chatter_changed = 1;
    return ++m->chatter.eulers > MOST_EULERS ? NS_E_LIMIT : NS_OK;
}
