/* tests/unit/march/test_instant.c - what jumps in an instant: the integrals of x and lambda over it, by every
 * engine.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth.h"

enum { MOST = 40, WAYS = 5 };

static const double instant = 1e-6;
static const ns_switch contact = {0.5, 0, 0, INFINITY};
static const ns_diode diode = {0, 0, INFINITY, INFINITY, 0};

static const struct {
    ns_method method;
    double theta, exact_to; /* of the largest impulse */
} way[WAYS] = {{NS_EXACT, 1, 1e-12},
               {NS_SPARSE, 1, 1e-12},
               {NS_THETA, 1, 1e-12},
               {NS_THETA, 0.5, 1e-12},
               {NS_AUTO, 1, 1e-12}};

typedef struct bench {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    int w; /* which way */
    double X[MOST], Lambda[MOST];
} bench;

static bench open_bench(int w) {
    bench b = {.w = w};
    assert_int_equal(ns_circuit_create(&b.c), NS_OK);
    return b;
}

static void close_bench(bench *b) {
    ns_march_free(b->m);
    ns_system_free(b->s);
    ns_circuit_free(b->c);
}

static void capacitor(bench *b, const char *name, int p, int n, double c, double v) {
    assert_int_equal(ns_circuit_capacitor(b->c, name, p, n, c, v, NULL), NS_OK);
}

static int inductor(bench *b, const char *name, int p, int n, double l, double i) {
    int id;
    assert_int_equal(ns_circuit_inductor(b->c, name, p, n, l, i, &id), NS_OK);
    return id;
}

static void blocking(bench *b, const char *name, int p, int n) {
    assert_int_equal(ns_circuit_diode(b->c, name, p, n, &diode, NULL), NS_OK);
}

/* From v0 at 0 to v1, and at the instant to v2. */
static int source(bench *b, const char *name, int p, int n, double v1, double v2) {
    const double t[3] = {0, instant, instant}, v[3] = {v1, v1, v2};
    ns_signal s = {.kind = NS_PWL};
    int id;
    s.u.pwl.n = 3;
    s.u.pwl.t = t;
    s.u.pwl.v = v;
    s.u.pwl.repeat = NAN;
    assert_int_equal(ns_circuit_source(b->c, name, NS_VOLTAGE, p, n, &s, &id), NS_OK);
    return id;
}

static void switch_at(bench *b, const char *name, const char *gate, int p, int n, int closes) {
    source(b, gate, 90, 0, !closes, closes);
    assert_int_equal(ns_circuit_switch(b->c, name, p, n, 90, 0, &contact, NULL), NS_OK);
}

static void look(bench *b) {
    memset(b->X, -1, sizeof b->X);
    assert_int_equal(ns_march_impulse(b->m, b->X, b->Lambda), NS_OK);
    assert_int_equal(ns_march_impulse(b->m, NULL, NULL), NS_OK);
}

static void start(bench *b) {
    double w0[MOST];
    const ns_march_options o = {
        .theta = way[b->w].theta, .gamma = way[b->w].theta, .h = 1e-7, .method = way[b->w].method};
    assert_int_equal(ns_circuit_system(b->c, &b->s), NS_OK);
    assert_true(b->s->n <= MOST && b->s->m <= MOST);
    assert_int_equal(ns_march_create(b->s, &o, &b->m, NULL), NS_OK);
    assert_int_equal(ns_march_impulse(b->m, b->X, b->Lambda), NS_E_STATE);
    assert_int_equal(ns_circuit_rest(b->c, w0), NS_OK);
    assert_int_equal(ns_march_start(b->m, 0, w0), NS_OK);
    look(b);
}

/* Short steps of the scheme, some of 1e-7 s/2^20, pass up to 10 V or 10 A. */
static double passes(const bench *b) {
    return way[b->w].method == NS_THETA ? 10 * 10 * 1e-13 : 0;
}

/* To one side of the next event. */
static void to_side(bench *b) {
    double reached;
    assert_int_equal(ns_march_try(b->m, 1, NS_TO_EVENT, &reached), NS_OK);
    look(b);
    assert_int_equal(ns_march_accept(b->m), NS_OK);
    assert_true(fabs(reached - instant) <= 1e-12 * instant + passes(b) / 10);
}

