/* tests/unit/exact/test_mode_entry.c - which mode a jump is taken in. */
#include "exact_bench.h"
#include "retries.h"

#include <float.h>

#include "exact/mode_selection.h"
#include "march/dense_internal.h"
#include "march/run_internal.h"

static void diode(bench *b, const char *name, int anode, int cathode) {
    const ns_diode d = {.vf = 0.699, .roff = 1.447e8, .vz = INFINITY};
    assert_int_equal(ns_circuit_diode(b->c, name, anode, cathode, &d, NULL), NS_OK);
}

static void resistor(bench *b, const char *name, int p, int n, double ohms) {
    assert_int_equal(ns_circuit_resistor(b->c, name, p, n, ohms, NULL), NS_OK);
}

static void capacitor(bench *b, const char *name, int p, int n, double farads) {
    assert_int_equal(ns_circuit_capacitor(b->c, name, p, n, farads, 0, NULL), NS_OK);
}

/* 2.74 V charge 73 pF through 7 uohm in 5e-16 s, far below h 2^-20, so that this is a jump.  For that time
 * node 2 is above vf, and two diodes lead from it: d1 to 0.34 uF in series with 10 uF, d2 to ground.  d2
 * holds node 2 at vf, so d1 has vf less what the capacitors have, and carries nothing; what then reaches them
 * through 52 kohm and 145 Mohm is below 2.8 V/52 kohm 1 ns / 0.3 uF = 2e-7 V.
 *
 * From circuit random-wide 15301000002 of the stress set: the jump was taken in the mode in which d1 conducts
 * and d2 does not, whose voltage breaks its law as soon as the jump begins: 5.8e-5 V stayed on 0.34 uF. */
static void a_jump_stops_where_another_diode_takes_over(void **state) {
    bench b = open_bench();
    (void)state;
    allow_retries(1);
    source(&b, "v2", 1, 2, dc(-2.74));
    resistor(&b, "r3", 1, 3, 3.019e-6);
    resistor(&b, "r4", 2, 0, 4.067e-6);
    resistor(&b, "r7", 4, 2, 5.224e4);
    resistor(&b, "r8", 5, 4, 1.461e5);
    capacitor(&b, "c9", 6, 5, 3.414e-7);
    capacitor(&b, "c10", 3, 7, 0.04578);
    capacitor(&b, "c11", 0, 5, 1.048e-5);
    assert_int_equal(ns_circuit_inductor(b.c, "l15", 4, 6, 2.578e-9, 0, NULL), NS_OK);
    capacitor(&b, "c16", 7, 0, 7.302e-11);
    diode(&b, "d1", 2, 6);
    diode(&b, "d2", 2, 0);
    start(&b, 0.01197 / 65536);
    for (double t = 0; t < 1e-9;) {
        t = go(&b, 1e-9, NS_TO_STEP);
        near(v_of(&b, 6) - v_of(&b, 5), 0, 2e-7);
    }
    close_bench(&b);
}

/* Two capacitors of 1 F from 0 V on: 1 A gives one of them t volts, a current that rises by 0.02 A/s the
 * other one t^2/100.  At 100 s both are at 100 V, and a diode begins to join them.  Its guard, a difference
 * whose rate is 1 V/s then, is off by 64 eps of its terms, 200 V and some units of what inputs add, and by
 * what it changes by in 4 eps of the time; the instant by as much, and by 4 eps of itself. */
