/* tests/unit/march/test_floating_parts.c - an island between open diodes: its guards must not drown in the
 * bound on their rounding. */
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

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_floating_bridge_starts_to_conduct)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
