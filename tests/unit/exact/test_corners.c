/* tests/unit/exact/test_corners.c - pairs that leave their corners, beside resistances and leaks that delay
 * them by less than an instant: no problem is solved for them. */
#include "exact_bench.h"

static const double period = 1e-4, volts = 10;
enum { PERIODS = 20 };

static ns_signal sine(void) {
    return (ns_signal){.kind = NS_SIN, .u.sin = {0, volts, 1 / period, 0, 0, 0}};
}

static void diode(bench *b, const char *name, int anode, int cathode, double ron, double roff) {
    const ns_diode d = {.ron = ron, .roff = roff, .vz = INFINITY};
    assert_int_equal(ns_circuit_diode(b->c, name, anode, cathode, &d, NULL), NS_OK);
}

static void capacitor_between(bench *b, const char *name, int p, int n, double farads) {
    assert_int_equal(ns_circuit_capacitor(b->c, name, p, n, farads, 0, NULL), NS_OK);
}

/* All events but few were proved right without a problem. */
static void proved(const bench *b, long least_events, long most_problems) {
    const ns_counts *n = ns_march_counts(b->m);
    if (n->problems > most_problems)
        print_message("%ld problems for %ld events\n", n->problems, n->events);
    assert_true(n->events >= least_events && n->problems <= most_problems);
}

/* 40 pF that are charged through 1e-3 ohm in 4e-14 s: steps right after an event are as short. */
static void fast_part(bench *b) {
    assert_int_equal(ns_circuit_resistor(b->c, "rf", 1, 9, 1e-3, NULL), NS_OK);
    capacitor_between(b, "cf", 9, 0, 4e-11);
}

/* 10 V of 10 kHz drive a coil of 0.1 mH, a diode and 10 ohm: from where the sine rises,
 *     i = V/Z (sin(w t - phi) + sin(phi) exp(-R t/L)),  phi = atan(w L/R),  Z^2 = R^2 + (w L)^2.
 * The diode opens with no current, and its leak of 1e12 ohm takes up 1e-11 A in 0.1 mH/1e12 ohm = 1e-16 s,
 * which is an instant.
 *
 * As in circuit tapped-buck 98001000000 of the stress set (ron=1e-3, roff=1e12): the coil's voltage in that
 * time was an impulse that its sign forbids, and each such event solved (P1) and the impulse problem. */
static void a_leak_takes_up_its_current(void **state) {
    const double w = 2 * pi / period, t = period / 3;
    const double phi = atan(w * 1e-4 / 10), z = hypot(10, w * 1e-4);
    int id;
    bench b = open_bench();
    (void)state;
    source(&b, "v", 1, 0, sine());
    assert_int_equal(ns_circuit_inductor(b.c, "l", 1, 2, 1e-4, 0, &id), NS_OK);
    diode(&b, "d", 2, 3, 0, 1e12);
    fast_part(&b);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 3, 0, 10, NULL), NS_OK);
    start(&b, period / 1024);
    (void)go(&b, PERIODS * period + t, NS_TO_TIME);
    near(i_of(&b, id), volts / z * (sin(w * t - phi) + sin(phi) * exp(-10 * t / 1e-4)), 1e-9);
    proved(&b, 2 * PERIODS, 2);
    close_bench(&b);
}

/* The same sine, a coil of 10 mH and 1 kohm charge 10 pF, beside which a diode of 1e-6 ohm conducts in the
 * other half wave: it begins at 0 V, and its current is that of the coil after 1e-6 ohm 10 pF = 1e-17 s. */
static void a_resistance_takes_its_drop(void **state) {
    bench b = open_bench();
    (void)state;
    source(&b, "v", 1, 0, sine());
    assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 2, 1e3, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(b.c, "l", 2, 3, 1e-2, 0, NULL), NS_OK);
    capacitor_between(&b, "c", 3, 0, 1e-11);
    diode(&b, "d", 0, 3, 1e-6, INFINITY);
    fast_part(&b);
    start(&b, period / 1024);
    (void)go(&b, PERIODS * period, NS_TO_TIME);
    proved(&b, 2 * PERIODS - 2, 2);
    close_bench(&b);
}

/* One leg: switches of 1e-6 ohm from the supply (node 1) to its output, and from there to ground, each with a
 * diode of 1e-6 ohm against it. */
static void leg(bench *b, const char *const name[4], int output, int upper, int lower) {
    const ns_switch contact = {0.5, 0, 1e-6, INFINITY};
    assert_int_equal(ns_circuit_switch(b->c, name[0], 1, output, upper, 0, &contact, NULL), NS_OK);
    diode(b, name[1], output, 1, 1e-6, INFINITY);
    assert_int_equal(ns_circuit_switch(b->c, name[2], output, 0, lower, 0, &contact, NULL), NS_OK);
    diode(b, name[3], 0, output, 1e-6, INFINITY);
}

