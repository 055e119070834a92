/* tests/unit/bridge/test_piecewise.c - 200 random piecewise linear expressions of three sources, made of
 * kinks and choices, against their direct evaluation at 1000 points each; corners are events; what is
 * refused. */
#include "march_bench.h"

#include <stdio.h>
#include <string.h>

#include "dice.h"
#include "piecewise.h"

enum { CIRCUITS = 25, EXPRESSIONS = 8, POINTS = 1000, DEPTH = 4, NODES = 400 };

/* An expression: an operation on others, by index. */
typedef enum operation {
    SIGNAL,
    NUMBER,
    SUM,
    TIMES_NUMBER,
    TIMES_CONDITION,
    POSITIVE,
    ABSOLUTE,
    MINIMUM,
    MAXIMUM,
    ABOVE,
    AND,
    NOT,
    CHOOSE,
    LINE,
    OPERATIONS
} operation;

typedef struct expression {
    operation of;
    int a, b, c;
    double number;
} expression;

typedef struct wood {
    expression at[NODES];
    int count;
} wood;

static dice die;

static double between(double low, double high) {
    return low + (high - low) * dice_uniform(&die);
}

static int grow(wood *w, int depth);

static int is_condition(operation of) {
    return of == ABOVE || of == AND || of == NOT;
}

static int grow_as(wood *w, operation of, int depth) {
    const int at = w->count++;
    assert_true(w->count < NODES);
    expression e = {.of = of, .a = -1, .b = -1, .c = -1, .number = round(64 * between(-3, 3)) / 64};
    if (of == SIGNAL)
        e.a = (int)between(0, 2.999);
    else if (of == AND) {
        e.a = grow_as(w, ABOVE, depth - 1);
        e.b = grow_as(w, ABOVE, depth - 1);
    } else if (of == NOT)
        e.a = grow_as(w, ABOVE, depth - 1);
    else if (of != NUMBER) {
        e.a = grow(w, depth - 1);
        if (of == SUM || of == MINIMUM || of == MAXIMUM || of == CHOOSE)
            e.b = grow(w, depth - 1);
        if (of == TIMES_CONDITION || of == CHOOSE)
            e.c = grow_as(w, (operation)(ABOVE + (int)between(0, 2.999)), depth - 1);
    }
    w->at[at] = e;
    return at;
}

static int grow(wood *w, int depth) {
    const double leaf = between(0, 1);
    if (depth <= 0)
        return grow_as(w, leaf < 0.8 ? SIGNAL : NUMBER, 0);
    operation of = (operation)(SUM + (int)between(0, OPERATIONS - SUM - 0.001));
    return grow_as(w, is_condition(of) && leaf < 0.5 ? SUM : of, depth);
}

static const double line[] = {-1, 0.5, -0.25, -1, 0.5, 2, 1.5, 0};

/* margin: how near the next jump is. */
static double evaluate(const wood *w, int at, const double *signal, double *margin) {
    const expression *e = &w->at[at];
    const double a = e->of == SIGNAL || e->of == NUMBER ? 0 : evaluate(w, e->a, signal, margin);
    const double b = e->b >= 0 ? evaluate(w, e->b, signal, margin) : 0;
    const double c = e->c >= 0 ? evaluate(w, e->c, signal, margin) : 0;
    switch (e->of) {
    case SIGNAL:
        return signal[e->a];
    case NUMBER:
        return e->number;
    case SUM:
        return a + e->number * b;
    case TIMES_NUMBER:
        return e->number * a;
    case TIMES_CONDITION:
        return a * c;
    case POSITIVE:
        return fmax(a, 0);
    case ABSOLUTE:
        return fabs(a);
    case MINIMUM:
        return fmin(a, b);
    case MAXIMUM:
        return fmax(a, b);
    case ABOVE:
        *margin = a == 0 ? *margin : fmin(*margin, fabs(a)); /* what rests at 0 is not near a jump */
        return a > 0;
    case AND:
        return a != 0 && b != 0;
    case NOT:
        return a == 0;
    case CHOOSE:
        return c != 0 ? a : b;
    default:
        for (int k = 0;; k += 2)
            if (k == 4 || a < line[k + 2])
                return line[k + 1] + (line[k + 3] - line[k + 1]) * (a - line[k]) / (line[k + 2] - line[k]);
    }
}

static double both(double a, double b) {
    return a != 0 && b != 0;
}

