/* tests/unit/circuit/test_stamp.c - elements -> (S1)-(S3): every stamp against equations written by hand.
 *
 * Rows of nodes: M x' = A x + b + E z + B lambda is the sum of the currents that leave through capacitors
 * equal to minus the sum of all others that leave.
 */
#include <float.h>
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

static ns_system *system_of(ns_circuit *c, int n, int m, int nz, int nc) {
    ns_system *s = NULL;
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_int_equal(s->n, n);
    assert_int_equal(s->m, m);
    assert_int_equal(s->nz, nz);
    assert_int_equal(s->nc, nc);
    return s;
}

static ns_signal sine(void) {
    ns_signal s = {.kind = NS_SIN};
    s.u.sin.va = 1;
    s.u.sin.freq = 50;
    return s;
}

static void no_elements(void **state) {
    ns_circuit *c = make();
    (void)state;
    ns_system_free(system_of(c, 0, 0, 0, 0));
    assert_int_equal(ns_circuit_rest(c, NULL), NS_OK);
    ns_circuit_free(c);
    ns_circuit_free(NULL);
}

/* R = 4 ohm from 5 to 2, C = 3 F from 2 to ground, 1 A leaving node 5: x = (v2, v5). */
static void resistor_capacitor_current(void **state) {
    ns_circuit *c = make();
    ns_signal one = dc(1);
    ns_system *s;
    int id = -1;
    (void)state;
    assert_int_equal(ns_circuit_name_node(c, 1, "nobody's"), NS_OK); /* no element has it: no unknown */
    assert_int_equal(ns_circuit_resistor(c, "r1", 5, 2, 4, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c1", 2, 0, 3, NAN, &id), NS_OK);
    assert_int_equal(id, 1);
    assert_int_equal(ns_circuit_source(c, "i1", NS_CURRENT, 5, 0, &one, NULL), NS_OK);
    s = system_of(c, 2, 0, 0, 0);
    ASSERT_ARRAY(s->M, 2, 2, 3, 0, 0, 0);
    ASSERT_ARRAY(s->A, 2, 2, -0.25, 0.25, 0.25, -0.25);
    ASSERT_ARRAY(s->b, 2, 1, 0, -1);
    assert_int_equal(ns_circuit_node_unknown(c, 2), 0);
    assert_int_equal(ns_circuit_node_unknown(c, 5), 1);
    assert_int_equal(ns_circuit_node_unknown(c, 0), -1);
    assert_int_equal(ns_circuit_node_unknown(c, 3), -1);
    assert_int_equal(ns_circuit_node_unknown(c, 1), -1);
    assert_int_equal(ns_circuit_current_unknown(c, 0), -1);
    ns_system_free(s);
    ns_circuit_free(c);
}

/* A capacitor between two nodes: C (v1' - v2') leaves node 1. */
static void floating_capacitor(void **state) {
    ns_circuit *c = make();
    ns_system *s;
    (void)state;
    assert_int_equal(ns_circuit_capacitor(c, "c1", 1, 2, 2, NAN, NULL), NS_OK);
    s = system_of(c, 2, 0, 0, 0);
    ASSERT_ARRAY(s->M, 2, 2, 2, -2, -2, 2);
    ns_system_free(s);
    ns_circuit_free(c);
}

/* V (dc 12) at node 1, V (sine) from 2 to 1, short (R = 0) from 2 to 3: x = (v1 v2 v3 i1 i2 i3). */
static void voltage_sources_and_shorts(void **state) {
    ns_circuit *c = make();
    ns_signal twelve = dc(12), wave = sine();
    ns_system *s;
    int id;
    (void)state;
    assert_int_equal(ns_circuit_source(c, "v1", NS_VOLTAGE, 1, 0, &twelve, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v2", NS_VOLTAGE, 2, 1, &wave, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "short", 2, 3, 0, &id), NS_OK);
    assert_int_equal(ns_circuit_current_unknown(c, id), 5);
    s = system_of(c, 6, 0, 1, 0);
    ASSERT_ARRAY(s->A, 6, 6,         //
                 0, 0, 0, -1, 1, 0,  // i1 leaves node 1, i2 enters
                 0, 0, 0, 0, -1, -1, // i2 and i3 leave node 2
                 0, 0, 0, 0, 0, 1,   //
                 -1, 0, 0, 0, 0, 0,  // 0 = 12 - v1
                 1, -1, 0, 0, 0, 0,  // 0 = z - (v2 - v1)
                 0, -1, 1, 0, 0, 0); // 0 = -(v2 - v3)
    ASSERT_ARRAY(s->b, 6, 1, 0, 0, 0, 12, 0, 0);
    ASSERT_ARRAY(s->E, 6, 1, 0, 0, 0, 0, 1, 0);
    assert_int_equal(s->z[0].kind, NS_SIN);
    ns_system_free(s);
    ns_circuit_free(c);
}

static void current_source_of_time(void **state) {
    ns_circuit *c = make();
    ns_signal wave = sine();
    ns_system *s;
    (void)state;
    assert_int_equal(ns_circuit_source(c, "i1", NS_CURRENT, 1, 2, &wave, NULL), NS_OK);
    s = system_of(c, 2, 0, 1, 0);
    ASSERT_ARRAY(s->E, 2, 1, -1, 1);
    ns_system_free(s);
    ns_circuit_free(c);
}

/* L1 = 1 H at node 1, L2 = 4 H from 2 to 1, k = 0.5: M12 = 0.5 sqrt(4) = 1 H.  x = (v1 v2 i1 i2). */
static void coupled_inductors(void **state) {
    ns_circuit *c = make();
    ns_system *s;
    (void)state;
    assert_int_equal(ns_circuit_inductor(c, "l1", 1, 0, 1, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(c, "l2", 2, 1, 4, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_coupling(c, "k1", 0, 1, 0.5, NULL), NS_OK);
    s = system_of(c, 4, 0, 0, 0);
    ASSERT_ARRAY(s->M, 4, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 0, 0, 1, 4);
    ASSERT_ARRAY(s->A, 4, 4,   //
                 0, 0, -1, 1,  // i1 leaves node 1, i2 enters
                 0, 0, 0, -1,  //
                 1, 0, 0, 0,   // L i' = v1
                 -1, 1, 0, 0); // = v2 - v1
    ns_system_free(s);
    ns_circuit_free(c);
}

/* E: 0 = 5 (v3 - v2) - v1; G: 7 (v1 - v3) leaves node 2.  x = (v1 v2 v3 ie). */
static void controlled_by_voltage(void **state) {
    ns_circuit *c = make();
    ns_system *s;
    (void)state;
    assert_int_equal(ns_circuit_vcontrolled(c, "e1", NS_VOLTAGE, 1, 0, 3, 2, 5, NULL), NS_OK);
    assert_int_equal(ns_circuit_vcontrolled(c, "g1", NS_CURRENT, 2, 0, 1, 3, 7, NULL), NS_OK);
    s = system_of(c, 4, 0, 0, 0);
    ASSERT_ARRAY(s->A, 4, 4, 0, 0, 0, -1, -7, 0, 7, 0, 0, 0, 0, 0, -1, -5, 5, 0);
    ns_system_free(s);
    ns_circuit_free(c);
}

/* V = 0 as ammeter at node 1; H: 0 = 5 i_v - v2; F: 7 i_v leaves node 3.  x = (v1 v2 v3 iv ih). */
static void controlled_by_current(void **state) {
    ns_circuit *c = make();
    ns_signal zero = dc(0);
    ns_system *s;
    (void)state;
    assert_int_equal(ns_circuit_source(c, "v1", NS_VOLTAGE, 1, 0, &zero, NULL), NS_OK);
    assert_int_equal(ns_circuit_icontrolled(c, "h1", NS_VOLTAGE, 2, 0, 0, 5, NULL), NS_OK);
    assert_int_equal(ns_circuit_icontrolled(c, "f1", NS_CURRENT, 3, 0, 0, 7, NULL), NS_OK);
    s = system_of(c, 5, 0, 0, 0);
    ASSERT_ARRAY(s->A, 5, 5,     //
                 0, 0, 0, -1, 0, //
                 0, 0, 0, 0, -1, //
                 0, 0, 0, -7, 0, //
                 -1, 0, 0, 0, 0, //
                 0, -1, 0, 5, 0);
    ns_system_free(s);
    ns_circuit_free(c);
}

/* L at node 1; 0 = 3 + 2 v1 - 4 iL - v2, and 1.5 - v2 + 6 iL + 0.5 iL leaves node 1.  x = (v1 v2 iL ib). */
static void behavioural_sources(void **state) {
    const ns_term volts[] = {{0, 1, 2}, {1, 0, -4}, {0, 0, 99}};
    const ns_term amps[] = {{0, 2, -1}, {1, 0, 6}, {1, 0, 0.5}};
    ns_circuit *c = make();
    ns_system *s;
    (void)state;
    assert_int_equal(ns_circuit_inductor(c, "l1", 1, 0, 1, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_linear(c, "b1", NS_VOLTAGE, 2, 0, 3, 3, volts, NULL), NS_OK);
    assert_int_equal(ns_circuit_linear(c, "b2", NS_CURRENT, 1, 0, 1.5, 3, amps, NULL), NS_OK);
    s = system_of(c, 4, 0, 0, 0);
    ASSERT_ARRAY(s->A, 4, 4, 0, 1, -1 - 6.5, 0, 0, 0, 0, -1, 1, 0, 0, 0, 2, -1, -4, 0);
    ASSERT_ARRAY(s->b, 4, 1, -1.5, 0, 0, 3);
    ns_system_free(s);
    ns_circuit_free(c);
}

/* vf 0.6, ron 1, roff 5: the line v = 0.6 + i meets i = v/5 at v0 = 0.6/(1-1/5) = 0.75; D = 1/(1-1/5).
 * 4 ohm from its cathode to ground. */
static void diode(void **state) {
    ns_diode d = {0.6, 1, 5, INFINITY, 0};
    ns_circuit *c = make();
    ns_system *s;
    (void)state;
    assert_int_equal(ns_circuit_diode(c, "d1", 1, 2, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r1", 2, 0, 4, NULL), NS_OK);
    s = system_of(c, 2, 1, 0, 0);
    ASSERT_ARRAY(s->A, 2, 2, -0.2, 0.2, 0.2, -0.45);
    ASSERT_ARRAY(s->B, 2, 1, -1, 1);
    ASSERT_ARRAY(s->C, 1, 2, -1, 1);
    ASSERT_ARRAY(s->D, 1, 1, 1.25);
    ASSERT_ARRAY(s->e, 1, 1, 0.75);
    assert_true(s->l[0] == 0 && isinf(s->u[0]));
    ns_system_free(s);
    ns_circuit_free(c);
}

/* Also vz 3, rz 2: breakdown starts at -3/(1-2/5) = -5 V and has 2/(1-2/5) = 10/3 ohm beside the leak. */
static void diode_with_breakdown(void **state) {
    ns_diode d = {0.6, 1, 5, 3, 2};
    ns_circuit *c = make();
    ns_system *s;
    (void)state;
    assert_int_equal(ns_circuit_diode(c, "d1", 0, 1, &d, NULL), NS_OK);
    s = system_of(c, 1, 2, 0, 0);
    ASSERT_ARRAY(s->A, 1, 1, -0.2);
    ASSERT_ARRAY(s->B, 1, 2, 1, -1);
    ASSERT_ARRAY(s->C, 2, 1, 1, -1);
    ASSERT_ARRAY(s->D, 2, 2, 1.25, 0, 0, 10. / 3);
    ASSERT_ARRAY(s->e, 2, 1, 0.75, 5);
    ns_system_free(s);
    ns_circuit_free(c);
}

/* No leak, no resistance: nothing but the pair; and extremes that are finite stay so. */
static void ideal_limits(void **state) {
    ns_diode ideal = {0, 0, INFINITY, INFINITY, 0}, close_by = {0.7, 1, nextafter(1, 2), INFINITY, 0};
    ns_diode tiny = {0, 1e-9, 1e12, INFINITY, 0};
    ns_circuit *c = make();
    ns_system *s;
    (void)state;
    assert_int_equal(ns_circuit_diode(c, "d1", 1, 0, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d2", 2, 0, &close_by, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d3", 3, 0, &tiny, NULL), NS_OK);
    s = system_of(c, 3, 3, 0, 0);
    assert_true(s->A[0] == 0 && s->D[0] == 0 && s->e[0] == 0);
    assert_true(fabs(s->D[4] - 1 / DBL_EPSILON) < 4);
    ASSERT_ARRAY(&s->D[8], 1, 1, 1e-9); /* 1e-9/(1-1e-21) */
    ns_system_free(s);
    ns_circuit_free(c);
}

/* Closes by v3 - v1; 4 ohm from 2 to ground, node 3 controls and nothing else. */
static void switch_by_nodes(void **state) {
    ns_switch sw = {1, 0.25, 1, 5};
    ns_circuit *c = make();
    ns_system *s;
    (void)state;
    assert_int_equal(ns_circuit_switch(c, "s1", 1, 2, 3, 1, &sw, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r1", 2, 0, 4, NULL), NS_OK);
    s = system_of(c, 3, 1, 0, 1);
    ASSERT_ARRAY(s->A, 3, 3, -0.2, 0.2, 0, 0.2, -0.45, 0, 0, 0, 0);
    ASSERT_ARRAY(s->B, 3, 1, -1, 1, 0);
    ASSERT_ARRAY(s->C, 1, 3, -1, 1, 0);
    ASSERT_ARRAY(s->D, 1, 1, 1.25);
    ASSERT_ARRAY(s->e, 1, 1, 0);
    ASSERT_ARRAY(s->command[0].gx, 1, 3, -1, 0, 1);
    assert_null(s->command[0].gz);
    assert_int_equal(s->command[0].pair, 0);
    assert_true(s->command[0].on == 1.25 && s->command[0].off == 0.75 && s->command[0].g0 == 0);
    ns_system_free(s);
    ns_circuit_free(c);
}

/* v1 = z0, v2 = v1 - 5, v4 - v3 = z1 with neither tied to ground, v5 = 3 (v2 - v1) = -15, v6 = 2 v5 - v1 + 1
 * = -29 - z0, node 7 behind a resistor,
 * v9 = 1 + i(v1).  Sources stand in an order that takes more than one pass. */
static void controls_set_by_sources(void **state) {
    const ns_term terms[] = {{0, 5, 2}, {0, 1, -1}}, of_current = {1, 2, 1};
    ns_circuit *c = make();
    ns_switch sw = {0, 0, 0, INFINITY};
    ns_signal wave = sine(), five = dc(5);
    ns_system *s;
    const ns_command *k;
    (void)state;
    assert_int_equal(ns_circuit_linear(c, "b1", NS_VOLTAGE, 6, 0, 1, 2, terms, NULL), NS_OK);
    assert_int_equal(ns_circuit_vcontrolled(c, "e1", NS_VOLTAGE, 0, 5, 2, 1, -3, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v1", NS_VOLTAGE, 1, 0, &wave, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v2", NS_VOLTAGE, 1, 2, &five, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v3", NS_VOLTAGE, 4, 3, &wave, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r1", 1, 7, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(c, "s1", 8, 0, 2, 0, &sw, NULL), NS_OK); /* v2 */
    assert_int_equal(ns_circuit_switch(c, "s2", 8, 0, 3, 4, &sw, NULL), NS_OK); /* -z1 */
    assert_int_equal(ns_circuit_switch(c, "s3", 8, 0, 3, 1, &sw, NULL), NS_OK); /* of the circuit */
    assert_int_equal(ns_circuit_switch(c, "s4", 8, 0, 5, 0, &sw, NULL), NS_OK); /* v5 */
    assert_int_equal(ns_circuit_switch(c, "s5", 8, 0, 6, 0, &sw, NULL), NS_OK); /* v6 */
    assert_int_equal(ns_circuit_switch(c, "s6", 8, 0, 7, 0, &sw, NULL), NS_OK); /* of the circuit */
    assert_int_equal(ns_circuit_switch(c, "s7", 8, 0, 7, 7, &sw, NULL), NS_OK); /* 0 */
    assert_int_equal(ns_circuit_linear(c, "b2", NS_VOLTAGE, 9, 0, 1, 1, &of_current, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(c, "s8", 8, 0, 9, 0, &sw, NULL), NS_OK); /* of the circuit */
    s = system_of(c, 9 + 6, 8, 2, 8);
    k = s->command;
    assert_true(k[0].gx == NULL && k[0].g0 == -5 && k[0].gz[0] == 1 && k[0].gz[1] == 0);
    assert_true(k[1].gx == NULL && k[1].g0 == 0 && k[1].gz[0] == 0 && k[1].gz[1] == -1);
    assert_true(k[2].gx != NULL && k[2].gz == NULL && k[2].gx[2] == 1 && k[2].gx[0] == -1);
    assert_true(k[3].gx == NULL && k[3].gz == NULL && k[3].g0 == -15);
    assert_true(k[4].gx == NULL && k[4].g0 == -29 && k[4].gz[0] == -1 && k[4].gz[1] == 0);
    assert_true(k[5].gx != NULL && k[5].gx[6] == 1);
    assert_true(k[6].gx == NULL && k[6].gz == NULL && k[6].g0 == 0);
    assert_true(k[7].gx != NULL && k[7].gx[8] == 1);
    ns_system_free(s);
    ns_circuit_free(c);
}

/* Both ends on one node: the element takes part in nothing but its own row; 4 ohm lead to ground. */
static void both_ends_on_one_node(void **state) {
    ns_circuit *c = make();
    ns_diode d = {0.7, 0, INFINITY, INFINITY, 0};
    ns_system *s;
    (void)state;
    assert_int_equal(ns_circuit_resistor(c, "r1", 1, 1, 2, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c1", 1, 1, 2, 5, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d1", 1, 1, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r2", 1, 0, 4, NULL), NS_OK);
    s = system_of(c, 1, 1, 0, 0);
    assert_true(s->M[0] == 0 && s->A[0] == -0.25 && s->B[0] == 0 && s->C[0] == 0 && s->e[0] == 0.7);
    ns_system_free(s);
    ns_circuit_free(c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_elements),
        cmocka_unit_test(resistor_capacitor_current),
        cmocka_unit_test(floating_capacitor),
        cmocka_unit_test(voltage_sources_and_shorts),
        cmocka_unit_test(current_source_of_time),
        cmocka_unit_test(coupled_inductors),
        cmocka_unit_test(controlled_by_voltage),
        cmocka_unit_test(controlled_by_current),
        cmocka_unit_test(behavioural_sources),
        cmocka_unit_test(diode),
        cmocka_unit_test(diode_with_breakdown),
        cmocka_unit_test(ideal_limits),
        cmocka_unit_test(switch_by_nodes),
        cmocka_unit_test(controls_set_by_sources),
        cmocka_unit_test(both_ends_on_one_node),
    };
    return cmocka_run_group_tests_name("circuit", tests, NULL, NULL);
}
