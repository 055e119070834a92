/* tests/unit/march/test_floating_parts.c - an island between open diodes: its guards must not drown in the
 * bound on their rounding, nor its voltage hang on that of its resistors. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"

/* 1 V, L1 and C in a loop, C across a bridge whose load is L2, all from rest.  Before the bridge conducts,
 * the loop floats: the voltages of single diodes hang on nothing, but -v_D1 - v_D3 = -v_C < 0 tells that it
 * must conduct, from the start on: L1 i1' = 1 - v,  C v' = i1 - i2,  L2 i2' = v:   v = V (1 - cos wt),  V =
 * L2/(L1+L2), w^2 = (1/L1 + 1/L2)/C,   i2 = V (t - sin(wt)/w)/L2 */
static void a_floating_bridge_starts_to_conduct(void **state) {
    (void)state;
    enum { P = 1, N, T, S };
    const ns_diode ideal = {0, 0, INFINITY, INFINITY, 0};
    const double L1 = 150e-6, L2 = 400e-6, C = 68e-9, t = 1.5e-6, h = 1e-8;
    const double V = L2 / (L1 + L2), w = sqrt((1 / L1 + 1 / L2) / C),
                 expected = V * (t - sin(w * t) / w) / L2;
    const ns_march_options o = {.theta = 0.5, .gamma = 0.5, .h = h};
    ns_signal one = {.kind = NS_DC};
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    double w0[16], x[16], reached;
    int l2;
    one.u.dc = 1;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v1", NS_VOLTAGE, S, N, &one, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(c, "l1", S, P, L1, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c1", P, N, C, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d1", P, T, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d2", N, T, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d3", 0, N, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d4", 0, P, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(c, "l2", T, 0, L2, 0, &l2), NS_OK);
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_true(s->n <= 16);
    assert_int_equal(ns_circuit_rest(c, w0), NS_OK);
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
    assert_int_equal(ns_march_try(m, t, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_read(m, NULL, x, NULL, NULL), NS_OK);
    const double i2 = x[ns_circuit_current_unknown(c, l2)];
    print_message("i(L2) = %.6e A, expected %.6e A; %ld events\n", i2, expected, ns_march_counts(m)->events);
    assert_true(fabs(i2 / expected - 1) <
                1e-4); /* (h w)^2 / 12 = 1e-6, and (h/t)^2 / 2 = 2e-5 for i2 ~ t^3 */
    assert_true(ns_march_counts(m)->events <= 1); /* none if the start saw it */
    ns_march_free(m);
    ns_system_free(s);
    ns_circuit_free(c);
}

enum { STAR_NODES = 6 };

/* Two phases of coil and resistor and one of a resistor alone in star, behind a diode that blocks: its
 * voltage hangs on nothing.  node: numbers of the nodes. */
static ns_circuit *make_star(const int *node, const double *ohms, int *coil) {
    const ns_diode diode = {0.4, 0, INFINITY, INFINITY, 0};
    ns_circuit *c;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d1", 0, node[0], &diode, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(c, "l1", node[0], node[1], 10e-3, 0, &coil[0]), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r1", node[1], node[2], ohms[0], NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r2", node[2], node[3], ohms[1], NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(c, "l2", node[3], node[4], 0.6e-3, 0, &coil[1]), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r3", node[2], node[5], ohms[2], NULL), NS_OK);
    return c;
}

static void starts_at_rest(const int *node, const double *ohms) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-9};
    double w0[16], x[16], reached;
    int coil[2];
    ns_circuit *c = make_star(node, ohms, coil);
    ns_system *s;
    ns_march *m;
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_true(s->n <= 16);
    assert_int_equal(ns_circuit_rest(c, w0), NS_OK);
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
    assert_int_equal(ns_march_try(m, 1e-7, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_read(m, NULL, x, NULL, NULL), NS_OK);
    for (int i = 0; i < 2; i++)
        assert_true(fabs(x[ns_circuit_current_unknown(c, coil[i])]) < 1e-12);
    ns_march_free(m);
    ns_system_free(s);
    ns_circuit_free(c);
}

/* Conductances at the star point are summed in the order of the nodes, and rounded: whatever that order is,
 * the part floats. */
static void a_star_floats_in_any_order(void **state) {
    static const double ohms[][3] = {{10, 10, 11.43}, {10, 11.43, 10}, {3, 7, 0.3}, {1e3, 0.01, 47}};
    int node[STAR_NODES];
    (void)state;
    for (int order = 0; order < 720; order++) {
        int left[STAR_NODES] = {1, 2, 3, 4, 5, 6};
        for (int k = 0, rest = order; k < STAR_NODES; rest /= STAR_NODES - k, k++) {
            const int at = rest % (STAR_NODES - k);
            node[k] = left[at];
            left[at] = left[STAR_NODES - 1 - k];
        }
        starts_at_rest(node, ohms[order % 4]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_floating_bridge_starts_to_conduct),
                                       cmocka_unit_test(a_star_floats_in_any_order)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
