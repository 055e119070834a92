/* tests/unit/sparse/test_retry.c - a trial that is not accepted leaves no trace: not in what comes after,
 * either.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"

enum { MOST = 8 };

/* 100 kHz through a diode into 10 ohm and 20 uH with a freewheel diode: two flips of each a period. */
static ns_circuit *rectifier(void) {
    const ns_diode d = {0, 0, INFINITY, INFINITY, 0};
    ns_circuit *c;
    ns_signal s = {.kind = NS_SIN};
    s.u.sin.va = 10;
    s.u.sin.freq = 1e5;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v1", NS_VOLTAGE, 1, 0, &s, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d1", 1, 2, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d2", 0, 2, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(c, "l1", 2, 3, 20e-6, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r1", 3, 0, 10, NULL), NS_OK);
    return c;
}

/* x at 203 us, by steps of 7 us; before each, a trial to `ahead` beyond it that is thrown away. */
static void go(ns_method method, double ahead, double *x) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = method};
    ns_circuit *c = rectifier();
    ns_system *s;
    ns_march *m;
    double w0[MOST], reached;
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_true(s->n <= MOST);
    assert_int_equal(ns_circuit_rest(c, w0), NS_OK);
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
    for (int k = 1; k <= 29; k++) {
        if (ahead > 0)
            assert_int_equal(ns_march_try(m, 7e-6 * k + ahead, NS_TO_TIME, &reached), NS_OK);
        assert_int_equal(ns_march_try(m, 7e-6 * k, NS_TO_TIME, &reached), NS_OK);
        assert_int_equal(ns_march_accept(m), NS_OK);
    }
    assert_int_equal(ns_march_read(m, NULL, x, NULL, NULL), NS_OK);
    ns_march_free(m);
    ns_system_free(s);
    ns_circuit_free(c);
}

/* The same steps to their last digits, but for tolerances that know the largest charge there was: rounding.
 */
static void leaves_no_trace(void **unused) {
    (void)unused;
    const ns_method methods[] = {NS_EXACT, NS_SPARSE, NS_THETA};
    for (int k = 0; k < 3; k++) {
        double x[MOST], y[MOST];
        go(methods[k], 0, x);
        go(methods[k], 200e-6, y);
        print_message("method %d: %.12g V, after trials %.12g V\n", (int)methods[k], x[2], y[2]);
        for (int i = 0; i < 3; i++)
            assert_true(fabs(x[i] - y[i]) < 1e-12);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(leaves_no_trace)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
