/* tests/unit/sparse/test_mode_search.c - the mode after an event that the sparse engine has to search for. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "parts.h"

enum { SUPPLY = 1, A, B, GATE, SHUT, NEVER, COIL, S1, S2, Y, OUT };

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

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(choke_goes_on_behind_a_transformer)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
