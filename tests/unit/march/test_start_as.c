/* tests/unit/march/test_start_as.c - a marcher that goes on where another one was: a switch between its
 * thresholds stays as it was, in each island.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"

enum { MOST = 12, PARTS = 2 };

/* Twice: a switch of 1 ohm, closed above 3 V and open below 1 V, feeds 1 ohm and 1 uF from 6 V; its control
 * falls from 4 V at 0 s by 1 V/ms (nodes 10 k + 1, 2, 3). */
static ns_circuit *make_circuit(void) {
    static const double t[] = {0, 4e-3}, v[] = {4, 0};
    const ns_signal ramp = {.kind = NS_PWL, .u.pwl = {.n = 2, .t = t, .v = v, .repeat = NAN}};
    const ns_signal supply = {.kind = NS_DC, .u.dc = 6};
    const ns_switch s = {2, 1, 1, INFINITY};
    ns_circuit *c;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    for (int k = 0; k < PARTS; k++) {
        const int at = 10 * k;
        const char *const name[][5] = {{"v1", "g1", "s1", "r1", "c1"}, {"v2", "g2", "s2", "r2", "c2"}};
        assert_int_equal(ns_circuit_source(c, name[k][0], NS_VOLTAGE, at + 1, 0, &supply, NULL), NS_OK);
        assert_int_equal(ns_circuit_source(c, name[k][1], NS_VOLTAGE, at + 3, 0, &ramp, NULL), NS_OK);
        assert_int_equal(ns_circuit_switch(c, name[k][2], at + 1, at + 2, at + 3, 0, &s, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(c, name[k][3], at + 2, 0, 1, NULL), NS_OK);
        assert_int_equal(ns_circuit_capacitor(c, name[k][4], at + 2, 0, 1e-6, NAN, NULL), NS_OK);
    }
    return c;
}

static void go_to(ns_march *m, double t) {
    double reached;
    assert_int_equal(ns_march_try(m, t, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_accept(m), NS_OK);
}

/* v(2), v(12) are `volts`. */
static void expect(ns_march *m, const ns_circuit *c, double volts) {
    double x[MOST];
    assert_int_equal(ns_march_read(m, NULL, x, NULL, NULL), NS_OK);
    for (int k = 0; k < PARTS; k++) {
        const double v = x[ns_circuit_node_unknown(c, 10 * k + 2)];
        if (!(fabs(v - volts) < 1e-6))
            fail_msg("v(%d) = %.17g V in place of %g", 10 * k + 2, v, volts);
    }
}

/* Closed at 2 ms, where the control is 2 V, in the middle of both thresholds: 3 V, until 3 ms.  Without the
 * mode it opens.  Whole: in one system, not by islands. */
static void between_thresholds(void **unused) {
    (void)unused;
    static const ns_method methods[] = {NS_EXACT, NS_SPARSE, NS_THETA, NS_AUTO};
    for (int k = 0; k < 8; k++) {
        const ns_march_options o = {
            .theta = 1, .gamma = 1, .h = 1e-6, .method = methods[k / 2], .whole = k % 2};
        ns_circuit *c = make_circuit();
        ns_system *s;
        ns_march *first, *second;
        double x[MOST], w[MOST];
        assert_int_equal(ns_circuit_system(c, &s), NS_OK);
        assert_true(s->n <= MOST);
        assert_int_equal(ns_march_create(s, &o, &first, NULL), NS_OK);
        assert_int_equal(ns_march_create(s, &o, &second, NULL), NS_OK);
        assert_int_equal(ns_circuit_rest(c, w), NS_OK);
        assert_int_equal(ns_march_start(first, 0, w), NS_OK);
        go_to(first, 2e-3);
        expect(first, c, 3);
        assert_int_equal(ns_march_read(first, NULL, x, NULL, NULL), NS_OK);
        ns_system_charges(s, x, w);
        assert_int_equal(ns_march_start_as(second, 2e-3, w, ns_march_mode(first)), NS_OK);
        go_to(second, 2.9e-3);
        expect(second, c, 3);
        go_to(second, 3.9e-3);
        expect(second, c, 0);
        assert_int_equal(ns_march_start_as(second, 2e-3, w, NULL), NS_OK);
        go_to(second, 2.9e-3);
        expect(second, c, 0);
        assert_int_equal(ns_march_start_as(NULL, 2e-3, w, NULL), NS_E_NULL);
        assert_int_equal(ns_march_start_as(second, 2e-3, NULL, NULL), NS_E_NULL);
        ns_march_free(first);
        ns_march_free(second);
        ns_system_free(s);
        ns_circuit_free(c);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(between_thresholds)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
