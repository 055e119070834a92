/* tests/unit/sparse/test_leaky_transients.c - a transient through the leak of a device, shorter than the
 * shortest usual step, whose fluxes count.
 *
 * C, at 6 V, discharges through a diode with ron.  From it L1 and L2 lead in series to ground; a second diode
 * leads from between the two to ground.  Their currents begin at 0.7 and 0.8 A: the difference, which that
 * diode blocks, decays through its leak in L1/roff, while L1 i1 + L2 i2 stays, to
 *
 *     i1 = i2 = i = (0.7 L1 + 0.8 L2)/(L1 + L2).
 *
 * Then C drives the diode forward, and i2 stays, while i1 = i + 6 V ron C/L1 (1 - e^(-t/ron C)).
 * What a step leaves of the difference, because it is longer than the transient, stays in the diode: it was
 * 11 mA.
 */
#include "rig.h"

enum { FED = 1, MIDDLE };
static const double V = 6, C = 1e-8, RON = 1e-3, L1 = 1e-4, L2 = 1e-2, t = 1e-10;

static rig build(double roff) {
    const ns_diode diode = {.ron = RON, .roff = roff, .vz = INFINITY};
    rig k = begin();
    assert_int_equal(ns_circuit_capacitor(k.c, "c", FED, 0, C, V, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(k.c, "d1", FED, 0, &diode, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(k.c, "d2", MIDDLE, 0, &diode, NULL), NS_OK);
    return k;
}

/* The larger error of i1, i2. */
static double off(double roff) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = NS_SPARSE};
    const double i = (0.7 * L1 + 0.8 * L2) / (L1 + L2);
    rig k = build(roff);
    int l1, l2;
    assert_int_equal(ns_circuit_inductor(k.c, "l1", FED, MIDDLE, L1, 0.7, &l1), NS_OK);
    assert_int_equal(ns_circuit_inductor(k.c, "l2", MIDDLE, 0, L2, 0.8, &l2), NS_OK);
    make_by(&k, &o);
    start_at_rest(&k);
    go(&k, t);
    const double gained = V * RON * C / L1 * (1 - exp(-t / (RON * C)));
    const double first = current(&k, l1) - i - gained, second = current(&k, l2) - i;
    end(&k);
    return fmax(fabs(first), fabs(second));
}

/* 1e-6 A: the leak itself carries 6 V over 1e8 ohm, and C loses 0.1 % to the coil. */
static void of_any_length(void **state) {
    (void)state;
    for (int k = 0; k < 14; k++) {
        const double roff = 1e8 * pow(3, k), is = off(roff);
        if (is > 1e-6)
            print_message("roff %g: off by %g A\n", roff, is);
        assert_true(is <= 1e-6);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(of_any_length)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
