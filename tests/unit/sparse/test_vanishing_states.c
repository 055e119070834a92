/* tests/unit/sparse/test_vanishing_states.c - a capacitor that has discharged for so long that its voltage
 * has lost its digits (below 2e-308), beside a loop of closed switches: that is no contradiction. */
#include <math.h>

#include "rig.h"

enum { A = 1, B, C, GATE, SLOW };

static void ok(int status) {
    assert_int_equal(status, NS_OK);
}

static ns_signal pulse(double delay, double width, double period) {
    return (ns_signal){.kind = NS_PULSE,
                       .u.pulse = {.v2 = 1, .td = delay, .tr = 1e-8, .tf = 1e-8, .pw = width, .per = period}};
}

/* 646 ohm and 0.3 uF have 200 us; after 700 of these it is 1e-304 V. */
static void a_loop_of_switches_beside_what_has_vanished(void **state) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = NS_SPARSE, .whole = 1};
    const ns_switch s = {.vt = 0.5, .vh = 0, .ron = 0, .roff = 3e7};
    const ns_signal gate = pulse(2e-4, 4.6e-4, 1e-3), slow = pulse(3e-4, 3e-4, 1.3e-3);
    rig k = begin();
    (void)state;
    ok(ns_circuit_capacitor(k.c, "c", B, A, 3e-7, 1, NULL));
    ok(ns_circuit_resistor(k.c, "r1", A, 0, 13.32, NULL));
    ok(ns_circuit_resistor(k.c, "r2", C, B, 646, NULL));
    ok(ns_circuit_resistor(k.c, "r3", B, 0, 1434, NULL));
    ok(ns_circuit_resistor(k.c, "r4", C, A, 53.07, NULL));
    ok(ns_circuit_source(k.c, "g", NS_VOLTAGE, GATE, 0, &gate, NULL));
    ok(ns_circuit_source(k.c, "h", NS_VOLTAGE, SLOW, 0, &slow, NULL));
    ok(ns_circuit_switch(k.c, "s1", A, C, GATE, 0, &s, NULL));
    ok(ns_circuit_switch(k.c, "s2", C, 0, GATE, 0, &s, NULL));
    ok(ns_circuit_switch(k.c, "s3", A, 0, SLOW, 0, &s, NULL));
    make_by(&k, &o);
    start_at_rest(&k);
    ok(go_on(&k, 0.4));
    assert_true(fabs(k.x[ns_circuit_node_unknown(k.c, B)]) < 1e-300);
    assert_int_equal(ns_march_engine(k.m), NS_SPARSE);
    end(&k);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_loop_of_switches_beside_what_has_vanished)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