static void how_well_an_instant_is_known(void **state) {
    static const double t[] = {0, 200}, amperes[] = {0, 4};
    const ns_diode ideal = {.roff = INFINITY, .vz = INFINITY};
    const ns_signal one = dc(1), rises = {.kind = NS_PWL, .u.pwl = {2, t, amperes, NAN, 0}};
    bench b = open_bench();
    (void)state;
    assert_int_equal(ns_circuit_source(b.c, "i1", NS_CURRENT, 0, 1, &one, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(b.c, "i2", NS_CURRENT, 0, 2, &rises, NULL), NS_OK);
    capacitor(&b, "c1", 1, 0, 1);
    capacitor(&b, "c2", 2, 0, 1);
    assert_int_equal(ns_circuit_diode(b.c, "d", 2, 1, &ideal, NULL), NS_OK);
    start(&b, 1e-3);
    (void)go(&b, 110, NS_TO_TIME);
    const ns_dense_run *r = (const ns_dense_run *)(void *)((ns_run *)(void *)b.m->engine)->at_work;
    near(r->exact->state.last_event_t, 100, 1e-11);
    near(r->exact->state.event_time_error / DBL_EPSILON, 64 * 200 + 4 * 100 + 4 * 100, 64 * 20);
    close_bench(&b);
}

/* Three switches that close one after the other, each for half a second: what followed the mode in which all
 * are open, the most recent one first. */
static void modes_that_followed(void **state) {
    static const char *const names[][2] = {{"v0", "s0"}, {"v1", "s1"}, {"v2", "s2"}};
    const ns_switch half = {0.5, 0, 0, INFINITY};
    bench b = open_bench();
    (void)state;
    source(&b, "v", 1, 0, dc(1));
    resistor(&b, "r", 2, 0, 1);
    for (int k = 0; k < 3; k++) {
        source(&b, names[k][0], 3 + k, 0, pulse(0, 1, k + 1, 0, 0, 0.5, 10));
        assert_int_equal(ns_circuit_switch(b.c, names[k][1], 1, 2, 3 + k, 0, &half, NULL), NS_OK);
    }
    start(&b, 0.1);
    (void)go(&b, 4, NS_TO_TIME);
    const ns_dense_run *r = (const ns_dense_run *)(void *)((ns_run *)(void *)b.m->engine)->at_work;
    const ns_successor *s = r->exact->state.mode->successor;
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < 3; j++)
            assert_int_equal(s[k].mode->mode[j], j == 2 - k ? NS_INSIDE : NS_LOWER);
    assert_null(s[3].mode);
    close_bench(&b);
}

/* 5 pF at 5 V discharge through a diode of 0.5 uohm at the start: 2.5e-18 s, which that instant tells apart.
 * 10 ms later the source has charged them to -800 V, and begins to charge them back.  The diode is not closed
 * there: that it would carry 1 uA at last, and -1.6e9 A no longer than the instant of an event is known to,
 * 1e-16 s, does not make it so. */