static double not_it(double a) {
    return a == 0;
}

static ns_piecewise_value *make(ns_piecewise *p, const wood *w, int at) {
    const expression *e = &w->at[at];
    ns_piecewise_value *a = e->of == SIGNAL || e->of == NUMBER ? NULL : make(p, w, e->a);
    ns_piecewise_value *b = e->b >= 0 ? make(p, w, e->b) : NULL, *c = e->c >= 0 ? make(p, w, e->c) : NULL;
    ns_piecewise_value *more;
    switch (e->of) {
    case SIGNAL:
        return ns_bridge_piecewise_term(p, (ns_term){0, 1 + e->a, 1});
    case NUMBER:
        return ns_bridge_piecewise_constant(p, e->number);
    case SUM:
        return ns_bridge_piecewise_sum(p, 1, a, e->number, b);
    case TIMES_NUMBER:
        return ns_bridge_piecewise_product(p, ns_bridge_piecewise_constant(p, e->number), a);
    case TIMES_CONDITION:
        return ns_bridge_piecewise_product(p, a, c);
    case POSITIVE:
        return ns_bridge_piecewise_positive(p, a);
    case ABSOLUTE:
        return ns_bridge_piecewise_sum(p, 2, ns_bridge_piecewise_positive(p, a), -1, a);
    case MINIMUM:
    case MAXIMUM:
        more = ns_bridge_piecewise_positive(p, ns_bridge_piecewise_sum(p, 1, a, -1, b));
        return e->of == MAXIMUM ? ns_bridge_piecewise_sum(p, 1, b, 1, more)
                                : ns_bridge_piecewise_sum(p, 1, a, -1, more);
    case ABOVE:
        return ns_bridge_piecewise_above(p, a);
    case AND:
        return ns_bridge_piecewise_map2(p, both, a, b);
    case NOT:
        return ns_bridge_piecewise_map(p, not_it, a);
    case CHOOSE:
        return ns_bridge_piecewise_choose(p, c, a, b);
    default:
        return ns_bridge_piecewise_line(p, a, 4, line, 0);
    }
}

static const double corner_t[] = {0, 1.3e-3, 1.7e-3, 4e-3}, corner_v[] = {-1, 2, 2, -1.5};

static void signals_at(double t, double *v) {
    int k = 0;
    while (k < 2 && t > corner_t[k + 1])
        k++;
    v[0] = 2 * sin(2 * pi * 1000 * t);
    v[1] = 1 + 1.5 * sin(2 * pi * 370 * t);
    v[2] =
        corner_v[k] + (corner_v[k + 1] - corner_v[k]) * ((t - corner_t[k]) / (corner_t[k + 1] - corner_t[k]));
}

static bench sources(void) {
    bench b = open_bench();
    ns_signal s = {.kind = NS_SIN};
    s.u.sin.va = 2;
    s.u.sin.freq = 1000;
    assert_int_equal(ns_circuit_source(b.c, "v1", NS_VOLTAGE, 1, 0, &s, NULL), NS_OK);
    s.u.sin.vo = 1;
    s.u.sin.va = 1.5;
    s.u.sin.freq = 370;
    assert_int_equal(ns_circuit_source(b.c, "v2", NS_VOLTAGE, 2, 0, &s, NULL), NS_OK);
    s.kind = NS_PWL;
    s.u.pwl.n = 4;
    s.u.pwl.t = corner_t;
    s.u.pwl.v = corner_v;
    s.u.pwl.repeat = NAN;
    s.u.pwl.td = 0;
    assert_int_equal(ns_circuit_source(b.c, "v3", NS_VOLTAGE, 3, 0, &s, NULL), NS_OK);
    return b;
}

static void add(bench *b, int node, const wood *w, int *next_node) {
    char name[16];
    ns_affine u;
    snprintf(name, sizeof name, "b%d", node);
    ns_piecewise p = {.circuit = b->c, .name = name};
    p.next_node = next_node;
    assert_int_equal(ns_bridge_piecewise_affine(&p, make(&p, w, 0), &u), 1);
    assert_int_equal(ns_circuit_linear(b->c, name, NS_VOLTAGE, node, 0, u.constant, u.nterms, u.terms, NULL),
                     NS_OK);
    ns_bridge_piecewise_free(&p);
}

