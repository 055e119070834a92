/* tests/unit/exact/test_many_diode_events.c - a trial with thousands of events of a diode in a few h. */
#include "exact_bench.h"

/* 1 nH and 1 nF at 1 V ring with sqrt(LC) = 1 ns, and a diode leads from them to 1 Gohm: it conducts in every
 * positive half wave, and takes 1 V / 1 Gohm, so that the ring loses 1/(4 R C) 20 us = 5e-6 of its size:
 * v = cos(20 us / 1 ns).  A switch is commanded by the state, and never changes.
 *
 * From circuit two-level 24001000022 of the stress set: in one h there are 6400 events, which take more steps
 * than a trial was allowed; short steps of first order went on for an h at a time, and damped the ring away.
 */
static void a_ring_through_a_diode_is_not_damped(void **state) {
    const double end = 20e-6;
    bench b = open_bench();
    const ns_diode d = {.roff = INFINITY, .vz = INFINITY};
    const ns_switch contact = {.vt = 0.5, .roff = INFINITY};
    (void)state;
    assert_int_equal(ns_circuit_inductor(b.c, "l", 1, 0, 1e-9, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c", 1, 0, 1e-9, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(b.c, "d", 1, 2, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 2, 0, 1e9, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c3", 3, 0, 1, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r3", 1, 3, 1e12, NULL), NS_OK); /* one part, not two */
    assert_int_equal(ns_circuit_switch(b.c, "s", 4, 0, 3, 0, &contact, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r4", 4, 0, 1, NULL), NS_OK);
    start(&b, end);
    near(go(&b, end, NS_TO_TIME), end, 0);
    near(v_of(&b, 1), cos(end / 1e-9), 1e-4);
    near((double)ns_march_counts(b.m)->events, end / (pi * 1e-9), 2);
    close_bench(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_ring_through_a_diode_is_not_damped)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
