/* tests/unit/sparse/test_mode_search.c - the mode after an event that the sparse engine has to search for. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "parts.h"

enum { SUPPLY = 1, A, B, GATE, SHUT, NEVER, COIL, S1, S2, Y, OUT };

static void coil(rig *k, const char *name, int p, int n, double l, double i) {
    assert_int_equal(ns_circuit_inductor(k->c, name, p, n, l, i, NULL), NS_OK);
}

static void leg(rig *k, int middle, int upper, int lower, const char *const *name) {
    contact(k, name[0], SUPPLY, middle, upper, 0.5, 0);
    diode(k, name[1], middle, SUPPLY);
    contact(k, name[2], middle, 0, lower, 0.5, 0);
    diode(k, name[3], 0, middle);
}

/* A full bridge whose upper switch opens while the lower one of the other leg is closed, a transformer
 * without leakage, a bridge rectifier and a choke: its 20 mA go on through the diodes.  Rounds that change
 * all broken pairs at once come round in a circle here, and (P1), from a mode that leaks hold at 1e9 V, has
 * no digit left: the choke's current was gone. */
static void choke_goes_on_behind_a_transformer(void **state) {
    static const char *const left[] = {"s1", "d1", "s2", "d2"}, *const right[] = {"s3", "d3", "s4", "d4"};
    const double millihenry = 1e-3;
    rig k = {0};
    int primary, secondary, choke;
    (void)state;
    assert_int_equal(ns_circuit_create(&k.c), NS_OK);
    constant(&k, "v", SUPPLY, 74);
    gate(&k, "g", GATE, 1e-6, 1);
    constant(&k, "shut", SHUT, 1);
    constant(&k, "never", NEVER, 0);
    leg(&k, A, GATE, NEVER, left);
    leg(&k, B, NEVER, SHUT, right);
    capacitor(&k, "c1", A, COIL, 1.8e-6, 0);
    primary = inductor(&k, "l1", COIL, B, 23 * millihenry);
    secondary = inductor(&k, "l2", S1, S2, 56 * millihenry);
    assert_int_equal(ns_circuit_coupling(k.c, "k", primary, secondary, 1, NULL), NS_OK);
    diode(&k, "d5", S1, Y);
    diode(&k, "d6", S2, Y);
    diode(&k, "d7", 0, S1);
    diode(&k, "d8", 0, S2);
    choke = inductor(&k, "l3", Y, OUT, 4.3 * millihenry);
    capacitor(&k, "c2", OUT, 0, 106e-9, 30);
    resistor(&k, "r", OUT, 0, 347);
    ready(&k, 1e-9);
    const int i = ns_circuit_current_unknown(k.c, choke);
    go(&k, 0.999e-6);
    const double before = k.x[i];
    go(&k, 1.001e-6);
    assert_true(before > 10e-3);
    assert_true(fabs(k.x[i] - before) <
                30 * 2e-9 / (4.3 * millihenry) + 1e-4 * before); /* v dt / L, and a little */
    assert_int_equal(ns_march_counts(k.m)->retries, 0);
    end(&k);
}

/* A bus that no conductor holds: coils alone lead to it from outside, one through 9 pF, two through the load,
 * whose star has 4.7 Mohm to ground.  In steps of 4 fs, which are to resolve what is left of an event, the
 * conductance g/L of a coil is 1e-17 of C/g: (P2) had no digit of it and was taken for that of a part that
 * floats, and leaks made diodes conduct that block.  The check found it, and no engine went on. */
static void coils_hold_a_bus(void **state) {
    enum { BUS = 1, N, LINE, FED, IN, X1, X2, X3, C1, C2, STAR };
    static const ns_diode with_ron = {.ron = 0.0003104, .roff = INFINITY, .vz = INFINITY};
    static const int diodes[][2] = {{0, BUS}, {N, 0}, {X1, BUS}, {N, X1}, {X2, BUS}, {N, X2}};
    const ns_march_options o = {.h = 2.452e-7, .method = NS_SPARSE};
    ns_signal s = {.kind = NS_SIN};
    rig k = begin();
    (void)state;
    s.u.sin.va = 168.9;
    s.u.sin.freq = 46.99;
    source(&k, "v", LINE, &s);
    resistor(&k, "r1", LINE, FED, 0.1394);
    coil(&k, "l1", FED, IN, 0.008534, -6.93211771015603e-06);
    capacitor(&k, "c1", IN, BUS, 9.434e-12, -286.769202631744);
    capacitor(&k, "c2", BUS, N, 0.0001751, 287.02);
    for (int i = 0; i < 6; i++) {
        const char name[] = {'d', (char)('1' + i), 0};
        assert_int_equal(ns_circuit_diode(k.c, name, diodes[i][0], diodes[i][1], &with_ron, NULL), NS_OK);
    }
    capacitor(&k, "c3", X1, N, 7.359e-11, 286.764);
    capacitor(&k, "c4", X3, N, 7.359e-11, 0.003);
    capacitor(&k, "c5", X2, N, 7.359e-11, 0.001859);
    resistor(&k, "r2", X1, C1, 0.02816);
    coil(&k, "l2", C1, C2, 0.04775, 1.9033895930754);
    resistor(&k, "r3", C2, STAR, 39.52);
    coil(&k, "l3", X3, STAR, 0.01808, -1.17975966269861);
    resistor(&k, "r4", STAR, 0, 4.683e+06);
    make_by(&k, &o);
    start_at_rest(&k);
    for (int i = 1; i <= 30; i++)
        assert_int_equal(go_on(&k, i * 3.3e-5), NS_OK);
    end(&k); /* it fails where the check found an answer wrong */
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(choke_goes_on_behind_a_transformer),
                                       cmocka_unit_test(coils_hold_a_bus)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
