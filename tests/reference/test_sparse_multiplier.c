/* tests/reference/test_sparse_multiplier.c - an ideal Cockcroft-Walton multiplier by the sparse engine,
 * against the exact engine, which shares none of its steps.
 *
 * It has modes whose state the sine does not reach, so that guards alone see how long a step may be, loops of
 * capacitors and the source that a cut-off sine contradicts, and at each crest currents that reach zero
 * together.  The exact engine's own error is below 1e-12 of closed forms in other tests. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "nonsmooth.h"

enum { STAGES = 5, TIMES = 20, NODES = 2 * STAGES };
static const double freq = 10e3, volts = 100, farad = 1e-6, load = 1e6, end = 1e-3; /* ten periods */

/* Diode j from node j to node j+1, capacitors from each node to the next but one; the source drives node 1.
 */
static ns_circuit *multiplier(void) {
    const ns_diode diode = {0, 0, INFINITY, INFINITY, 0};
    ns_signal sine = {.kind = NS_SIN};
    ns_circuit *c;
    char name[24];
    sine.u.sin.va = volts;
    sine.u.sin.freq = freq;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v", NS_VOLTAGE, NODES + 1, 0, &sine, NULL), NS_OK);
    for (int k = 1; k <= NODES; k++) {
        (void)snprintf(name, sizeof name, "c%d", k);
        assert_int_equal(ns_circuit_capacitor(c, name, k == 1 ? NODES + 1 : k - 2, k, farad, 0, NULL), NS_OK);
        (void)snprintf(name, sizeof name, "d%d", k);
        assert_int_equal(ns_circuit_diode(c, name, k - 1, k, &diode, NULL), NS_OK);
    }
    assert_int_equal(ns_circuit_resistor(c, "r", NODES, 0, load, NULL), NS_OK);
    return c;
}

/* Voltages of all nodes (TIMES*NODES). */
static void run(ns_method method, double h, double reltol, double *values) {
    ns_circuit *c = multiplier();
    ns_system *s;
    ns_march *m;
    double reached;
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = h, .method = method, .reltol = reltol};
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    double *x = calloc((size_t)s->n, sizeof *x);
    assert_non_null(x);
    assert_int_equal(ns_circuit_rest(c, x), NS_OK);
    assert_int_equal(ns_march_start(m, 0, x), NS_OK);
    for (int i = 0; i < TIMES; i++) {
        assert_int_equal(ns_march_try(m, end * (i + 1) / TIMES, NS_TO_TIME, &reached), NS_OK);
        assert_int_equal(ns_march_accept(m), NS_OK);
        assert_int_equal(ns_march_read(m, NULL, x, NULL, NULL), NS_OK);
        for (int k = 1; k <= NODES; k++)
            values[i * NODES + k - 1] = x[ns_circuit_node_unknown(c, k)];
    }
    const ns_counts *n = ns_march_counts(m);
    print_message("h %g reltol %g: %ld steps, %ld events, %ld factors\n", h, reltol, n->steps, n->events,
                  n->factors);
    free(x);
    ns_march_free(m);
    ns_system_free(s);
    ns_circuit_free(c);
}

/* Ten times what a step is asked for, for there are many; of the largest voltage there is, 2 STAGES volts. */
static void test_multiplier(void **state) {
    (void)state;
    static double right[TIMES * NODES], values[TIMES * NODES];
    run(NS_EXACT, 1 / freq / 64, 0, right);
    for (int digits = 6; digits <= 9; digits++) {
        const double reltol = pow(10, -digits);
        run(NS_SPARSE, 1 / freq, reltol, values);
        for (int i = 0; i < TIMES * NODES; i++)
            assert_true(fabs(values[i] - right[i]) < 10 * reltol * 2 * STAGES * volts);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_multiplier)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
