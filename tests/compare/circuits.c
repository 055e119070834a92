/* tests/compare/circuits.c - the circuits and engines, and a run of one of them. */
#include "timing.h"

#include <math.h>
#include <string.h>

#include "circuits.h"

enum { POINTS = 25, BUCKS = 4 };

typedef struct result {
    ns_circuit *circuit;
    ns_system *own;
    const ns_system *s; /* own, or the case's */
    ns_march *march;
    double *w0, *x, *lambda, *y;
} result;

/* Diode bucks at one supply with periods that share no instant: the library takes them apart. */
static void make_islands(bench_case *c) {
    deck *d = c->net = deck_create();
    c->unit = 10e-6;
    deck_v(d, 1, 0, deck_dc(24));
    for (int k = 0; k < BUCKS; k++) {
        const int x = 10 * k + 2, out = x + 1, gate = x + 2;
        const double period = (10 + 1.3 * k) * 1e-6;
        deck_v(d, gate, 0, deck_pulse(1, 0, 10e-9, (0.35 + 0.03 * k) * period, period));
        deck_s(d, 1, x, gate, 0, 0.5);
        deck_d(d, 0, x);
        deck_l(d, x, out, 100e-6, 0);
        deck_c(d, out, 0, 22e-6, 0);
        deck_r(d, out, 0, k % 2 ? 4 : 60);
    }
}

static void make_buck_ccm(bench_case *c) {
    case_buck(c, 1, 5);
}

static void make_buck_dcm(bench_case *c) {
    case_buck(c, 1, 200);
}

static void make_buck_sync(bench_case *c) {
    case_buck(c, 0, 5);
}

static void make_multiplier5(bench_case *c) {
    case_multiplier(c, 5);
}

static void make_multiplier20(bench_case *c) {
    case_multiplier(c, 20);
}

static void make_ladder16(bench_case *c) {
    case_ladder(c, 16);
}

static void make_ladder320(bench_case *c) {
    case_ladder(c, 320);
}

static void make_multilevel4(bench_case *c) {
    case_multilevel(c, 4, 4e-3);
}

static void make_multilevel10(bench_case *c) {
    case_multilevel(c, 10, 4e-3);
}

/* Each takes some 10^8 instructions. */
static const struct {
    const char *name, *engine;
    void (*make)(bench_case *c);
    double end; /* s */
} runs[] = {{"lc_bridge", "exact", case_lc_bridge, 40e-3},
            {"buck_ccm", "exact", make_buck_ccm, 20e-3},
            {"buck_ccm", "sparse", make_buck_ccm, 10e-3},
            {"buck_ccm", "theta", make_buck_ccm, 2e-3},
            {"buck_dcm", "auto", make_buck_dcm, 50e-3},
            {"buck_sync", "exact", make_buck_sync, 20e-3},
            {"six_pulse", "exact", case_six_pulse, 4},
            {"six_pulse", "sparse", case_six_pulse, 0.4},
            {"multiplier5", "exact", make_multiplier5, 10e-3},
            {"multiplier20", "sparse", make_multiplier20, 5e-3},
            {"literature", "auto", case_literature, 200e-6},
            {"multilevel4", "auto", make_multilevel4, 20e-3},
            {"multilevel10", "sparse", make_multilevel10, 10e-3},
            {"ladder16", "theta", make_ladder16, 1e-3},
            {"ladder320", "auto", make_ladder320, 0.3e-3},
            {"islands", "auto", make_islands, 10e-3},
            {"chopper", "exact", case_chopper, 20e-3},
            {"bouncing", "auto", case_bouncing, 1.9999e-3}};

const char *circuits_name(int at, const char **engine) {
    const int there = at >= 0 && (size_t)at < sizeof runs / sizeof *runs;
    *engine = there ? runs[at].engine : NULL;
    return there ? runs[at].name : NULL;
}

static ns_march_options options_of(const char *engine, double unit) {
    ns_march_options o = {.theta = 1, .gamma = 1, .h = unit / 64, .method = NS_AUTO, .reltol = 1e-6};
    if (strcmp(engine, "theta") == 0)
        o.method = NS_THETA;
    if (strcmp(engine, "exact") == 0)
        o.method = NS_EXACT;
    if (strcmp(engine, "sparse") == 0) {
        o.method = NS_SPARSE;
        o.h = unit;
    }
    return o;
}

