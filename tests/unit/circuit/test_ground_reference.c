/* tests/unit/circuit/test_ground_reference.c - parts of a circuit without a connection to ground get one, of
 * 1 S; others none.
 *
 * Each test compares with the equations written by hand: A is theirs but for -1 on one diagonal entry, as
 * (S1) has currents that leave with minus sign.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth/circuit.h"
#include "nonsmooth/march.h"

static ns_circuit *make(void) {
    ns_circuit *c = NULL;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    return c;
}

/* The diagonal of A at the nodes, which come first; frees the circuit. */
static void assert_diagonal(ns_circuit *c, int nodes, const double *expected) {
    ns_system *s = NULL;
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    for (int i = 0; i < nodes; i++) {
        const double is = s->A[(size_t)i * (size_t)(s->n + 1)];
        if (is != expected[i]) {
            fail_msg("diagonal entry %d is %.17g, expected %.17g", i, is, expected[i]);
        }
    }
    ns_system_free(s);
    ns_circuit_free(c);
}
#define ASSERT_DIAGONAL(c, nodes, ...) assert_diagonal(c, nodes, (const double[]){__VA_ARGS__})

static void add_current(ns_circuit *c, int p, int n) {
    const ns_signal one = {.kind = NS_DC, .u.dc = 1};
    assert_int_equal(ns_circuit_source(c, "i1", NS_CURRENT, p, n, &one, NULL), NS_OK);
}

/* L1 at node 1; L2, and 4 ohm across it, between 2 and 3; 2 ohm from 3 to 4: windings do not connect. */
static ns_circuit *transformer(void) {
    ns_circuit *c = make();
    assert_int_equal(ns_circuit_inductor(c, "l1", 1, 0, 1, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(c, "l2", 2, 3, 4, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_coupling(c, "k1", 0, 1, 0.5, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r1", 2, 3, 4, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r2", 3, 4, 2, NULL), NS_OK);
    return c;
}

static void isolated_secondary_gets_one(void **state) {
    (void)state;
    ASSERT_DIAGONAL(transformer(), 4, 0, -0.25 - 1, -0.75, -0.5);
}

/* The same with 1/8 S from any of its nodes to ground: nothing but that. */
static void grounded_secondary_gets_none(void **state) {
    (void)state;
    for (int node = 2; node <= 4; node++) {
        ns_circuit *c = transformer();
        assert_int_equal(ns_circuit_resistor(c, "r3", 0, node, 8, NULL), NS_OK);
        ASSERT_DIAGONAL(c, 4, 0, node == 2 ? -0.375 : -0.25, node == 3 ? -0.875 : -0.75,
                        node == 4 ? -0.625 : -0.5);
    }
}

/* 1 and 3, 2 and 4, 5 and 6, the last two joined through 7 after that: a part each, one each. */
static void each_part_gets_one(void **state) {
    ns_circuit *c = make();
    (void)state;
    assert_int_equal(ns_circuit_resistor(c, "r1", 3, 1, 2, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r2", 2, 4, 4, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c1", 6, 7, 1, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c2", 5, 7, 1, NAN, NULL), NS_OK);
    ASSERT_DIAGONAL(c, 7, -0.5 - 1, -0.25 - 1, -0.5, -0.25, -1, 0, 0);
}

/* A switch from 1 to ground controlled by 2 and 3, sources from 1 to ground by 4 and by 5, which are nobody's
 * nodes otherwise: their voltage stays undetermined. */
static void node_that_only_controls_gets_none(void **state) {
    const ns_switch sw = {0, 0, 0, INFINITY};
    const ns_term terms[] = {{0, 5, 2}};
    ns_circuit *c = make();
    (void)state;
    assert_int_equal(ns_circuit_switch(c, "s1", 1, 0, 2, 3, &sw, NULL), NS_OK);
    assert_int_equal(ns_circuit_vcontrolled(c, "e1", NS_VOLTAGE, 1, 0, 4, 0, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_linear(c, "b1", NS_CURRENT, 1, 0, 0, 1, terms, NULL), NS_OK);
    ASSERT_DIAGONAL(c, 5, 0, 0, 0, 0, 0);
}

/* 1 A from ground into 1, and 2 ohm from there to 2: its current has no way back. */
static void behind_a_current_source_gets_none(void **state) {
    ns_circuit *c = make();
    (void)state;
    add_current(c, 0, 1);
    assert_int_equal(ns_circuit_resistor(c, "r1", 1, 2, 2, NULL), NS_OK);
    ASSERT_DIAGONAL(c, 2, -0.5, -0.5);
}

/* An open switch connects: what stands behind it is for the leaks to settle. */
static void behind_a_switch_gets_none(void **state) {
    const ns_switch sw = {0, 0, 0, INFINITY};
    ns_circuit *c = make();
    (void)state;
    assert_int_equal(ns_circuit_resistor(c, "r1", 1, 2, 2, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(c, "s1", 2, 0, 0, 0, &sw, NULL), NS_OK);
    ASSERT_DIAGONAL(c, 2, -0.5, -0.5);
}

/* Both ends of all its elements are there: a part of one node. */
static void node_by_itself_gets_one(void **state) {
    ns_circuit *c = make();
    (void)state;
    assert_int_equal(ns_circuit_resistor(c, "r1", 1, 1, 2, NULL), NS_OK);
    ASSERT_DIAGONAL(c, 1, -1);
}

/* 1 A round through 2 ohm, nothing to ground, node 2 held at 5 V (SPICE's .ic): the operating point is v2 =
 * 5, v1 = v2 + 2 V, as no current leaves the part.  With the gauge at node 1 a share of it would. */
static void held_node_is_taken_first(void **state) {
    ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-3};
    ns_circuit *c = make();
    ns_system *s = NULL;
    ns_march *m = NULL;
    int hold = -1;
    double hold_x = 0, x[2];
    (void)state;
    add_current(c, 2, 1);
    assert_int_equal(ns_circuit_resistor(c, "r1", 1, 2, 2, NULL), NS_OK);
    assert_int_equal(ns_circuit_node_ic(c, 2, 5), NS_OK);
    assert_int_equal(ns_circuit_hold(c, &hold, &hold_x), 1);
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_start_dc(m, 0, 1, &hold, &hold_x, x), NS_OK);
    assert_true(fabs(x[0] - 7) < 1e-12 && fabs(x[1] - 5) < 1e-12); /* a 2 by 2 system: some eps of 7 */
    ns_march_free(m);
    ns_system_free(s);
    ns_circuit_free(c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(isolated_secondary_gets_one),
        cmocka_unit_test(grounded_secondary_gets_none),
        cmocka_unit_test(each_part_gets_one),
        cmocka_unit_test(node_that_only_controls_gets_none),
        cmocka_unit_test(behind_a_current_source_gets_none),
        cmocka_unit_test(behind_a_switch_gets_none),
        cmocka_unit_test(node_by_itself_gets_one),
        cmocka_unit_test(held_node_is_taken_first),
    };
    return cmocka_run_group_tests_name("gauge", tests, NULL, NULL);
}
