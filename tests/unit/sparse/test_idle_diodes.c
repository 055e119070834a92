/* tests/unit/sparse/test_idle_diodes.c - diodes that conduct nothing but rounding, beside 0.8 A.
 *
 * A coil, a capacitor C with R, and 1 V in a ring, which diodes and a capacitor tie to ground:
 * once these have discharged it none carries anything.  Of the voltage u of C and the current i,
 *
 *     L i' = -(u + 1 V) - R i,   C u' = i,   so  u + 1 V = e^(-a t) (A cos(w t) + B sin(w t)),
 *
 * a = R/2L, w^2 = 1/LC - a^2, A = u(0) + 1 V, B = (i(0)/C + a A)/w.
 *
 * Signs of that rounding were taken for a transient in each step, which is shown as a straight line: where
 * these signs stood at its begin as well, as its end.  u was that of up to 0.2 us later.
 */
#include "rig.h"
#include "signals.h"

enum { TOP = 1, TIED, BOTTOM, BEHIND };
static const double R = 10, L = 0.1, C = 1e-5, U = 2, I = 0.8;

static double closed_form(double t) {
    const double a = R / (2 * L), w = sqrt(1 / (L * C) - a * a), A = U + 1, B = (I / C + a * A) / w;
    return exp(-a * t) * (A * cos(w * t) + B * sin(w * t)) - 1;
}

static rig build(void) {
    const ns_diode ideal = {.roff = INFINITY, .vz = INFINITY};
    const ns_signal one = dc(1);
    rig k = begin();
    assert_int_equal(ns_circuit_capacitor(k.c, "c", TOP, BOTTOM, C, U, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(k.c, "l", TIED, TOP, L, I, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(k.c, "v", NS_VOLTAGE, BEHIND, TIED, &one, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "r", BOTTOM, BEHIND, R, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(k.c, "d1", TIED, 0, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(k.c, "d2", TIED, 0, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(k.c, "d3", 0, TOP, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c2", TIED, 0, 1e-8, 4, NULL), NS_OK);
    return k;
}

/* At the end of trials that end within steps. */
static void between_steps(void **state) {
    (void)state;
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = NS_SPARSE};
    rig k = build();
    make_by(&k, &o);
    start_at_rest(&k);
    for (int i = 0; i < 60; i++) {
        const double t = 1e-6 * i + 3e-7;
        go(&k, t);
        const double u = k.x[ns_circuit_node_unknown(k.c, TOP)] - k.x[ns_circuit_node_unknown(k.c, BOTTOM)];
        assert_true(fabs(u - closed_form(t)) < 1e-8 * closed_form(t));
    }
    end(&k);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(between_steps)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
