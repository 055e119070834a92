/* tests/unit/circuit/test_initial.c - charges and fluxes that a circuit begins with. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "arrays.h"
#include "nonsmooth/circuit.h"
#include "signals.h"

static ns_circuit *make(void) {
    ns_circuit *c = NULL;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    return c;
}

/* C1 = 2 F with ic 3 from 1 to 2 overrides the nodes; C2 = 5 F from 2 to 3 takes v2 - v3 = 4 - 0; L1 = 1 H
 * with 2 A, L2 = 4 H without, k = 1: M = 2.  Charges leave through the capacitors' first nodes. */
static void initial_charges(void **state) {
    ns_circuit *c = make();
    double w0[5], hold_x[2] = {0};
    int hold[2];
    (void)state;
    assert_int_equal(ns_circuit_node_ic(c, 1, 100), NS_OK);
    assert_int_equal(ns_circuit_node_ic(c, 77, 9), NS_OK); /* no element has it: no unknown */
    assert_int_equal(ns_circuit_capacitor(c, "c1", 1, 2, 2, 3, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c2", 2, 3, 5, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(c, "l1", 1, 0, 1, 2, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(c, "l2", 3, 0, 4, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_coupling(c, "k1", 2, 3, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_node_ic(c, 2, 7), NS_OK);
    assert_int_equal(ns_circuit_node_ic(c, 2, 4), NS_OK); /* the last one holds */
    assert_int_equal(ns_circuit_rest(c, w0), NS_OK);
    ASSERT_ARRAY(w0, 5, 1, 2 * 3, -2 * 3 + 5 * 4, -5 * 4, 1 * 2, 2 * 2);
    assert_int_equal(ns_circuit_node_ic_count(c), 2);
    assert_int_equal(ns_circuit_hold(c, hold, hold_x), 2);
    assert_true(hold[0] == 0 && hold[1] == 1 && hold_x[0] == 100 && hold_x[1] == 4);
    assert_int_equal(ns_circuit_rest(c, NULL), NS_E_NULL);
    assert_int_equal(ns_circuit_rest(NULL, w0), NS_E_NULL);
    ns_circuit_free(c);
}

/* 1: of a source; 2: of two in series; 3: its own; 4: 2 V above 3, by a source. */
static void ic_yields_to_sources(void **state) {
    const ns_signal volts = {.kind = NS_DC, .u.dc = 2};
    ns_circuit *c = make();
    double hold_x[4] = {0};
    int hold[4];
    (void)state;
    assert_int_equal(ns_circuit_source(c, "v1", NS_VOLTAGE, 1, 0, &volts, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v2", NS_VOLTAGE, 2, 1, &volts, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v3", NS_VOLTAGE, 4, 3, &volts, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c1", 3, 0, 1, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_hold(c, hold, hold_x), 0);
    for (int node = 1; node <= 4; node++)
        assert_int_equal(ns_circuit_node_ic(c, node, 10 + node), NS_OK);
    assert_int_equal(ns_circuit_node_ic_count(c), 4);
    assert_int_equal(ns_circuit_hold(c, hold, hold_x), 1);
    assert_true(hold[0] == ns_circuit_node_unknown(c, 3) && hold_x[0] == 13);
    ns_circuit_free(c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(initial_charges),
        cmocka_unit_test(ic_yields_to_sources),
    };
    return cmocka_run_group_tests_name("initial", tests, NULL, NULL);
}