static void write_numbers(FILE *file, const char *what, int count, const double *a) {
    for (int i = 0; i < count; i++)
        fprintf(file, "%s[%d] %.17g\n", what, i, a[i]);
}

static void write_point(FILE *file, const result *r, double t) {
    const ns_mode *mode = ns_march_mode(r->march);
    write_numbers(file, "t", 1, &t);
    write_numbers(file, "x", r->s->n, r->x);
    write_numbers(file, "lambda", r->s->m, r->lambda);
    write_numbers(file, "y", r->s->m, r->y);
    for (int i = 0; i < r->s->m; i++)
        fprintf(file, "mode[%d] %d\n", i, (int)mode[i]);
}

/* The sum of sizes of x gets bigger by those here. */
static void read_point(FILE *file, const result *r, double *sum) {
    double t;
    must(ns_march_read(r->march, &t, r->x, r->lambda, r->y));
    for (int i = 0; i < r->s->n; i++)
        *sum += fabs(r->x[i]);
    if (file)
        write_point(file, r, t);
}

static void advance(ns_march *m, double t) {
    double reached = -1;
    while (reached < t) {
        must(ns_march_try(m, t, NS_TO_TIME, &reached));
        must(ns_march_accept(m));
    }
}

static void write_counts(FILE *file, const ns_counts *c) {
    const struct {
        const char *name;
        long count;
    } counts[] = {{"steps", c->steps},       {"trials", c->trials},
                  {"events", c->events},     {"problems", c->problems},
                  {"pivots", c->pivots},     {"factors", c->factors},
                  {"maps", c->maps},         {"evicted", c->evicted},
                  {"jumps", c->jumps},       {"jumps_by_steps", c->jumps_by_steps},
                  {"islands", c->islands},   {"modes", c->modes},
                  {"searches", c->searches}, {"input_states", c->input_states},
                  {"periods", c->periods},   {"predicted", c->predicted},
                  {"checks", c->checks},     {"retries", c->retries}};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        fprintf(file, "count:%s %ld\n", counts[i].name, counts[i].count);
}

static void make(const bench_case *c, const char *engine, result *r) {
    const ns_march_options o = options_of(engine, c->unit);
    if (c->net) {
        must(deck_circuit(c->net, &r->circuit));
        must(ns_circuit_system(r->circuit, &r->own));
    }
    r->s = c->net ? r->own : c->system;
    r->w0 = room(sizeof(double) * (size_t)(r->s->n + 1));
    r->x = room(sizeof(double) * (size_t)(r->s->n + 1));
    r->lambda = room(sizeof(double) * (size_t)(r->s->m + 1));
    r->y = room(sizeof(double) * (size_t)(r->s->m + 1));
    if (c->net)
        must(ns_circuit_rest(r->circuit, r->w0));
    must(ns_march_create(r->s, &o, &r->march, NULL));
}

static void drop(result *r) {
    ns_march_free(r->march);
    ns_system_free(r->own);
    ns_circuit_free(r->circuit);
    free(r->w0);
    free(r->x);
    free(r->lambda);
    free(r->y);
}

/* From the start to the end; the sum of sizes of x. */
static double go(const result *r, double end, FILE *file) {
    double sum = 0;
    must(ns_march_start(r->march, 0, r->w0));
    read_point(file, r, &sum);
    for (int k = 1; k <= POINTS; k++) {
        advance(r->march, end * k / POINTS);
        read_point(file, r, &sum);
    }
    return sum;
}

double circuits_run(int at, FILE *file, ns_counts *counts) {
    bench_case c = {.accumulates = NAN};
    result r = {0};
    runs[at].make(&c);
    make(&c, runs[at].engine, &r);
    const double sum = go(&r, runs[at].end, file);
    *counts = *ns_march_counts(r.march);
    if (file)
        write_counts(file, counts);
    drop(&r);
    case_free(&c);
    return sum;
}

double circuits_run_again(int at, ns_counts *before, ns_counts *after) {
    bench_case c = {.accumulates = NAN};
    result r = {0};
    runs[at].make(&c);
    make(&c, runs[at].engine, &r);
    (void)go(&r, runs[at].end, NULL);
    *before = *ns_march_counts(r.march);
    const double sum = go(&r, runs[at].end, NULL);
    *after = *ns_march_counts(r.march);
    drop(&r);
    case_free(&c);
    return sum;
}
