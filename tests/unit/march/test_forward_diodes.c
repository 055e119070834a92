/* tests/unit/march/test_forward_diodes.c - no diode blocks in forward direction, whatever rounding or leaks
 * excuse.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"

static ns_circuit *c;
static ns_system *s;
static ns_march *m;
static double x[16];

static void make(void) {
    assert_int_equal(ns_circuit_create(&c), NS_OK);
}

static double v(int node) {
    const int i = ns_circuit_node_unknown(c, node);
    return i < 0 ? 0 : x[i];
}

static void start(double theta, double h) {
    const ns_march_options o = {.theta = theta, .gamma = theta, .h = h};
    double w0[16];
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_true(s->n <= 16);
    assert_int_equal(ns_circuit_rest(c, w0), NS_OK);
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
}

static void go(double t) {
    double reached;
    assert_int_equal(ns_march_try(m, t, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_accept(m), NS_OK);
    assert_int_equal(ns_march_read(m, NULL, x, NULL, NULL), NS_OK);
}

static void end(void) {
    ns_march_free(m);
    ns_system_free(s);
    ns_circuit_free(c);
}

/* 1 A through an inductor alone, after C || 1 kohm || (10 ohm and a diode): the jump of its current leaves
 * rates that are rounding, and the diode turns on at once.  u = 1 A R (1 - exp(-t/RC)), R = 1000 || 10 ohm.
 * theta = 1/2: (h/RC)^2/12 = 1e-5; theta = 1: h/(2RC) t/RC exp(-t/RC)/(1 - exp(-t/RC)) = 1.6e-3. */
static void behind_an_inductor(double theta, double roff, double tolerance) {
    const ns_diode d = {0, 0, roff, INFINITY, 0};
    const double R = 1e4 / 1010, RC = R * 1e-5, t = 200e-6, u = R * (1 - exp(-t / RC));
    ns_signal one = {.kind = NS_DC};
    one.u.dc = 1;
    make();
    assert_int_equal(ns_circuit_source(c, "i1", NS_CURRENT, 0, 4, &one, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c1", 4, 2, 10e-6, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(c, "l1", 2, 0, 10e-3, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r1", 2, 4, 1000, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r2", 4, 3, 10, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d1", 3, 2, &d, NULL), NS_OK);
    start(theta, 1e-6);
    go(t);
    print_message("theta %g, roff %g: u = %.6f V, expected %.6f V\n", theta, roff, v(4) - v(2), u);
    assert_true(fabs((v(4) - v(2)) / u - 1) < tolerance);
    end();
}

static void a_diode_behind_an_inductor_turns_on(void **state) {
    (void)state;
    behind_an_inductor(0.5, INFINITY, 2e-5);
    behind_an_inductor(0.5, 1e12, 2e-5);
    behind_an_inductor(1, INFINITY, 2e-3);
    behind_an_inductor(1, 1e12, 2e-3);
}

/* 10 V sine between two nodes, a diode from ground to either: the lower one is at 0 V. */
static void a_floating_source_stands_on_ground(void **state) {
    (void)state;
    const ns_diode d = {0, 0, INFINITY, INFINITY, 0};
    ns_signal sine = {.kind = NS_SIN};
    sine.u.sin.va = 10;
    sine.u.sin.freq = 1000;
    make();
    assert_int_equal(ns_circuit_source(c, "v1", NS_VOLTAGE, 1, 2, &sine, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d1", 0, 1, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d2", 0, 2, &d, NULL), NS_OK);
    start(1, 1e-6);
    for (int k = 1; k <= 40; k++) {
        go(k * 50e-6);
        assert_true(fabs(v(1) - v(2) - 10 * sin(acos(-1) * k / 10)) < 1e-9);
        assert_true(fabs(fmin(v(1), v(2))) < 1e-9); /* 10 V and rounding */
    }
    end();
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_diode_behind_an_inductor_turns_on),
        cmocka_unit_test(a_floating_source_stands_on_ground),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
