/* tests/bench/adapter.c - cases run by the library. */
#define _DEFAULT_SOURCE
#include "timing.h"

#include <malloc.h>
#include <math.h>
#include <string.h>

#include "adapter.h"

/* --- engines --- */

const char *bench_engine_name(bench_engine e) {
    static const char *const names[BENCH_ENGINES] = {"theta", "theta 1/2",   "exact",  "sparse",
                                                     "auto",  "capture 1/2", "capture"};
    return names[e];
}

int bench_has(bench_engine e, const bench_case *c) {
    return e == BENCH_SPARSE || e == BENCH_AUTO || bench_captures(e) || !c->large;
}

int bench_captures(bench_engine e) {
    return e == BENCH_CAPTURE || e == BENCH_CAPTURE_HALF;
}

int bench_steps(bench_engine e) {
    return e == BENCH_THETA || e == BENCH_HALF || e == BENCH_EXACT || bench_captures(e);
}

/* Steps of the scheme in a unit: with events located from 64 on; else of what is large no more than 1024. */
static const double fractions[] = {5, 10, 20, 64, 256, 1024, 4096};
enum { LOCATED = 3 };
/* Those of engines that choose their steps: digits of reltol. */
static const double sparse_digits[] = {3, 4, 6, 8, 10, 12}, auto_digits[] = {3, 6, 9, 12};

int bench_settings(bench_engine e, int large, int quick) {
    if (e == BENCH_EXACT)
        return 1;
    if (quick)
        return bench_captures(e) ? 4 : bench_steps(e) ? 2 : 3;
    return e == BENCH_SPARSE || (bench_captures(e) && large) ? 6 : bench_captures(e) ? 7 : 4;
}

double bench_setting(bench_engine e, int k) {
    if (e == BENCH_EXACT)
        return 1 / 64.0;
    return bench_captures(e) ? 1 / fractions[k]
           : bench_steps(e)  ? 1 / fractions[k + LOCATED]
           : e == BENCH_AUTO ? pow(10, -auto_digits[k])
                             : pow(10, -sparse_digits[k]);
}

typedef struct model {
    ns_circuit *circuit;
    ns_system *own; /* the circuit's, NULL: the case's */
    const ns_system *s;
    ns_march *engine;
    double *w0, *x;
} model;

/* The engine for s; where a new one comes in. */
static int make_engine(const bench_case *c, bench_engine e, double setting, const ns_system *s, model *m) {
    static const ns_method methods[BENCH_ENGINES] = {NS_THETA, NS_THETA, NS_EXACT, NS_SPARSE,
                                                     NS_AUTO,  NS_THETA, NS_THETA};
    const int steps = bench_steps(e);
    const double theta = e == BENCH_HALF || e == BENCH_CAPTURE_HALF ? 0.5 : 1;
    const ns_march_options o = {.theta = theta,
                                .gamma = theta,
                                .h = c->unit * (steps                          ? setting
                                                : e == BENCH_AUTO && !c->large ? 1 / 64.0
                                                                               : 1),
                                .method = methods[e],
                                .reltol = steps ? 0 : setting,
                                .capture = bench_captures(e)};
    return ns_march_create(s, &o, &m->engine, NULL);
}

/* --- a run --- */

static int build(const bench_case *c, bench_engine e, double setting, model *m) {
    int status = NS_OK;
    m->s = c->system;
    if (c->net) {
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
    ns_march_free(m->engine);
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
        status = ns_march_try(m->engine, t, until, &reached);
        if (status == NS_OK && ns_march_at_event(m->engine))
            r->last_event = reached;
        if (status == NS_OK)
            status = ns_march_accept(m->engine);
    }
    return status;
}

static int read_values(const bench_case *c, model *m, double *values) {
    const int status = ns_march_read(m->engine, NULL, m->x, NULL, NULL);
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
    r->status = c->net ? deck_circuit(c->net, &m.circuit) : NS_OK;
    const double start = now();
    if (r->status == NS_OK)
        r->status = build(c, e, setting, &m);
    r->create = now() - start;
    if (r->status == NS_OK)
        r->status = ns_march_start(m.engine, 0, m.w0);
    for (int k = 0; k < c->times && r->status == NS_OK; k++) {
        r->status = go(c, &m, c->time[k], r);
        if (r->status == NS_OK)
            r->status = read_values(c, &m, r->values + k * c->unknowns);
    }
    r->run = now() - start - r->create;
    r->bytes = mallinfo2().uordblks + mallinfo2().hblkhd - before;
    if (m.engine)
        r->engine = ns_march_engine(m.engine);
    if (m.engine)
        r->counts = *ns_march_counts(m.engine);
    drop(&m);
}