/* A bridge of 500 V drives 7 uH, 1 uF and 0.2 ohm, which ring four times in each half of the period.  Where
 * the current turns, two closed switches of 1e-6 ohm have no voltage: the diode beside each begins to
 * conduct, one 1e-15 s before the other, as a snubber takes some 1e-7 A; 1e-13 V are far below the rounding
 * of 500 V.
 *
 * As in circuit dab 98001000000 of the stress set (ron=1e-6): after the first of the two the other one's
 * voltage seemed to break, and with both its current was below zero, so that the ladder had to go on. */
static void two_diodes_take_one_current(void **state) {
    static const char *const a[4] = {"s1", "d1", "s2", "d2"}, *const c[4] = {"s3", "d3", "s4", "d4"};
    const ns_signal one = pulse(0, 1, 0, 1e-9, 1e-9, 0.49 * period, period),
                    other = pulse(0, 1, 0.5 * period, 1e-9, 1e-9, 0.49 * period, period);
    bench b = open_bench();
    (void)state;
    source(&b, "v", 1, 0, dc(500));
    source(&b, "g1", 2, 0, one);
    source(&b, "g2", 3, 0, other);
    leg(&b, a, 4, 2, 3);
    leg(&b, c, 5, 3, 2);
    assert_int_equal(ns_circuit_inductor(b.c, "l", 4, 6, 7e-6, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 6, 8, 0.2, NULL), NS_OK);
    capacitor_between(&b, "c", 8, 5, 1e-6);
    assert_int_equal(ns_circuit_resistor(b.c, "r1", 1, 7, 26, NULL), NS_OK);
    capacitor_between(&b, "c1", 7, 5, 1.3e-9);
    start(&b, period / 65536);
    (void)go(&b, PERIODS * period, NS_TO_TIME);
    proved(&b, 4 * PERIODS, 2);
    close_bench(&b);
}

/* A pump of so many stages, whose clocks move by 5 V in 10 ns, for PERIODS of 1 us. */
static void pump(bench *b, int stages, double ron, double roff) {
    static const char *const c[] = {"c1", "c2", "c3", "c4", "c5", "c6", "c7", "c8"};
    static const char *const d[] = {"d1", "d2", "d3", "d4", "d5", "d6", "d7", "d8"};
    source(b, "v", 1, 0, dc(5));
    source(b, "a", 2, 0, pulse(0, 5, 0, 1e-8, 1e-8, 4.9e-7, 1e-6));
    source(b, "b", 3, 0, pulse(5, 0, 0, 1e-8, 1e-8, 4.9e-7, 1e-6));
    for (int k = 0; k < stages; k++) {
        diode(b, d[k], k == 0 ? 1 : 3 + k, 4 + k, ron, roff);
        capacitor_between(b, c[k], k % 2 ? 3 : 2, 4 + k, 1e-9);
    }
    diode(b, "d", 3 + stages, 4 + stages, ron, roff);
    capacitor_between(b, "co", 4 + stages, 0, 1e-8);
    assert_int_equal(ns_circuit_resistor(b->c, "ro", 4 + stages, 0, 1e5, NULL), NS_OK);
    start(b, 1e-6 / 1024);
    (void)go(b, PERIODS * 1e-6, NS_TO_TIME);
}

/* Where a clock stops, what the diodes carried, 0.5 A, has to leave 1e-9 ohm: by an impulse, in 1e-18 s; they
 * open after it, or are left with no current and no rate.  All that is known without a problem: of a pair
 * that carried an impulse nothing else need be asked. */
static void a_clock_stops(void **state) {
    bench b = open_bench();
    (void)state;
    pump(&b, 4, 1e-9, INFINITY);
    proved(&b, 4 * PERIODS, 12); /* most from rest */
    close_bench(&b);
}

/* The same with a leak of 1e6 ohm: an impulse of 1e-19 C is far less than what the leak carries in any step.
 */
static void a_clock_stops_beside_a_leak(void **state) {
    bench b = open_bench();
    (void)state;
    pump(&b, 4, 1e-9, 1e6);
    proved(&b, 4 * PERIODS, 12);
    close_bench(&b);
}

/* With no resistance capacitors are joined through diodes for half a period, and rounding parts their
 * voltages by some 1e-12 V.  Where the diode between them opens, that was a voltage of the wrong sign.  With
 * a leak of 1e6 ohm no mode passed: the ladder went on after each clock. */
static void capacitors_that_were_joined(void **state) {
    bench b = open_bench();
    (void)state;
    pump(&b, 8, 0, 1e6);
    proved(&b, 4 * PERIODS, 6);
    close_bench(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_leak_takes_up_its_current), cmocka_unit_test(a_resistance_takes_its_drop),
        cmocka_unit_test(two_diodes_take_one_current), cmocka_unit_test(a_clock_stops),
        cmocka_unit_test(a_clock_stops_beside_a_leak), cmocka_unit_test(capacitors_that_were_joined)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
