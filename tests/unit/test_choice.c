/* tests/unit/test_choice.c - one engine hands over to another: the state goes on, switches stay as they are.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "engine/marcher.h"
#include "nonsmooth.h"

/* 1 V, 1 kohm, 1 uF; across it a switch of 100 ohm that closes above 0.8 V and opens below 0.2 V.  From 0 it
 * charges as 1 - exp(-t/1 ms), to 0.8 V at t1 = ln 5 ms, then falls from there to 1/11 V with 1/11 ms. */
static const double t1 = 1.6094379124341003e-3, tau = 1e-3 / 11, end = 1. / 11;

static double falling(double since) {
    return end + (0.8 - end) * exp(-since / tau);
}

static ns_circuit *oscillator(void) {
    ns_circuit *c;
    ns_signal one = {.kind = NS_DC};
    const ns_switch contact = {0.5, 0.3, 100, INFINITY};
    one.u.dc = 1;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v", NS_VOLTAGE, 1, 0, &one, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r", 1, 2, 1e3, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c", 2, 0, 1e-6, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(c, "s", 2, 0, 2, 0, &contact, NULL), NS_OK);
    return c;
}

static void go(ns_march *m, double t) {
    double reached;
    assert_int_equal(ns_march_try(m, t, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_accept(m), NS_OK);
}

static void near(const ns_circuit *c, ns_march *m, double expected) {
    double x[8];
    assert_int_equal(ns_march_read(m, NULL, x, NULL, NULL), NS_OK);
    assert_true(fabs(x[ns_circuit_node_unknown(c, 2)] - expected) < 1e-7); /* legs good to 1e-9 */
}

/* Between its thresholds, closed: nothing but its past tells that. */
static void a_closed_switch_stays_closed(void **state) {
    (void)state;
    ns_circuit *c = oscillator();
    ns_system *s;
    ns_march *m;
    double w0[8] = {0};
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-5, .method = NS_SPARSE};
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_true(s->n <= 8);
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
    go(m, t1 + 0.5 * tau);
    near(c, m, falling(0.5 * tau));
    assert_int_equal(ns_march_engine(m), NS_SPARSE);
    assert_int_equal(ns_choice_leave(m), NS_OK);
    assert_int_equal(ns_march_engine(m), NS_FLIGHT);
    go(m, t1 + tau);
    near(c, m, falling(tau));
    ns_march_free(m);
    ns_system_free(s);
    ns_circuit_free(c);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_closed_switch_stays_closed)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
