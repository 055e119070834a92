/* tests/bench/adapter.c - cases run by the library. */
#define _DEFAULT_SOURCE
#include "timing.h"

#include <malloc.h>
#include <math.h>
#include <string.h>

#include "adapter.h"
#include "engine/sparse_march.h"

/* --- engines --- */

/* The calls of nonsmooth/march.h, whoever answers them. */
typedef struct driver {
    int (*start)(void *m, double t0, const double *w0);
    int (*try)(void *m, double t, ns_until until, double *reached);
    int (*accept)(void *m);
    int (*read)(void *m, double *x);
    int (*at_event)(void *m);
    ns_counts (*counts)(void *m);
    void (*free)(void *m);
} driver;

#define DRIVER(engine)                                                                                       \
    static int engine##_start(void *m, double t0, const double *w0) {                                        \
        return ns_##engine##_start(m, t0, w0);                                                               \
    }                                                                                                        \
    static int engine##_try(void *m, double t, ns_until until, double *reached) {                            \
        return ns_##engine##_try(m, t, until, reached);                                                      \
    }                                                                                                        \
    static int engine##_accept(void *m) {                                                                    \
        return ns_##engine##_accept(m);                                                                      \
    }                                                                                                        \
    static int engine##_read(void *m, double *x) {                                                           \
        return ns_##engine##_read(m, NULL, x, NULL, NULL);                                                   \
    }                                                                                                        \
    static int engine##_at_event(void *m) {                                                                  \
        return ns_##engine##_at_event(m);                                                                    \
    }                                                                                                        \
    static ns_counts engine##_counts(void *m) {                                                              \
        return *ns_##engine##_counts(m);                                                                     \
    }                                                                                                        \
    static void engine##_free(void *m) {                                                                     \
        ns_##engine##_free(m);                                                                               \
    }                                                                                                        \
    static const driver engine##_driver = {                                                                  \
        engine##_start,    engine##_try,    engine##_accept, engine##_read,                                  \
        engine##_at_event, engine##_counts, engine##_free};
DRIVER(march)
DRIVER(sparse)

const char *bench_engine_name(bench_engine e) {
    static const char *const names[BENCH_ENGINES] = {"theta", "theta 1/2", "flight", "sparse", "auto"};
    return names[e];
}

int bench_has(bench_engine e, const bench_case *c) {
    return e == BENCH_SPARSE || (e != BENCH_AUTO && !c->large);
}

typedef struct model {
    ns_circuit *circuit;
    ns_system *own; /* the circuit's, NULL: the case's */
    const ns_system *s;
    const driver *by;
    void *engine;
    double *w0, *x;
} model;

/* The engine for s; where a new one comes in. */
static int make_engine(const bench_case *c, bench_engine e, double setting, const ns_system *s, model *m) {
    if (e == BENCH_SPARSE) {
        const ns_sparse_options o = {c->unit, setting, 0};
        ns_sparse *sparse;
        const int status = ns_sparse_create(s, &o, &sparse, NULL);
        m->by = &sparse_driver;
        m->engine = sparse;
        return status;
    }
    const double theta = e == BENCH_HALF ? 0.5 : 1;
    const ns_march_options o = {.theta = theta,
                                .gamma = theta,
                                .h = c->unit * setting,
                                .method = e == BENCH_FLIGHT ? NS_FLIGHT : NS_THETA};
    ns_march *march;
    const int status = ns_march_create(s, &o, &march, NULL);
    m->by = &march_driver;
    m->engine = march;
    return status;
}

/* --- a run --- */

static int build(const bench_case *c, bench_engine e, double setting, model *m) {
    int status = NS_OK;
    m->s = c->system;
    if (c->net) {
        status = deck_circuit(c->net, &m->circuit);
        if (status == NS_OK)
            status = ns_circuit_system(m->circuit, &m->own);
        m->s = m->own;
    }
    if (status != NS_OK)
        return status;
    m->w0 = room((size_t)m->s->n * sizeof *m->w0);
    m->x = room((size_t)m->s->n * sizeof *m->x);
    if (c->net)
        status = ns_circuit_rest(m->circuit, m->w0);
    return status == NS_OK ? make_engine(c, e, setting, m->s, m) : status;
}

static void drop(model *m) {
    if (m->engine)
        m->by->free(m->engine);
    ns_system_free(m->own);
    ns_circuit_free(m->circuit);
    free(m->w0);
    free(m->x);
}

/* On to t; where events accumulate, from one to the next. */
static int go(const bench_case *c, model *m, double t, bench_result *r) {
    const ns_until until = isnan(c->accumulates) ? NS_TO_TIME : NS_TO_EVENT;
    double reached = -1;
    int status = NS_OK;
    while (status == NS_OK && reached < t) {
        status = m->by->try(m->engine, t, until, &reached);
        if (status == NS_OK && m->by->at_event(m->engine))
            r->last_event = reached;
        if (status == NS_OK)
            status = m->by->accept(m->engine);
    }
    return status;
}

static int read_values(const bench_case *c, model *m, double *values) {
    const int status = m->by->read(m->engine, m->x);
    for (int i = 0; i < c->unknowns && status == NS_OK; i++) {
        const int of = c->unknown[i].of;
        const int at = !c->net                    ? of
                       : c->unknown[i].is_current ? ns_circuit_current_unknown(m->circuit, of)
                                                  : ns_circuit_node_unknown(m->circuit, of);
        values[i] = m->x[at];
    }
    return status;
}

void bench_run(const bench_case *c, bench_engine e, double setting, bench_result *r) {
    const size_t before = mallinfo2().uordblks + mallinfo2().hblkhd;
    model m = {0};
    memset(r, 0, sizeof *r);
    r->last_event = NAN;
    for (int i = 0; i < CASE_VALUES; i++)
        r->values[i] = NAN;
    const double start = now();
    r->status = build(c, e, setting, &m);
    r->create = now() - start;
    if (r->status == NS_OK)
        r->status = m.by->start(m.engine, 0, m.w0);
    for (int k = 0; k < c->times && r->status == NS_OK; k++) {
        r->status = go(c, &m, c->time[k], r);
        if (r->status == NS_OK)
            r->status = read_values(c, &m, r->values + k * c->unknowns);
    }
    r->run = now() - start - r->create;
    r->bytes = mallinfo2().uordblks + mallinfo2().hblkhd - before;
    if (m.engine)
        r->counts = m.by->counts(m.engine);
    drop(&m);
}