static void as_evaluated(void **state) {
    (void)state;
    static wood w[EXPRESSIONS];
    long compared = 0, jumps = 0;
    double worst = 0;
    die = dice_make(1, 7);
    for (int circuit = 0; circuit < CIRCUITS; circuit++) {
        bench b = sources();
        int next_node = 1000;
        for (int k = 0; k < EXPRESSIONS; k++) {
            w[k].count = 0;
            (void)grow(&w[k], DEPTH);
            add(&b, 4 + k, &w[k], &next_node);
        }
        const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-5, .method = NS_EXACT};
        assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
        assert_int_equal(ns_march_create(b.s, &o, &b.m, NULL), NS_OK);
        double *w0 = calloc((size_t)b.s->n + 1, sizeof *w0), *x = calloc((size_t)b.s->n + 1, sizeof *x);
        assert_int_equal(ns_march_start(b.m, 0, w0), NS_OK);
        for (int i = 1; i <= POINTS; i++) {
            const double t = 3.7e-3 * i / POINTS;
            double v[3], reached;
            signals_at(t, v);
            assert_int_equal(ns_march_try(b.m, t, NS_TO_TIME, &reached), NS_OK);
            assert_int_equal(ns_march_accept(b.m), NS_OK);
            assert_int_equal(ns_march_read(b.m, NULL, x, NULL, NULL), NS_OK);
            for (int k = 0; k < EXPRESSIONS; k++) {
                double margin = INFINITY;
                const double expected = evaluate(&w[k], 0, v, &margin);
                const double error = fabs(x[ns_circuit_node_unknown(b.c, 4 + k)] - expected);
                if (margin < 1e-10) { /* either side of a jump */
                    jumps++;
                    continue;
                }
                if (!(error <= 1e-12 * fmax(1, fabs(expected))))
                    print_message("circuit %d expression %d t %.17g: %.17g, not %.17g\n", circuit, k, t,
                                  x[ns_circuit_node_unknown(b.c, 4 + k)], expected);
                assert_true(error <= 1e-12 * fmax(1, fabs(expected)));
                worst = fmax(worst, error / fmax(1, fabs(expected)));
                compared++;
            }
        }
        free(w0);
        free(x);
        close_bench(&b);
    }
    print_message("%ld points compared, %ld at jumps, largest error %.1e\n", compared, jumps, worst);
    assert_true(jumps < compared / 100);
}

enum { TABLES = 40, FAR_POINTS = 200 };

/* Four values of either sign, 1e-6 to 1e12 and some 0, by two conditions. */
static ns_piecewise_value *far_table(ns_piecewise *p, double *number) {
    ns_piecewise_value *k[4];
    for (int i = 0; i < 4; i++) {
        number[i] = between(0, 1) < 0.2 ? 0 : (between(-1, 1) > 0 ? 1 : -1) * pow(10, between(-6, 12));
        k[i] = ns_bridge_piecewise_constant(p, number[i]);
    }
    ns_piecewise_value *one = ns_bridge_piecewise_above(p, ns_bridge_piecewise_term(p, (ns_term){0, 1, 1}));
    ns_piecewise_value *two = ns_bridge_piecewise_above(p, ns_bridge_piecewise_term(p, (ns_term){0, 2, 1}));
    return ns_bridge_piecewise_choose(p, one, ns_bridge_piecewise_choose(p, two, k[3], k[2]),
                                      ns_bridge_piecewise_choose(p, two, k[1], k[0]));
}

/* Adds the table as node 4; 0: it was refused, for its spread. */
static int add_table(bench *b, double *number) {
    ns_affine u;
    int next_node = 1000;
    ns_piecewise p = {.circuit = b->c, .name = "b", .next_node = &next_node};
    const int taken = ns_bridge_piecewise_affine(&p, far_table(&p, number), &u);
    if (taken)
        assert_int_equal(ns_circuit_linear(b->c, "b", NS_VOLTAGE, 4, 0, u.constant, u.nterms, u.terms, NULL),
                         NS_OK);
    else
        assert_non_null(strstr(p.why, "more than 1e9 times as large"));
    ns_bridge_piecewise_free(&p);
    return taken;
}