static void nothing(const bench *b) {
    for (int i = 0; i < b->s->n; i++)
        assert_true(fabs(b->X[i]) <= passes(b));
    for (int j = 0; j < b->s->m; j++)
        assert_true(fabs(b->Lambda[j]) <= passes(b));
}

/* Over the event at the instant. */
static void jump(bench *b) {
    start(b);
    nothing(b);
    to_side(b);
    assert_true(ns_march_at_event(b->m));
    nothing(b);
    to_side(b);
    assert_false(ns_march_at_event(b->m));
    double X = b->X[0]; /* the same again, after it was accepted; then none */
    look(b);
    assert_true(b->X[0] == X);
}

static void near(const bench *b, double got, double expected, double scale) {
    if (!(fabs(got - expected) <= way[b->w].exact_to * scale))
        print_message("way %d: got %.17g, expected %.17g\n", b->w, got, expected);
    assert_true(fabs(got - expected) <= way[b->w].exact_to * scale);
}

static double v_of(const bench *b, int node) {
    return b->X[ns_circuit_node_unknown(b->c, node)];
}

static double i_of(const bench *b, int id) {
    return b->X[ns_circuit_current_unknown(b->c, id)];
}

/* 1 uF at 10 V and 3 uF at 2 V: C1 C2/(C1+C2) 8 V go over. */
static const double c1 = 1e-6, c2 = 3e-6, over = 1e-6 * 3e-6 / 4e-6 * 8;

static void two_capacitors_and_a_switch(void **state) {
    (void)state;
    for (int w = 0; w < WAYS; w++) {
        bench b = open_bench(w);
        capacitor(&b, "c1", 1, 0, c1, 10);
        capacitor(&b, "c2", 2, 0, c2, 2);
        switch_at(&b, "s", "vg", 1, 2, 1);
        jump(&b);
        near(&b, b.Lambda[0], over, over);
        near(&b, v_of(&b, 1), 0, over);
        close_bench(&b);
    }
}

/* At a start that is not consistent, and not again in the first trial. */
static void two_capacitors_and_a_diode_at_a_start(void **state) {
    (void)state;
    for (int w = 0; w < WAYS; w++) {
        bench b = open_bench(w);
        double reached;
        capacitor(&b, "c1", 1, 0, c1, 10);
        capacitor(&b, "c2", 2, 0, c2, 2);
        blocking(&b, "d", 1, 2);
        start(&b);
        near(&b, b.Lambda[0], over, over);
        assert_int_equal(ns_march_try(b.m, 1e-6, NS_TO_EVENT, &reached), NS_OK);
        look(&b);
        nothing(&b);
        close_bench(&b);
    }
}

/* A charge pump: the source jumps by 8 V behind C1, whose other side feeds C2 through a diode; the diode that
 * charged C1 blocks. */
static void a_source_that_jumps(void **state) {
    (void)state;
    for (int w = 0; w < WAYS; w++) {
        bench b = open_bench(w);
        const int v = source(&b, "v", 1, 0, 0, 8);
        capacitor(&b, "c1", 2, 1, c1, 0);
        blocking(&b, "d1", 0, 2);
        blocking(&b, "d2", 2, 3);
        capacitor(&b, "c2", 3, 0, c2, 0);
        jump(&b);
        near(&b, b.Lambda[0], 0, over);
        near(&b, b.Lambda[1], over, over);
        near(&b, i_of(&b, v), -over, over);
        close_bench(&b);
    }
}

/* Eight diodes in a row: each carries the charge of the one capacitor behind them. */
static void a_row_of_diodes(void **state) {
    (void)state;
    for (int w = 0; w < WAYS; w++) {
        bench b = open_bench(w);
        const int v = source(&b, "v", 1, 0, 0, 8);
        for (int i = 1; i <= 8; i++) {
            const char name[] = {'d', (char)('0' + i), 0};
            blocking(&b, name, i, i + 1);
        }
        capacitor(&b, "c", 9, 0, c1, 0);
        jump(&b);
        for (int j = 0; j < 8; j++)
            near(&b, b.Lambda[j], 8e-6, 8e-6);
        near(&b, i_of(&b, v), -8e-6, 8e-6);
        close_bench(&b);
    }
}

/* 1 mH with 2 A, short-circuited by a switch that opens; a diode leads into 3 mH without current: i+ = L1
 * i/(L1+L2) in both, and what opens has the flux L2 i+ across it.  No charge moves. */
