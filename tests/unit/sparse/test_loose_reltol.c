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

enum { CLOCK = 1, OTHER_CLOCK, VOLTS, PUMPED, STAGES = 4 };

static void put_diode(ns_circuit *c, const char *name, int anode, int cathode) {
    const ns_diode ideal = {.roff = INFINITY, .vz = INFINITY};
    ok(ns_circuit_diode(c, name, anode, cathode, &ideal, NULL));
}

/* A charge pump without losses: 5 V, clocks of 5 V and 1 MHz, 1 uF a stage, 10 uF and 5 kohm at its end. */
static ns_circuit *build_pump(void) {
    const char *const capacitors[] = {"c1", "c2", "c3", "c4"}, *const diodes[] = {"d1", "d2", "d3", "d4"};
    const ns_signal up = pulse(0, 5, 0, 1e-8, 1e-8, 0.49e-6, 1e-6),
                    down = pulse(5, 0, 0, 1e-8, 1e-8, 0.49e-6, 1e-6), supply = {.kind = NS_DC, .u.dc = 5};
    const int last = PUMPED + STAGES;
    ns_circuit *c = NULL;
    ok(ns_circuit_create(&c));
    ok(ns_circuit_source(c, "v", NS_VOLTAGE, VOLTS, 0, &supply, NULL));
    ok(ns_circuit_source(c, "v1", NS_VOLTAGE, CLOCK, 0, &up, NULL));
    ok(ns_circuit_source(c, "v2", NS_VOLTAGE, OTHER_CLOCK, 0, &down, NULL));
    for (int i = 0; i < STAGES; i++) {
        put_diode(c, diodes[i], i == 0 ? VOLTS : PUMPED + i - 1, PUMPED + i);
        ok(ns_circuit_capacitor(c, capacitors[i], PUMPED + i, i % 2 ? OTHER_CLOCK : CLOCK, 1e-6, NAN, NULL));
    }
    put_diode(c, "d5", last - 1, last);
    ok(ns_circuit_capacitor(c, "c", last, 0, 10e-6, 24.9, NULL));
    ok(ns_circuit_resistor(c, "r", last, 0, 5e3, NULL));
    return c;
}

/* By how much it is below 25 V after 600 periods, each of which fills what the load took: 4 I/(f C) = 20 mV,
 * to the ripple of 0.25 mV.  That was 18 mV of another pump's 40 at reltol = 1e-3, and 33 mV at 1e-4. */
static void droop(void **state) {
    (void)state;
    static const double reltol[] = {1e-3, 1e-4, 1e-6};
    for (size_t k = 0; k < sizeof reltol / sizeof *reltol; k++) {
        const ns_march_options o = {
            .theta = 1, .gamma = 1, .h = 1e-9, .method = NS_SPARSE, .whole = 1, .reltol = reltol[k]};
        rig at = {.c = build_pump()};
        make_by(&at, &o);
        start_at_rest(&at);
        assert_int_equal(go_on(&at, 600e-6), NS_OK);
        const double below = 25 - at.x[ns_circuit_node_unknown(at.c, PUMPED + STAGES)];
        assert_true(fabs(below - 4 * (25 - below) / 5e3) < 0.25e-3); /* f C = 1 A/V */
        end(&at);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(held_peak), cmocka_unit_test(droop)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
