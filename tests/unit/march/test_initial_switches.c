/* tests/unit/march/test_initial_switches.c - a switch that is closed at the start between its thresholds, and
 * one that a current commands. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"

enum { MOST = 12 };

static const ns_method methods[] = {NS_EXACT, NS_SPARSE, NS_THETA, NS_AUTO};

typedef struct bench {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
} bench;

static void make(bench *b, ns_circuit *c, ns_method method) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = method};
    b->c = c;
    assert_int_equal(ns_circuit_system(c, &b->s), NS_OK);
    assert_true(b->s->n <= MOST);
    assert_int_equal(ns_march_create(b->s, &o, &b->m, NULL), NS_OK);
}

static void clear(bench *b) {
    ns_march_free(b->m);
    ns_system_free(b->s);
    ns_circuit_free(b->c);
}

/* The voltage of a node at t, s. */
static double volts_at(bench *b, int node, double t) {
    double x[MOST], reached;
    assert_int_equal(ns_march_try(b->m, t, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_accept(b->m), NS_OK);
    assert_int_equal(ns_march_read(b->m, NULL, x, NULL, NULL), NS_OK);
    return x[ns_circuit_node_unknown(b->c, node)];
}

static void start(bench *b, int from_rest) {
    double w[MOST];
    if (from_rest) {
        assert_int_equal(ns_circuit_rest(b->c, w), NS_OK);
        assert_int_equal(ns_march_start(b->m, 0, w), NS_OK);
    } else
        assert_int_equal(ns_march_start_dc(b->m, 0, 0, NULL, NULL, NULL), NS_OK);
}

/* A switch of 1 ohm, thresholds 1 V and 3 V, feeds 1 ohm from 6 V: 3 V while it is closed, else 0.  Its
 * control is 2 V until 1 ms, and then falls to 0 V within 1 ms: closed until 1.5 ms if it begins so.
 * by_state: through 1 kohm without current, so that it is no function of time alone. */
static ns_circuit *between_thresholds(int by_state, int closed) {
    static const double t[] = {0, 1e-3, 2e-3}, v[] = {2, 2, 0};
    const ns_signal control = {.kind = NS_PWL, .u.pwl = {.n = 3, .t = t, .v = v, .repeat = NAN}};
    const ns_signal supply = {.kind = NS_DC, .u.dc = 6};
    const ns_switch s = {2, 1, 1, INFINITY};
    ns_circuit *c;
    int id;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v1", NS_VOLTAGE, 1, 0, &supply, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v2", NS_VOLTAGE, 3, 0, &control, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r2", 3, 4, 1e3, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(c, "s1", 1, 2, by_state ? 4 : 3, 0, &s, &id), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r1", 2, 0, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch_initially(c, id, closed), NS_OK);
    return c;
}

static void initially(void **unused) {
    (void)unused;
    for (int k = 0; k < 32; k++) {
        const int closed = k & 1, by_state = k >> 1 & 1, from_rest = k >> 2 & 1;
        bench b;
        make(&b, between_thresholds(by_state, closed), methods[k >> 3]);
        start(&b, from_rest);
        const double early = volts_at(&b, 2, 1.4e-3), late = volts_at(&b, 2, 1.6e-3);
        if (!(fabs(early - 3 * closed) < 1e-9) || !(fabs(late) < 1e-9))
            fail_msg("method %d, case %d: %g V, then %g V", (int)methods[k >> 3], k & 7, early, late);
        clear(&b);
    }
}

static void refused(void **unused) {
    (void)unused;
    const ns_switch s = {2, 1, 1, INFINITY};
    ns_circuit *c = between_thresholds(0, 0);
    assert_int_equal(ns_circuit_switch_initially(NULL, 0, 1), NS_E_NULL);
    assert_int_equal(ns_circuit_switch_initially(c, 0, 1), NS_E_SIZE);
    assert_int_equal(ns_circuit_switch_initially(c, 99, 1), NS_E_SIZE);
    assert_int_equal(ns_circuit_switch_by_current(c, "w1", 1, 2, 99, 1, &s, NULL), NS_E_SIZE);
    assert_int_equal(ns_circuit_switch_by_current(c, "w1", 1, 2, 2, 1, &s, NULL),
                     NS_E_SIZE); /* r2: no unknown */
    assert_int_equal(ns_circuit_switch_by_current(c, "w1", 1, 2, 0, 1, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_circuit_switch_by_current(c, "w1", 1, 2, 0, NAN, &s, NULL), NS_E_NUMBER);
    ns_circuit_free(c);
}

/* 1 V onto 1 mH: a current of 1 A/ms through v1, forwards or (with gain -1) backwards.  The switch closes at
 * 3 A and pulls node 2 from 6 V to 3 V.
 */
static void by_current(void **unused) {
    (void)unused;
    const ns_signal supply = {.kind = NS_DC, .u.dc = 6};
    const ns_switch s = {2, 1, 1, INFINITY};
    for (int k = 0; k < 8; k++) {
        const int sign = k >= 4 ? -1 : 1;
        const ns_signal one = {.kind = NS_DC, .u.dc = -sign};
        bench b;
        ns_circuit *c;
        int v1;
        assert_int_equal(ns_circuit_create(&c), NS_OK);
        assert_int_equal(ns_circuit_source(c, "v1", NS_VOLTAGE, 1, 0, &one, &v1), NS_OK);
        assert_int_equal(ns_circuit_inductor(c, "l1", 1, 0, 1e-3, NAN, NULL), NS_OK);
        assert_int_equal(ns_circuit_source(c, "v2", NS_VOLTAGE, 3, 0, &supply, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(c, "r1", 3, 2, 1, NULL), NS_OK);
        assert_int_equal(ns_circuit_switch_by_current(c, "w1", 2, 0, v1, sign, &s, NULL), NS_OK);
        make(&b, c, methods[k % 4]);
        start(&b, 1);
        const double early = volts_at(&b, 2, 2.999e-3), late = volts_at(&b, 2, 3.001e-3);
        if (!(fabs(early - 6) < 1e-9) || !(fabs(late - 3) < 1e-9))
            fail_msg("method %d: %g V, then %g V", (int)methods[k % 4], early, late);
        clear(&b);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(initially), cmocka_unit_test(refused),
                                       cmocka_unit_test(by_current)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