/* The largest error of a value that is not 0, relative to it. */
static double table_error(bench *b, const double *number) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-5, .method = NS_EXACT};
    double worst = 0;
    assert_int_equal(ns_circuit_system(b->c, &b->s), NS_OK);
    assert_int_equal(ns_march_create(b->s, &o, &b->m, NULL), NS_OK);
    double *x = calloc((size_t)b->s->n + 1, sizeof *x);
    assert_int_equal(ns_march_start(b->m, 0, x), NS_OK);
    for (int i = 1; i <= FAR_POINTS; i++) {
        double v[3], reached;
        const double t = 3.7e-3 * i / FAR_POINTS;
        signals_at(t, v);
        const double expected = number[(v[0] > 0) + (v[0] > 0) + (v[1] > 0)];
        assert_int_equal(ns_march_try(b->m, t, NS_TO_TIME, &reached), NS_OK);
        assert_int_equal(ns_march_accept(b->m), NS_OK);
        assert_int_equal(ns_march_read(b->m, NULL, x, NULL, NULL), NS_OK);
        if (expected != 0 && fmin(fabs(v[0]), fabs(v[1])) > 1e-9)
            worst = fmax(worst, fabs(x[ns_circuit_node_unknown(b->c, 4)] / expected - 1));
    }
    free(x);
    return worst;
}

/* A table with values far apart is right in each of them, or refused. */
static void far_apart(void **state) {
    (void)state;
    int taken = 0;
    double worst = 0;
    die = dice_make(2, 7);
    for (int k = 0; k < TABLES; k++) {
        double number[4];
        bench b = sources();
        if (add_table(&b, number)) {
            taken++;
            worst = fmax(worst, table_error(&b, number));
        }
        close_bench(&b);
    }
    print_message("%d of %d tables taken, largest relative error %.1e\n", taken, TABLES, worst);
    assert_true(worst <= 1e-6);
    assert_in_range(taken, TABLES / 2, TABLES - 1);
}

static void refused(void **state) {
    (void)state;
    bench b = sources();
    int next_node = 1000;
    ns_affine u;
    ns_piecewise p = {.circuit = b.c, .name = "b", .next_node = &next_node};
    ns_piecewise_value *a = ns_bridge_piecewise_term(&p, (ns_term){0, 1, 1}),
                       *c = ns_bridge_piecewise_term(&p, (ns_term){0, 2, 1}),
                       *zero = ns_bridge_piecewise_constant(&p, 0);
    assert_null(ns_bridge_piecewise_product(&p, a, c));
    assert_int_equal(p.status, NS_E_RANGE);
    assert_string_equal(p.why, "a product of two signals");
    p.status = NS_OK;
    assert_null(ns_bridge_piecewise_quotient(&p, a, c));
    assert_string_equal(p.why, "a quotient by a signal");
    p.status = NS_OK;
    assert_null(ns_bridge_piecewise_quotient(&p, a, zero));
    assert_int_equal(p.status, NS_E_NUMBER);
    p.status = NS_OK;
    assert_null(ns_bridge_piecewise_map(&p, not_it, a));
    p.status = NS_OK;
    assert_null(ns_bridge_piecewise_map2(&p, both, zero, a));
    p.status = NS_OK;
    assert_null(ns_bridge_piecewise_constant(&p, INFINITY));
    p.status = NS_OK;
    assert_null(ns_bridge_piecewise_sum(&p, 1, NULL, 1, a));
    assert_int_equal(ns_bridge_piecewise_affine(&p, NULL, &u), 0);
    ns_bridge_piecewise_free(&p);
    close_bench(&b);
}

/* The lines of tanh: as few as lie within so much of it on both sides, level at its own ends. */
static void curves_are_few_lines(void **state) {
    (void)state;
    const double within = 5e-3;
    double xy[PIECEWISE_CURVE], off = 0.0;
    const int points = ns_bridge_piecewise_chords(tanh, 3.0, within, xy);
    assert_int_equal(points, 12);
    assert_true(xy[1] == -1.0 && xy[2 * points - 1] == 1.0);
    for (int k = 0; k + 1 < points; k++)
        for (int i = 0; i <= 100; i++) {
            const double part = i / 100.0, x = xy[2 * k] + part * (xy[2 * k + 2] - xy[2 * k]);
            const double y = xy[2 * k + 1] + part * (xy[2 * k + 3] - xy[2 * k + 1]);
            off = fmax(off, fabs(y - tanh(x)));
        }
    assert_true(off <= 1.01 * within && off > 0.9 * within);
    assert_true(1.0 - tanh(3.0) <= within);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(as_evaluated),
        cmocka_unit_test(far_apart),
        cmocka_unit_test(refused),
        cmocka_unit_test(curves_are_few_lines),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
