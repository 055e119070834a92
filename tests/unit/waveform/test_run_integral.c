/* tests/unit/waveform/test_run_integral.c - the integral of the lines over a whole run of smooth bumps whose
 * errors have one sign: that of the waveform within 4/3 `lines` (src/waveform/README.md, Integrals). */
#include "points_rig.h"

/* C and L side by side, a bridge of diodes behind them with R: the bridge makes R look like a plain resistor,
 *     v = 10 e^-at (cos wt - (a/w) sin wt),  a = 1/(2RC),  w^2 = 1/(LC) - a^2
 * The voltage of R is |v|, and the flux L i of the coil is the integral of v: over all bumps the sum of the
 * ways between its turns, L i = -L (C v' + v/R),  at the zeros of v, where tan wt = w/a. */
static const double C = 1e-6, L = 10e-3, R = 1e3;

static double flux_at_zero(int n) {
    const double a = 1 / (2 * R * C), w = sqrt(1 / (L * C) - a * a), t = (atan2(w, a) + n * acos(-1)) / w;
    return -L * C * 10 * exp(-a * t) * (-2 * a * cos(w * t) + (a * a / w - w) * sin(w * t));
}

static double flux_of_bumps(int zeros) {
    double sum = fabs(flux_at_zero(0));
    for (int n = 1; n < zeros; n++)
        sum += fabs(flux_at_zero(n) - flux_at_zero(n - 1));
    return sum;
}

static void add_bridge(ns_circuit *c) {
    static const int anode[] = {1, 2, 0, 0}, cathode[] = {3, 3, 2, 1};
    static const char *const name[] = {"d1", "d2", "d3", "d4"};
    const ns_diode d = {0, 0, INFINITY, INFINITY, 0};
    for (int k = 0; k < 4; k++)
        assert_int_equal(ns_circuit_diode(c, name[k], anode[k], cathode[k], &d, NULL), NS_OK);
}

static void bumps_of_a_ring(void **state) {
    static const double lines[] = {1e-2, 1e-3, 1e-4};
    (void)state;
    for (int k = 0; k < 3; k++) {
        rig r = rig_begin();
        assert_int_equal(ns_circuit_capacitor(r.c, "c", 1, 2, C, 10, NULL), NS_OK);
        assert_int_equal(ns_circuit_inductor(r.c, "l", 1, 2, L, 0, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(r.c, "r", 3, 0, R, NULL), NS_OK);
        add_bridge(r.c);
        r.unknown = ns_circuit_node_unknown(r.c, 3);
        unsigned char looked[64] = {0};
        looked[r.unknown] = 1;
        const ns_waveform_options o = {.lines = lines[k], .closest = 1e-15, .kind = looked};
        assert_int_equal(rig_prepare(&r, NS_EXACT, 1e-6, &o), NS_OK);
        assert_int_equal(rig_run(&r, 0.1), NS_OK); /* e^-50 is left */
        assert_true(fabs(rig_integral(&r) / flux_of_bumps(300) - 1) <= 4.0 / 3 * lines[k]);
        rig_end(&r);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(bumps_of_a_ring)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
