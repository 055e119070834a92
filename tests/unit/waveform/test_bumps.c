/* tests/unit/waveform/test_bumps.c - a pulse of current that starts at zero after an event and comes back to
 * zero long before the next one.
 *
 * 1 V is put onto R, L, C in series at t = 0.25, critically damped: R = 2 sqrt(L/C), T = sqrt(L C).  Then
 * i = (s/L) e^(-s/T), s = t - 0.25, with a peak of T/(e L) = C/(e T) at s = T and an integral of C 1 V.
 * Nothing but the current is looked at. */
#include "points_rig.h"

static const double begins = 0.25, stop = 1;

static void bump(ns_method method, double T) {
    const ns_signal step = pulse(0, 1, begins, 0, 0, 9, INFINITY);
    const double farads = T; /* and T henries and 2 ohm: i = s/T e^(-s/T) */
    unsigned char kind[8] = {0};
    const ns_waveform_options o = {
        .closest = 4.6e-14 * stop, .noise = method == NS_EXACT ? 0 : 1e-9, .kind = kind};
    int l;
    rig r = rig_begin();
    assert_int_equal(ns_circuit_source(r.c, "v", NS_VOLTAGE, 1, 0, &step, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(r.c, "r", 1, 2, 2, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(r.c, "l", 2, 3, T, 0, &l), NS_OK);
    assert_int_equal(ns_circuit_capacitor(r.c, "c", 3, 0, farads, 0, NULL), NS_OK);
    r.unknown = ns_circuit_current_unknown(r.c, l);
    kind[r.unknown] = 1;
    assert_int_equal(rig_prepare(&r, method, stop / 65536, &o), NS_OK);
    assert_int_equal(rig_run(&r, stop), NS_OK);
    const double peak = fabs(rig_largest(&r) * exp(1) - 1), charge = fabs(rig_integral(&r) / farads - 1);
    print_message("%d T = %.0e s: %d points, peak off by %.2g, integral by %.2g\n", (int)method, T, r.count,
                  peak, charge);
    /* time is known to half a unit in the last place: 2.8e-17 s */
    /* A peak that comes out of its line by less than lines/50 needs no point, and two points are `closest`
     * apart. Values may be off by `noise` of the peak all along the time after the bump. */
    const double apart = o.closest / T, noise = method == NS_EXACT ? 1e-12 : 1e-9;
    assert_true(peak < 2e-6 + 0.5 * apart * apart);
    assert_true(charge < 1e-4 + noise * exp(-1) * (stop - begins) / T);
    assert_true(r.count < 500);
    rig_end(&r);
}

static void seen_by_exact(void **state) {
    (void)state;
    for (int k = 3; k <= 12; k++)
        bump(NS_EXACT, pow(10, -k));
}

static void seen_by_sparse(void **state) {
    (void)state;
    for (int k = 3; k <= 12; k++)
        bump(NS_SPARSE, pow(10, -k));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(seen_by_exact),
        cmocka_unit_test(seen_by_sparse),
    };
    return cmocka_run_group_tests_name("bumps", tests, NULL, NULL);
}