static void what_was_resolved_at_the_start(void **state) {
    static const double t[] = {0, 1e-6, 1.001e-6, 9.99e-3, 9.991e-3},
                        amperes[] = {0, 0, -0.41e-6, -0.41e-6, 1e-6};
    const ns_diode d = {.ron = 5e-7, .roff = INFINITY, .vz = INFINITY};
    const ns_signal charging = {.kind = NS_PWL, .u.pwl = {5, t, amperes, NAN, 0}};
    const ns_mode closed[] = {NS_INSIDE};
    ns_exact_mode *k;
    bench b = open_bench();
    (void)state;
    assert_int_equal(ns_circuit_source(b.c, "i", NS_CURRENT, 0, 1, &charging, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c", 1, 0, 5e-12, 5, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(b.c, "d", 1, 0, &d, NULL), NS_OK);
    start(&b, 1.2e-7);
    (void)go(&b, 1e-2, NS_TO_TIME);
    assert_true(v_of(&b, 1) < -800);
    ns_exact *f = ((const ns_dense_run *)(void *)((ns_run *)(void *)b.m->engine)->at_work)->exact;
    ns_exact_event_known_to(f, 1e-16);
    assert_int_equal(ns_exact_mode_find(f, closed, &k), NS_OK);
    assert_int_equal(ns_exact_mode_holds(f, k, NS_EVIDENCE_NONE, 0), NS_VERDICT_NO);
    close_bench(&b);
}

/* A switch that closes every 5.2 us with its 31 pF charged, two chokes and two coils, coupled by 0.999,
 * behind it, and diodes of 6 nohm, which discharge 6.4 pF in 4e-20 s.  No event is known to that: the rate
 * with which a mode of theirs breaks was taken for rounding, so that some came one event late; the check
 * finds that (retries). */
static void rates_that_begin_with_the_event(void **state) {
    enum { IN = 1, A, B, OUT, GATE, S1, S2 };
    const ns_switch q = {.vt = 0.152623, .roff = 9.30731e9};
    const ns_diode d = {.ron = 6.02336e-9, .roff = 4.46455e14, .vz = INFINITY};
    const ns_signal gate = {.kind = NS_PULSE,
                            .u.pulse = {0, 0.986715, 0, 2.58771e-8, 2.58771e-8, 7.79202e-7, 5.17072e-6, 0}};
    const struct {
        const char *name;
        int p, n;
        double henries;
    } coil[] = {{"l1", B, A, 1.42875e-3},
                {"l2", S1, S2, 3.22962e-3},
                {"l3", S2, OUT, 1.20714e-4},
                {"l4", S1, OUT, 1.35955e-3}};
    int id[4];
    bench b = open_bench();
    (void)state;
    source(&b, "in", IN, 0, dc(410.285));
    source(&b, "gate", GATE, 0, gate);
    assert_int_equal(ns_circuit_switch(b.c, "q", A, 0, GATE, 0, &q, NULL), NS_OK);
    capacitor(&b, "c1", IN, A, 3.0969e-11);
    capacitor(&b, "c2", A, 0, 3.0969e-11);
    capacitor(&b, "c3", IN, B, 3.0969e-11);
    capacitor(&b, "c4", S2, 0, 6.4343e-12);
    capacitor(&b, "c5", OUT, 0, 1.97818e-6);
    for (int k = 0; k < 4; k++)
        assert_int_equal(
            ns_circuit_inductor(b.c, coil[k].name, coil[k].p, coil[k].n, coil[k].henries, 0, &id[k]), NS_OK);
    assert_int_equal(ns_circuit_coupling(b.c, "k", id[0], id[1], 0.999235, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(b.c, "d1", 0, S1, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(b.c, "d2", 0, S2, &d, NULL), NS_OK);
    start(&b, 8.47835e-8);
    for (int k = 1; k <= 1500; k++)
        (void)go(&b, k * 8.47835e-8, NS_TO_TIME);
    assert_int_equal(ns_march_counts(b.m)->retries, 0);
    close_bench(&b);
}

/* A pump of four diodes of 1 nohm and 1 kohm: after each edge their currents of 0.5 A die out with 1e-18 s,
 * and one stops while the others have not. Where the mode after that left those out no mode was found, and
 * the theta scheme went on, with 60 pivots each time. */
static void a_transient_goes_on_in_the_next_mode(void **state) {
    enum { OUT = 5, RISES, FALLS };
    const ns_diode d = {.ron = 1e-9, .roff = 1e3, .vz = INFINITY};
    const ns_signal rises = {.kind = NS_PULSE, .u.pulse = {0, 5, 0, 1e-8, 1e-8, 4.9e-7, 1e-6, 0}},
                    falls = {.kind = NS_PULSE, .u.pulse = {5, 0, 0, 1e-8, 1e-8, 4.9e-7, 1e-6, 0}};
    const char *names[] = {"d1", "d2", "d3", "d4", "c1", "c2", "c3", "c4"};
    bench b = open_bench();
    (void)state;
    source(&b, "v", 1, 0, dc(5));
    source(&b, "rises", RISES, 0, rises);
    source(&b, "falls", FALLS, 0, falls);
    for (int k = 0; k < 4; k++) {
        assert_int_equal(ns_circuit_diode(b.c, names[k], k + 1, k + 2, &d, NULL), NS_OK);
        capacitor(&b, names[4 + k], k % 2 ? FALLS : RISES, k + 2, 1e-9);
    }
    assert_int_equal(ns_circuit_diode(b.c, "d5", OUT, FALLS + 1, &d, NULL), NS_OK);
    capacitor(&b, "out", FALLS + 1, 0, 1e-8);
    resistor(&b, "load", FALLS + 1, 0, 1e5);
    start(&b, 1e-6 / 1024);
    (void)go(&b, 5e-6, NS_TO_TIME);
    assert_true(ns_march_counts(b.m)->pivots < 20);
    close_bench(&b);
}

static void ideal_diode(bench *b, const char *name, int anode, int cathode) {
    const ns_diode d = {.roff = INFINITY, .vz = INFINITY};
    assert_int_equal(ns_circuit_diode(b->c, name, anode, cathode, &d, NULL), NS_OK);
}

static void leaky(bench *b, const char *name, int anode, int cathode) {
    const ns_diode d = {.roff = 1e12, .vz = INFINITY};
    assert_int_equal(ns_circuit_diode(b->c, name, anode, cathode, &d, NULL), NS_OK);
}

/* A flyback converter whose diodes leak.  As its switch opens, the leak of the secondary's diode, 30 pA
 * backwards, ends in L/roff = 3e-15 s, far below what counts as an instant, and then it conducts.  A command
 * is known to the last digit, so no mode was right in that instant: the theta scheme went on, with 4 pivots
 * each time.  Of the charge that the leaks take, 20 V/1e12 ohm 480 us, no voltage shows 1e-9 of 20 V. */
static void a_leak_is_over_in_the_instant_of_a_command(void **state) {
    enum { IN = 1, GATE, X, CLAMP, S, OUT };
    const ns_signal drive = {.kind = NS_PULSE, .u.pulse = {0, 1, 0, 3e-9, 3e-9, 8e-6, 24e-6, 0}};
    const ns_switch ideal = {.vt = 0.5, .roff = INFINITY};
    double volts[2];
    (void)state;
    for (int leaks = 0; leaks < 2; leaks++) {
        bench b = open_bench();
        int l1, l2;
        source(&b, "v", IN, 0, dc(15));
        source(&b, "vg", GATE, 0, drive);
        assert_int_equal(ns_circuit_inductor(b.c, "l1", IN, X, 0.6e-3, 0, &l1), NS_OK);
        assert_int_equal(ns_circuit_inductor(b.c, "l2", 0, S, 3e-3, 0, &l2), NS_OK);
        assert_int_equal(ns_circuit_coupling(b.c, "k", l1, l2, 0.9999, NULL), NS_OK);
        assert_int_equal(ns_circuit_switch(b.c, "s", X, 0, GATE, 0, &ideal, NULL), NS_OK);
        (leaks ? leaky : ideal_diode)(&b, "d1", X, CLAMP);
        (leaks ? leaky : ideal_diode)(&b, "d2", S, OUT);
        assert_int_equal(ns_circuit_capacitor(b.c, "c1", CLAMP, IN, 6e-6, 20, NULL), NS_OK);
        capacitor(&b, "c2", OUT, 0, 10e-6);
        resistor(&b, "r", OUT, 0, 20);
        start(&b, 480e-6 / 65536);
        (void)go(&b, 480e-6, NS_TO_TIME);
        assert_true(ns_march_counts(b.m)->pivots < 10);
        volts[leaks] = v_of(&b, OUT);
        close_bench(&b);
    }
    near(volts[1], volts[0], 1e-9 * 20);
}

/* Two thyristors, each a diode of 0.5 V and a switch of 1e15 ohm, between 10 V, 50 Hz and 10 mH with 50 ohm.
 * One is switched off at 9.75 ms, at 0.77 V, while it conducts 17 mA: 10 mH 17 mA = 2e-4 V s, which stand
 * across the other thyristor, drive 2e-19 A s through it, and then its diode blocks as the voltage turns. The
 * charge was taken for the rounding of that flux, so that the diode had carried nothing, and no mode was
 * right: the theta scheme went on, with 364 pivots. */
static void a_charge_is_no_rounding_of_a_flux(void **state) {
    enum { IN = 1, A, B, G1, G2, M1, M2 };
    const ns_switch s = {.vt = 0.5, .roff = 1e15};
    const ns_diode d = {.vf = 0.5, .roff = 1e15, .vz = INFINITY};
    const ns_signal sine = {.kind = NS_SIN, .u.sin = {.va = 10, .freq = 50}},
                    gate = {.kind = NS_PULSE, .u.pulse = {0, 1, 2e-3, 1e-6, 1e-6, 7.75e-3, 20e-3, 0}};
    bench b = open_bench();
    (void)state;
    source(&b, "v", IN, 0, sine);
    source(&b, "g1", G1, 0, gate);
    source(&b, "g2", G2, 0, dc(0));
    assert_int_equal(ns_circuit_diode(b.c, "d1", IN, M1, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(b.c, "s1", M1, A, G1, 0, &s, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(b.c, "d2", A, M2, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(b.c, "s2", M2, IN, G2, 0, &s, NULL), NS_OK);
    resistor(&b, "r", A, B, 50);
    assert_int_equal(ns_circuit_inductor(b.c, "l", B, 0, 10e-3, 0, NULL), NS_OK);
    start(&b, 12e-3 / 65536);
    (void)go(&b, 9.75e-3, NS_TO_TIME);
    assert_true(v_of(&b, A) - v_of(&b, B) > 50 * 15e-3);
    (void)go(&b, 12e-3, NS_TO_TIME);
    assert_true(fabs(v_of(&b, A) - v_of(&b, B)) < 50 * 2 * 10 / 1e15);
    assert_true(ns_march_counts(b.m)->pivots < 10);
    close_bench(&b);
}

static void gate(bench *b, const char *v, const char *r, int drive, int at, double ohms, ns_signal pulses) {
    source(b, v, drive, 0, pulses);
    resistor(b, r, drive, at, ohms);
}

/* Half of a phase-shifted bridge whose diodes and switches leak.  As a switch opens, the leak of a diode of
 * the secondary, 0.1 nA, ends in L/roff = 2e-16 s, too little for a jump, and then the diode conducts:
 * neither did the mode in which it blocks hold, nor that in which it conducts, for the 1e-14 s that 0.1 nA
 * take to reverse there.  The theta scheme went on, and two results were found wrong.  From psfb 77011000000
 * of the stress set, ron = 1 ohm and roff = 1e12 ohm. */
static void a_leak_ends_before_a_diode_conducts(void **state) {
    enum { IN = 1, A, B, D1, D2, GB, GC, P, S1, S2, Y, OUT, Q };
    const ns_switch s = {.vt = 8, .ron = 1, .roff = 1e12};
    const ns_diode d = {.vf = 0.851, .ron = 1, .roff = 1e12, .vz = INFINITY};
    const double per = 5.30222694e-06, edge = 1e-9;
    bench b = open_bench();
    int k[3];
    (void)state;
    assert_int_equal(ns_circuit_capacitor(b.c, "c", IN, 0, 3.003e-6, 585.7, NULL), NS_OK);
    gate(&b, "vb", "rb", D1, GB, 79.8, pulse(0, 15, 2.65111347e-6, edge, edge, 2.57190562e-6, per));
    gate(&b, "vc", "rc", D2, GC, 55, pulse(15, 0, 5.04506893e-7, edge, edge, 2.72832131e-6, per));
    assert_int_equal(ns_circuit_switch(b.c, "s1", A, 0, GB, 0, &s, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(b.c, "d1", 0, A, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(b.c, "s2", IN, B, GC, 0, &s, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(b.c, "l", A, P, 256e-6, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(b.c, "l1", P, B, 18.6981e-3, 0, &k[0]), NS_OK);
    assert_int_equal(ns_circuit_inductor(b.c, "l2", S1, 0, 202.628e-6, 0, &k[1]), NS_OK);
    assert_int_equal(ns_circuit_inductor(b.c, "l3", 0, S2, 202.628e-6, 0, &k[2]), NS_OK);
    assert_int_equal(ns_circuit_coupling(b.c, "k1", k[0], k[1], 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_coupling(b.c, "k2", k[0], k[2], 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_coupling(b.c, "k3", k[1], k[2], 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(b.c, "d2", S1, Y, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(b.c, "d3", S2, Y, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(b.c, "lo", Y, OUT, 180e-6, 0, NULL), NS_OK);
    resistor(&b, "r", OUT, Q, 27.58);
    assert_int_equal(ns_circuit_inductor(b.c, "lr", Q, 0, 3.989e-6, 0, NULL), NS_OK);
    start(&b, 1.78844e-4 / 65536);
    for (double t = 0; t < 1.78844e-4;)
        t = go(&b, 1.78844e-4, NS_TO_STEP);
    assert_int_equal(ns_march_counts(b.m)->retries, 0);
    assert_true(ns_march_counts(b.m)->pivots < 20);
    close_bench(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_jump_stops_where_another_diode_takes_over),
                                       cmocka_unit_test(how_well_an_instant_is_known),
                                       cmocka_unit_test(modes_that_followed),
                                       cmocka_unit_test(what_was_resolved_at_the_start),
                                       cmocka_unit_test(rates_that_begin_with_the_event),
                                       cmocka_unit_test(a_transient_goes_on_in_the_next_mode),
                                       cmocka_unit_test(a_leak_is_over_in_the_instant_of_a_command),
                                       cmocka_unit_test(a_charge_is_no_rounding_of_a_flux),
                                       cmocka_unit_test(a_leak_ends_before_a_diode_conducts)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
