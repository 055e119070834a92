/* src/sparse/table.c - the sparse engine as a table of functions (engine.h). */
#include "sparse_internal.h"

static ns_sparse *sparse_of(ns_engine *e) {
    return (ns_sparse *)(void *)e;
}

static const ns_sparse *sparse_in(const ns_engine *e) {
    return (const ns_sparse *)(const void *)e;
}

static void free_engine(ns_engine *e) {
    ns_sparse_free(sparse_of(e));
}

static int start(ns_engine *e, double t0, const double *w0, const unsigned char *closed) {
    return ns_sparse_start_as(sparse_of(e), t0, w0, closed);
}

static int start_dc(ns_engine *e, double t0, int nhold, const int *hold, const double *hold_x, double *x) {
    return ns_sparse_start_dc(sparse_of(e), t0, nhold, hold, hold_x, x);
}

static int try_to(ns_engine *e, double t, ns_until until, double *reached) {
    return ns_sparse_try(sparse_of(e), t, until, reached);
}

static void drop(ns_engine *e) {
    ns_sparse_drop(sparse_of(e));
}

static int accept_trial(ns_engine *e) {
    return ns_sparse_accept(sparse_of(e));
}

static int read_point(ns_engine *e, double *t, double *x, double *lambda, double *y) {
    return ns_sparse_read(sparse_of(e), t, x, lambda, y);
}

static int impulse(ns_engine *e, double *x, double *lambda) {
    return ns_sparse_impulse(sparse_of(e), x, lambda);
}

static int sample(ns_engine *e, double t, double *x, double *lambda) {
    return ns_sparse_sample(sparse_of(e), t, x, lambda);
}

static double shortest(ns_engine *e, double t, double *until) {
    return ns_sparse_shortest(sparse_of(e), t, until);
}

static const ns_mode *mode_of(ns_engine *e) {
    return ns_sparse_mode(sparse_of(e));
}

static int at_event(const ns_engine *e) {
    return ns_sparse_at_event(sparse_in(e));
}

static ns_method method(const ns_engine *e) {
    return sparse_in(e)->o.theta > 0 ? NS_THETA : NS_SPARSE;
}

static const ns_counts *counts(ns_engine *e) {
    return ns_sparse_counts(sparse_of(e));
}

static const ns_fault *fault(const ns_engine *e) {
    return ns_sparse_fault(sparse_in(e));
}

static int peek(ns_engine *e, double *x, double *lambda) {
    return ns_sparse_peek(sparse_of(e), x, lambda);
}

static void watch(ns_engine *e, const ns_watch *w) {
    sparse_of(e)->watch = w;
}

static int set_input(ns_engine *e, int input, const ns_signal *signal) {
    (void)input;
    (void)signal;
    return ns_sparse_set_input(sparse_of(e));
}

static const ns_engine_table table = {
    .free = free_engine,
    .start = start,
    .start_dc = start_dc,
    .try_to = try_to,
    .drop = drop,
    .accept = accept_trial,
    .read = read_point,
    .impulse = impulse,
    .mode = mode_of,
    .at_event = at_event,
    .method = method,
    .counts = counts,
    .fault = fault,
    .sample = sample,
    .shortest = shortest,
    .peek = peek,
    .watch = watch,
    .set_input = set_input,
};

int ns_sparse_table_create(const ns_system *s, const ns_sparse_options *o, ns_engine **out, ns_fault *fault) {
    ns_sparse *m;
    const int status = ns_sparse_create(s, o, &m, fault);
    *out = m ? &m->engine : NULL;
    if (m)
        m->engine.table = &table;
    return status;
}
