/* src/sparse/chatter.c - changes of pairs and Euler steps, counted: too many within one step are chatter. */
#include "sparse_internal.h"

#include <string.h>

/* So many within the length of a step are chatter. */
enum { MOST_FLIPS = 1000, MOST_EULERS = 64 };

static void copy_counts(const ns_sparse *m, const ns_sparse_chatter *from, ns_sparse_chatter *to) {
    memcpy(to->flips, from->flips, sizeof *to->flips * (size_t)m->f->m);
    to->eulers = from->eulers;
}

void ns_sparse_chatter_reset(ns_sparse *m) {
    memset(m->chatter.flips, 0, sizeof *m->chatter.flips * (size_t)m->f->m);
    m->chatter.eulers = (ns_event_window){0, 0};
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
        m->chatter_changed = 1;
        if (ns_events_count(&m->chatter.flips[j], t, h) > MOST_FLIPS)
            status = NS_E_LIMIT;
    }
    return status;
}

int ns_sparse_chatter_euler(ns_sparse *m, const ns_dense_step *step, double t) {
    const double h = ldexp(m->o.h, -step->length_exponent);
    m->chatter_changed = 1;
    return ns_events_count(&m->chatter.eulers, t, h) > MOST_EULERS ? NS_E_LIMIT : NS_OK;
}
