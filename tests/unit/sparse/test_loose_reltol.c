/* tests/unit/sparse/test_loose_reltol.c - the sparse marcher at loose settings: small currents beside large
 * ones. */
#include "rig.h"
#include "signals.h"

enum { SUPPLY = 1, FIRST = 10, GROUNDED, BEHIND, SECOND, HELD, PEAK, GATE };

static void ok(int status) {
    assert_int_equal(status, NS_OK);
}

/* A peak held behind diodes of 1 mohm, and a branch that two switches short: kiloamperes. */
static ns_circuit *build(void) {
    const ns_diode diode = {.vf = 0, .ron = 1e-3, .roff = 1000, .vz = INFINITY};
    const ns_switch contact = {.vt = 0.5, .vh = 0, .ron = 0, .roff = 1e6};
    const ns_signal sine = {.kind = NS_SIN, .u.sin = {.va = 20, .freq = 7000, .phase = 37.630330324172974}},
                    gate = pulse(0, 1, 0, 0, 0, 4e-6, 10e-6);
    ns_circuit *c = NULL;
    ok(ns_circuit_create(&c));
    ok(ns_circuit_source(c, "v", NS_VOLTAGE, SUPPLY, 0, &sine, NULL));
    ok(ns_circuit_source(c, "g", NS_VOLTAGE, GATE, 0, &gate, NULL));
    ok(ns_circuit_resistor(c, "r", HELD, PEAK, 100, NULL));
    ok(ns_circuit_capacitor(c, "c", PEAK, 0, 1.7e-9, NAN, NULL));
    ok(ns_circuit_diode(c, "d1", SECOND, FIRST, &diode, NULL));
    ok(ns_circuit_diode(c, "d2", FIRST, HELD, &diode, NULL));
    ok(ns_circuit_switch(c, "s1", GROUNDED, 0, GATE, 0, &contact, NULL));
    ok(ns_circuit_diode(c, "d3", SUPPLY, SECOND, &diode, NULL));
    ok(ns_circuit_diode(c, "d4", FIRST, BEHIND, &diode, NULL));
    ok(ns_circuit_switch(c, "s2", GROUNDED, BEHIND, GATE, 0, &contact, NULL));
    return c;
}

/* The peak, V, after 21.59 us. */
static double peak(ns_method method, double reltol) {
    const ns_march_options o = {
        .theta = 1, .gamma = 1, .h = 8.58e-8, .method = method, .whole = 1, .reltol = reltol};
    rig at = {.c = build()};
    make_by(&at, &o);
    start_at_rest(&at);
    go(&at, 21.59e-6);
    const double v = at.x[ns_circuit_node_unknown(at.c, PEAK)];
    end(&at);
    return v;
}

/* A diode was let carry what is little beside kiloamperes the wrong way, and emptied the capacitor: 6.7 V. */
static void held_peak(void **state) {
    (void)state;
    const double exact = peak(NS_EXACT, 1e-9);
    assert_true(exact > 12 && exact < 13);
    assert_true(fabs(peak(NS_SPARSE, 1e-3) - exact) < 20 * 1e-3);
    assert_true(fabs(peak(NS_SPARSE, 1e-9) - exact) < 20 * 1e-9);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(held_peak)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
