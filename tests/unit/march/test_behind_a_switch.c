/* tests/unit/march/test_behind_a_switch.c - a tiny resistor beside a larger one, with an ideal switch between
 * them.
 *
 * Two capacitors of 1 uF at 3 V, joined by 1e-9 to 1e-13 ohm, charge a third one from 0 V through a switch
 * and 0.01 ohm: 2 V + 1 V exp(-t / tau), tau = 0.01 ohm 2/3 uF, and the charge of all three stays 6 uC.  The
 * closed switch joins two rows to one, whose conductances are 1e13 and 100: exact and auto ended at 2.033 V,
 * with 0.1 uC more than there is, without a word.  So it is where the switch has a resistance, if less.
 */
#include "rig.h"

#include "signals.h"

static const double closes = 1e-4;

static double volts(const rig *k, int node) {
    return k->x[ns_circuit_node_unknown(k->c, node)];
}

static void share(ns_method method, double ohm, double ron) {
    const double tau = (0.01 + ron) * 2e-6 / 3;
    const ns_switch contact = {0.5, 0, ron, INFINITY};
    const ns_signal gate = pulse(0, 1, closes, 0, 0, 1, 10);
    rig k = begin();
    assert_int_equal(ns_circuit_source(k.c, "vg", NS_VOLTAGE, 9, 0, &gate, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c1", 1, 0, 1e-6, 3, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c2", 2, 0, 1e-6, 3, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c3", 3, 0, 1e-6, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "r1", 1, 2, ohm, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "r2", 4, 3, 0.01, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(k.c, "s1", 2, 4, 9, 0, &contact, NULL), NS_OK);
    make_by(&k, &(ns_march_options){.theta = 1, .gamma = 1, .h = 1e-5, .method = method, .reltol = 1e-9});
    start_at_rest(&k);
    go(&k, closes);
    for (int i = 1; i <= 100; i++) {
        const double t = i * tau / 5;
        go(&k, closes + t);
        assert_true(fabs(volts(&k, 1) + volts(&k, 2) + volts(&k, 3) - 6) < 1e-9);
        assert_true(fabs(volts(&k, 2) - 2 - exp(-t / tau)) < 1e-6);
    }
    end(&k);
}

static void charge_is_shared(void **state) {
    static const ns_method methods[] = {NS_AUTO, NS_EXACT, NS_SPARSE};
    (void)state;
    static const double ron[] = {0, 1e-3, 1e-6, 1e-9};
    for (int i = 0; i < 12; i++)
        for (int decade = 9; decade <= 13; decade++)
            share(methods[i % 3], pow(10, -decade), ron[i / 3]);
}

/* Four capacitors of 1 uF, three of them at 3 V: each of the resistors is less than a million times the one
 * before.  After 30 of the longest time constant, 3/4 uF times the last, all are at 2.25 V.  (exact and auto:
 * 2.2495 V and 2.59 V, another grid 0.96 V.) */
static void spread(ns_method method, const double *ohm) {
    const ns_switch contact = {0.5, 0, 0, INFINITY};
    const double longest = ohm[2] * 0.75e-6;
    const ns_signal gate = pulse(0, 1, longest / 2, 0, 0, 100 * longest, 1000 * longest);
    rig k = begin();
    assert_int_equal(ns_circuit_source(k.c, "vg", NS_VOLTAGE, 9, 0, &gate, NULL), NS_OK);
    for (int i = 1; i <= 4; i++) {
        const char *const c[] = {"c1", "c2", "c3", "c4"}, *const r[] = {"r1", "r2", "r3"};
        assert_int_equal(ns_circuit_capacitor(k.c, c[i - 1], i, 0, 1e-6, i < 4 ? 3 : 0, NULL), NS_OK);
        if (i < 4)
            assert_int_equal(ns_circuit_resistor(k.c, r[i - 1], i < 3 ? i : 5, i + 1, ohm[i - 1], NULL),
                             NS_OK);
    }
    assert_int_equal(ns_circuit_switch(k.c, "s1", 3, 5, 9, 0, &contact, NULL), NS_OK);
    make_by(&k, &(ns_march_options){.theta = 1, .gamma = 1, .h = longest / 100, .method = method});
    start_at_rest(&k);
    for (int i = 1; i <= 31; i++) {
        go(&k, i * longest);
        assert_true(fabs(volts(&k, 1) + volts(&k, 2) + volts(&k, 3) + volts(&k, 4) - 9) < 1e-6);
    }
    assert_true(fabs(volts(&k, 1) - 2.25) < 1e-6 && fabs(volts(&k, 4) - 2.25) < 1e-6);
    end(&k);
}

static void charge_spreads(void **state) {
    static const ns_method methods[] = {NS_AUTO, NS_EXACT, NS_SPARSE};
    static const double ohm[][3] = {{1e-9, 0.9e-3, 810}, {1e-12, 1e-7, 1e-2}, {1e-13, 0.9e-7, 0.081}};
    (void)state;
    for (int i = 0; i < 9; i++)
        spread(methods[i % 3], ohm[i / 3]);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(charge_is_shared), cmocka_unit_test(charge_spreads)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
