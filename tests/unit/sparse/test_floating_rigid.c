/* tests/unit/sparse/test_floating_rigid.c - parts that float behind open devices and are far stiffer than the
 * leaks that fix their voltage, or at rest beside a high voltage. */
#include "parts.h"

#include <float.h>

/* A string of two capacitors with series resistances floats behind two diodes at an inductor: C / g of its
 * steps is 1e17 times a leak.  The diodes block, and the string discharges into its resistor:
 *
 *     v1 + v2 = 2 V e^(-t / RC),  C = C1 C2 / (C1 + C2);  C1 (V - v1) = C2 (V - v2)
 */
static void a_rigid_string_floats(void **state) {
    enum { SUPPLY = 1, W, X, P, N, E, M, F };
    const double V = 6.8, C1 = 0.7636e-3, C2 = 1.13e-3, R = 34.41, r1 = 1.105e-3, r2 = 1.222e-3, h = 2.26e-7;
    const ns_diode real = {.vf = 0.6248, .ron = 0.04334, .roff = INFINITY, .vz = INFINITY};
    rig k = begin();
    (void)state;
    source(&k, "v", SUPPLY, &(ns_signal){.kind = NS_SIN, .u.sin = {.va = V, .freq = 50}});
    resistor(&k, "r", SUPPLY, W, 0.3731);
    (void)inductor(&k, "l", W, X, 4.313e-3);
    assert_int_equal(ns_circuit_diode(k.c, "d1", X, P, &real, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(k.c, "d2", N, X, &real, NULL), NS_OK);
    resistor(&k, "r1", P, E, r1);
    capacitor(&k, "c1", E, M, C1, V);
    resistor(&k, "r2", M, F, r2);
    capacitor(&k, "c2", F, N, C2, V);
    resistor(&k, "rl", P, N, R);
    ready(&k, h);
    const double t = 1e-3, C = C1 * C2 / (C1 + C2), lost = C * 2 * V * -expm1(-t / ((R + r1 + r2) * C));
    go(&k, t);
    near(voltage(&k, E) - voltage(&k, M), V - lost / C1, V);
    near(voltage(&k, F) - voltage(&k, N), V - lost / C2, V);
    end(&k);
}

/* Half a bridge at rest, its supply of 11.53 V floating between two switches of 14 Mohm, their gates at
 * floating nodes: the supply's nodes are at half of it, and no current flows, but rounding of it. */
static void a_bridge_at_rest_starts(void **state) {
    enum { RA = 1, P, N, T, VC, GU, VD, GL, OUT, W, O };
    const double V = 11.53;
    const ns_switch weak = {0.5, 0, 1.683e-3, 1.423e7}, upper = {0.02, 0.004115, 0, INFINITY};
    rig k = begin();
    (void)state;
    constant(&k, "va", RA, 0);
    assert_int_equal(
        ns_circuit_source(k.c, "vp", NS_VOLTAGE, P, N, &(ns_signal){.kind = NS_DC, .u.dc = V}, NULL), NS_OK);
    constant(&k, "vt", T, -1);
    assert_int_equal(ns_circuit_switch(k.c, "s1", VC, GU, RA, T, &upper, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(k.c, "s2", VD, GL, T, RA, &upper, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(k.c, "s3", P, OUT, GU, 0, &weak, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(k.c, "s4", OUT, N, GL, 0, &weak, NULL), NS_OK);
    resistor(&k, "r", OUT, W, 0.05025);
    (void)inductor(&k, "l", W, O, 1.29e-3);
    resistor(&k, "ro", O, 0, 6.172);
    const ns_march_options o = {.h = 5.2e-8, .method = NS_SPARSE};
    make_by(&k, &o);
    start_at_rest(&k);
    go(&k, 1e-5);
    near(voltage(&k, P), V / 2, V);
    near(voltage(&k, OUT), 0, V);
    end(&k);
}

/* A dc link with a stray coil floats between four open switches, and two coils of 1 mH alone tie it to
 * ground: g / 1 mH in a step of 1e-15 s, beside 2e3 S and C / g inside.  The current of the stray coil ends
 * in the open switches, two in series, twice, and by symmetry the others' nodes stay at ground:
 *
 *     i = I e^(-t R / L),  v(P) = -v(N) = -R i / 2
 */
static void a_link_floats_behind_coils(void **state) {
    enum { X = 1, Y, P, E, W, N };
    const double C = 43.16e-6, L = 6.554e-8, I = 1e-3, R = 5e6, r = 5e-4, h = 2.6e-8;
    const ns_switch open = {0.5, 0, 0.1346, R};
    rig k = begin();
    (void)state;
    (void)inductor(&k, "l1", X, 0, 1e-3);
    (void)inductor(&k, "l2", Y, 0, 1e-3);
    assert_int_equal(ns_circuit_switch(k.c, "s1", P, X, 0, 0, &open, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(k.c, "s2", X, N, 0, 0, &open, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(k.c, "s3", P, Y, 0, 0, &open, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(k.c, "s4", Y, N, 0, 0, &open, NULL), NS_OK);
    resistor(&k, "r", P, E, r);
    assert_int_equal(ns_circuit_inductor(k.c, "l", E, W, L, I, NULL), NS_OK);
    capacitor(&k, "c", W, N, C, 0);
    ready(&k, h);
    for (int i = 1; i <= 4; i++) {
        const double t = i * L / R, v = -R / 2 * I * exp(-t * R / L);
        go(&k, t);
        const double rounding = R / r * DBL_EPSILON / close_enough; /* of v / r, beside i */
        near(voltage(&k, P), v, R * I * rounding);
        near(voltage(&k, N), -v, R * I * rounding);
        near(voltage(&k, X), 0, R * I * rounding);
    }
    end(&k);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_rigid_string_floats),
        cmocka_unit_test(a_bridge_at_rest_starts),
        cmocka_unit_test(a_link_floats_behind_coils),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