static void an_inductor_into_another(void **state) {
    (void)state;
    for (int w = 0; w < WAYS; w++) {
        bench b = open_bench(w);
        const double flux = 3e-3 * 1e-3 * 2 / 4e-3;
        inductor(&b, "l1", 0, 1, 1e-3, 2);
        switch_at(&b, "s", "vg", 1, 0, 0);
        blocking(&b, "d", 1, 2);
        const int l2 = inductor(&b, "l2", 2, 0, 3e-3, 0);
        jump(&b);
        near(&b, v_of(&b, 1), flux, flux);
        near(&b, v_of(&b, 2), flux, flux);
        near(&b, i_of(&b, l2), 0, flux);
        near(&b, b.Lambda[0], 0, flux);
        near(&b, b.Lambda[1], 0, flux);
        close_bench(&b);
    }
}

/* A transformer of 1 mH and 4 mH, K = 0.9, with 2 A in the first winding, which a switch cuts; the second has
 * a diode and a capacitor: its flux M i1 = L2 i2 stays; the switch has the flux of the leakage, (1-k^2) L1
 * i1. */
static void a_transformer(void **state) {
    (void)state;
    for (int w = 0; w < WAYS; w++) {
        bench b = open_bench(w);
        const double k = 0.9, flux = (1 - k * k) * 1e-3 * 2;
        const int l1 = inductor(&b, "l1", 0, 1, 1e-3, 2), l2 = inductor(&b, "l2", 0, 2, 4e-3, 0);
        assert_int_equal(ns_circuit_coupling(b.c, "k", l1, l2, k, NULL), NS_OK);
        switch_at(&b, "s", "vg", 1, 0, 0);
        blocking(&b, "d", 2, 3);
        capacitor(&b, "c", 3, 0, 1, 0);
        jump(&b);
        near(&b, v_of(&b, 1), flux, flux);
        near(&b, v_of(&b, 2), 0, flux);
        near(&b, v_of(&b, 3), 0, flux);
        close_bench(&b);
    }
}

/* Nothing jumps where the diode takes over the current at once. */
static void a_freewheeling_diode(void **state) {
    (void)state;
    for (int w = 0; w < WAYS; w++) {
        bench b = open_bench(w);
        source(&b, "v", 1, 0, 5, 5);
        switch_at(&b, "s", "vg", 1, 2, 0);
        blocking(&b, "d", 0, 2);
        inductor(&b, "l", 2, 0, 1e-3, 2);
        jump(&b);
        nothing(&b);
        close_bench(&b);
    }
}

/* Two of the capacitors behind switches at one stiff source: each is an island, and what the source gives is
 * the sum. */
static void islands(void **state) {
    (void)state;
    for (int w = 0; w < WAYS; w++) {
        bench b = open_bench(w);
        const int v = source(&b, "v", 1, 0, 10, 10);
        source(&b, "vg", 90, 0, 0, 1);
        assert_int_equal(ns_circuit_switch(b.c, "s1", 1, 2, 90, 0, &contact, NULL), NS_OK);
        assert_int_equal(ns_circuit_switch(b.c, "s2", 1, 3, 90, 0, &contact, NULL), NS_OK);
        capacitor(&b, "c1", 2, 0, c1, 2);
        capacitor(&b, "c2", 3, 0, c2, 4);
        jump(&b);
        if (way[w].method != NS_THETA)
            assert_int_equal(ns_march_counts(b.m)->islands, 2);
        near(&b, b.Lambda[0], 8e-6, 1e-5);
        near(&b, b.Lambda[1], 18e-6, 1e-5);
        near(&b, i_of(&b, v), -26e-6, 1e-5);
        close_bench(&b);
    }
}

static void refusals(void **state) {
    (void)state;
    double x[2];
    assert_int_equal(ns_march_impulse(NULL, x, x), NS_E_NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_capacitors_and_a_switch),
        cmocka_unit_test(two_capacitors_and_a_diode_at_a_start),
        cmocka_unit_test(a_source_that_jumps),
        cmocka_unit_test(a_row_of_diodes),
        cmocka_unit_test(an_inductor_into_another),
        cmocka_unit_test(a_transformer),
        cmocka_unit_test(a_freewheeling_diode),
        cmocka_unit_test(islands),
        cmocka_unit_test(refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
