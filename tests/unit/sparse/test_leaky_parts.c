/* tests/unit/sparse/test_leaky_parts.c - the far side of a transformer that only large resistors join to the
 * rest: its voltage as a whole is what they make it, whatever flows in it, in steps of any length. */
#include <math.h>
#include <stdio.h>

#include "rig.h"
#include "sparse/factor_cache.h"

enum { IN = 1, A, B, PLUS, MINUS, GATE, SUPPLY, LEG, OUT };
static const double last = 2e-4, supply = 10;

static void ok(int status) {
    assert_int_equal(status, NS_OK);
}

static void add_diode(ns_circuit *c, const char *name, int anode, int cathode) {
    const ns_diode d = {.vf = 0.7, .ron = 5e-3, .roff = 1e8, .vz = INFINITY};
    ok(ns_circuit_diode(c, name, anode, cathode, &d, NULL));
}

/* 48 V, chopped, a transformer with a ring of its leakage and 200 pF, a bridge of diodes, 60 A. */
static void add_converter(ns_circuit *c) {
    const ns_signal volts = {.kind = NS_DC, .u.dc = 48},
                    gate = {.kind = NS_PULSE,
                            .u.pulse = {.v2 = 5, .tr = 1e-8, .tf = 1e-8, .pw = 4.5e-6, .per = 1e-5}};
    const ns_switch s = {.vt = 2.5, .ron = 5e-3, .roff = 1e8};
    int l[2];
    ok(ns_circuit_source(c, "v", NS_VOLTAGE, SUPPLY, 0, &volts, NULL));
    ok(ns_circuit_source(c, "g", NS_VOLTAGE, GATE, 0, &gate, NULL));
    ok(ns_circuit_switch(c, "s", SUPPLY, LEG, GATE, 0, &s, NULL));
    add_diode(c, "df", 0, LEG);
    ok(ns_circuit_capacitor(c, "c0", LEG, 0, 200e-12, NAN, NULL));
    ok(ns_circuit_inductor(c, "lk", LEG, IN, 1e-7, 0, NULL));
    ok(ns_circuit_inductor(c, "lp", IN, 0, 5e-4, 0, &l[0]));
    ok(ns_circuit_inductor(c, "ls", A, B, 2e-5, 0, &l[1]));
    ok(ns_circuit_coupling(c, "k", l[0], l[1], 0.999, NULL));
    add_diode(c, "d0", A, PLUS);
    add_diode(c, "d1", B, PLUS);
    add_diode(c, "d2", MINUS, A);
    add_diode(c, "d3", MINUS, B);
    ok(ns_circuit_capacitor(c, "ca", A, MINUS, 1e-9, 0, NULL));
    ok(ns_circuit_capacitor(c, "cb", B, MINUS, 1e-9, 0, NULL));
    ok(ns_circuit_inductor(c, "lo", PLUS, OUT, 5e-6, 0, NULL));
    ok(ns_circuit_capacitor(c, "co", OUT, MINUS, 1e-4, 0, NULL));
    ok(ns_circuit_resistor(c, "ro", OUT, MINUS, 0.1, NULL));
}

/* The largest distance of a node from `expected`, at all points. */
static double farthest_of(ns_circuit *c, int node, double expected) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-7, .method = NS_SPARSE, .whole = 1};
    rig k = {.c = c};
    double t = 0, most = 0;
    make_by(&k, &o);
    start_at_rest(&k);
    while (t < last) {
        ok(ns_march_try(k.m, last, NS_TO_STEP, &t));
        ok(ns_march_accept(k.m));
        ok(ns_march_read(k.m, NULL, k.x, NULL, NULL));
        most = fmax(most, fabs(k.x[ns_circuit_node_unknown(k.c, node)] - expected));
    }
    assert_true(ns_march_counts(k.m)->events > 40);
    assert_int_equal(ns_march_engine(k.m), NS_SPARSE);
    end(&k);
    return most;
}

/* Of the far side's reference. */
static double farthest(ns_circuit *c, double expected) {
    return farthest_of(c, MINUS, expected);
}

/* No current leads to the far side: it is at 0 V.  It was at up to 0.7 V with 1 Gohm, at 8 kV with 1 Tohm. */
static void one_leak(void **state) {
    (void)state;
    for (int decade = 4; decade < 14; decade += 2) {
        ns_circuit *c = begin().c;
        add_converter(c);
        ok(ns_circuit_resistor(c, "riso", MINUS, 0, pow(10, decade), NULL));
        assert_true(farthest(c, 0) < 1e-9);
    }
}

/* The same where an open switch leaks.  It was at 0.1 V with 10 Gohm, at 19 V with 100 Tohm. */
static void one_leak_of_a_device(void **state) {
    (void)state;
    for (int decade = 10; decade < 16; decade += 2) {
        const ns_switch s = {.vt = 10, .roff = pow(10, decade)};
        ns_circuit *c = begin().c;
        add_converter(c);
        ok(ns_circuit_switch(c, "iso", MINUS, 0, GATE, 0, &s, NULL));
        assert_true(farthest(c, 0) < 1e-9);
    }
}

/* A bridge of diodes on a source, with a capacitor and a load.  While all four block, leaks that are alike
 * hold the far side: currents into it add up to zero where v(PLUS) + v(MINUS) = v(A) + 0.  Returns how far
 * from that it ever is; *blocked: at so many points. */
static double off_balance(double roff, int *blocked) {
    const ns_signal volts = {.kind = NS_SIN, .u.sin = {.va = 68, .freq = 50}};
    const ns_diode d = {.vf = 0.7, .ron = 1e-3, .roff = roff, .vz = INFINITY};
    static const int ends[][2] = {{A, PLUS}, {0, PLUS}, {MINUS, A}, {MINUS, 0}};
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 2e-5, .method = NS_SPARSE, .whole = 1};
    const double stop = 0.04;
    rig k = begin();
    double t = 0, most = 0;
    ok(ns_circuit_source(k.c, "v", NS_VOLTAGE, IN, 0, &volts, NULL));
    ok(ns_circuit_inductor(k.c, "l", IN, A, 2e-5, 0, NULL));
    for (int i = 0; i < 4; i++)
        ok(ns_circuit_diode(k.c, (const char *[]){"d0", "d1", "d2", "d3"}[i], ends[i][0], ends[i][1], &d,
                            NULL));
    ok(ns_circuit_capacitor(k.c, "c", PLUS, MINUS, 0.02, 0, NULL));
    ok(ns_circuit_resistor(k.c, "r", PLUS, MINUS, 0.8, NULL));
    make_by(&k, &o);
    start_at_rest(&k);
    while (t < stop) {
        ok(ns_march_try(k.m, stop, NS_TO_STEP, &t));
        ok(ns_march_accept(k.m));
        ok(ns_march_read(k.m, NULL, k.x, NULL, NULL));
        const ns_mode *mode = ns_march_mode(k.m);
        const double at[] = {k.x[ns_circuit_node_unknown(k.c, A)], k.x[ns_circuit_node_unknown(k.c, PLUS)],
                             k.x[ns_circuit_node_unknown(k.c, MINUS)]};
        int open = 1;
        for (int i = 0; i < 4; i++)
            open &= mode[i] != NS_INSIDE;
        *blocked += open;
        most = open ? fmax(most, fabs(at[1] + at[2] - at[0])) : most;
    }
    assert_int_equal(ns_march_engine(k.m), NS_SPARSE);
    end(&k);
    return most;
}

/* It was 33 V off with 10 Tohm, and 58 V with 1000 Tohm, at few points or none at which all blocked: a diode
 * conducted on, as its current was taken for rounding of 60 A. */
static void blocked_bridge(void **state) {
    (void)state;
    for (int decade = 11; decade < 16; decade += 2) {
        int blocked = 0;
        assert_true(off_balance(pow(10, decade), &blocked) < 1e-9);
        assert_true(blocked > 100);
    }
}

/* A Cuk converter whose far side hangs on its source by 1 Gohm: each of its rows is in several rows of T. Its
 * reference is at 12 V; it was at 12.02 V after a switch had cut off a coil, a spike of 14 MV. */
static void a_far_side_between_coils(void **state) {
    enum { CUK_IN = 1, X, G, P, Q, REFERENCE, Y, CUK_OUT };
    const ns_signal volts = {.kind = NS_DC, .u.dc = 12},
                    gate = {.kind = NS_PULSE,
                            .u.pulse = {.v2 = 1, .tr = 4e-9, .tf = 4e-9, .pw = 1.94e-6, .per = 4e-6}};
    const ns_switch s = {.vt = 0.5, .ron = 1e-3, .roff = 1e6};
    const ns_diode d = {.ron = 2e-3, .roff = 1e6, .vz = INFINITY};
    ns_circuit *c = begin().c;
    int l[2];
    (void)state;
    ok(ns_circuit_source(c, "v", NS_VOLTAGE, CUK_IN, 0, &volts, NULL));
    ok(ns_circuit_inductor(c, "l2", CUK_IN, X, 6.07e-6, NAN, NULL));
    ok(ns_circuit_source(c, "g", NS_VOLTAGE, G, 0, &gate, NULL));
    ok(ns_circuit_switch(c, "s5", X, 0, G, 0, &s, NULL));
    ok(ns_circuit_diode(c, "d6", 0, X, &d, NULL));
    ok(ns_circuit_capacitor(c, "c7", X, P, 7.414e-5, 6, NULL));
    ok(ns_circuit_inductor(c, "l8", P, 0, 6.07e-5, NAN, &l[0]));
    ok(ns_circuit_inductor(c, "l9", Q, REFERENCE, 1.4625e-5, NAN, &l[1]));
    ok(ns_circuit_coupling(c, "k10", l[0], l[1], 0.999, NULL));
    ok(ns_circuit_capacitor(c, "c11", Q, Y, 7.414e-5, NAN, NULL));
    ok(ns_circuit_diode(c, "d12", Y, REFERENCE, &d, NULL));
    ok(ns_circuit_inductor(c, "l13", CUK_OUT, Y, 6.07e-6, NAN, NULL));
    ok(ns_circuit_capacitor(c, "c14", CUK_OUT, REFERENCE, 7.414e-5, NAN, NULL));
    ok(ns_circuit_resistor(c, "r15", CUK_OUT, REFERENCE, 2.677, NULL));
    ok(ns_circuit_resistor(c, "r16", REFERENCE, CUK_IN, 1e9, NULL));
    assert_true(farthest_of(c, REFERENCE, 12) < 1e-9);
}

/* Two leaks from one node divide the voltage of a source: 10 V * 2/3. */
static void a_divider_of_leaks(void **state) {
    const ns_signal volts = {.kind = NS_DC, .u.dc = supply};
    (void)state;
    ns_circuit *c = begin().c;
    add_converter(c);
    ok(ns_circuit_source(c, "v2", NS_VOLTAGE, 100, 0, &volts, NULL));
    ok(ns_circuit_resistor(c, "r1", MINUS, 100, 1e9, NULL));
    ok(ns_circuit_resistor(c, "r2", MINUS, 0, 2e9, NULL));
    assert_true(farthest(c, supply * 2 / 3) < 1e-6);
}

/* The part hangs on another one, of a capacitor alone, by a leak. */
static void parts_in_a_row(void **state) {
    (void)state;
    ns_circuit *c = begin().c;
    add_converter(c);
    ok(ns_circuit_resistor(c, "r1", MINUS, 100, 1e9, NULL));
    ok(ns_circuit_capacitor(c, "c9", 100, 101, 1e-6, 0, NULL));
    ok(ns_circuit_resistor(c, "r2", 101, 0, 1e10, NULL));
    assert_true(farthest(c, 0) < 1e-9);
}

/* The part of nodes 1 to 3 hangs by 2.2 kohm on one of capacitors, which a coil joins to ground: that nothing
 * but the coil leads out of both stands in a row of its own too (summed_parts.c).  Both in one place each,
 * the rows are regular. */
static void beside_a_sum_of_more(void **state) {
    static const double ohms[] = {1, 1e4, 2.2e3, 4.6e3};
    static const int from[] = {1, 2, 1, 4}, to[] = {2, 3, 4, 5};
    ns_form *f;
    ns_mode_factors *q;
    rig k = begin();
    (void)state;
    for (int i = 0; i < 4; i++)
        ok(ns_circuit_resistor(k.c, (const char *[]){"r0", "r1", "r2", "r3"}[i], from[i], to[i], ohms[i],
                               NULL));
    ok(ns_circuit_resistor(k.c, "r4", 3, 1, 1, NULL));
    ok(ns_circuit_capacitor(k.c, "c", 4, 5, 4e-3, 0, NULL));
    ok(ns_circuit_inductor(k.c, "l", 5, 0, 1e-7, 0, NULL));
    ok(ns_circuit_system(k.c, &k.s));
    ok(ns_sparse_form_create(k.s, 0, &f));
    ok(ns_sparse_factors_create(f, 1 << 20, &q));
    ns_sparse_factors_free(q);
    ns_sparse_form_free(f);
    end(&k);
}

/* Two legs and a source drive three coupled coils; 1 Gohm from the lower rail to ground. */
static void add_inverter(ns_circuit *c) {
    const ns_signal volts[] = {{.kind = NS_SIN, .u.sin = {.va = 75, .freq = 500, .phase = -120}},
                               {.kind = NS_SIN, .u.sin = {.va = 75, .freq = 500, .phase = -240}}};
    const ns_diode d = {.ron = 1e-6, .roff = 1e9, .vz = INFINITY};
    static const char *const name[] = {"l0", "l1", "l2", "k0", "k1", "k2"};
    enum { TOP = 20, LEG0, LEG1, BEHIND, SOURCE, EMF, STAR };
    static const int end[] = {LEG0, SOURCE, EMF};
    int l[3];
    ok(ns_circuit_resistor(c, "r", MINUS, 0, 1e9, NULL));
    ok(ns_circuit_diode(c, "d0", LEG0, TOP, &d, NULL));
    ok(ns_circuit_diode(c, "d1", MINUS, LEG0, &d, NULL));
    ok(ns_circuit_diode(c, "d2", LEG1, TOP, &d, NULL));
    ok(ns_circuit_resistor(c, "r0", TOP, LEG0, 1e9, NULL));
    ok(ns_circuit_resistor(c, "r1", LEG0, MINUS, 1e9, NULL));
    ok(ns_circuit_resistor(c, "r2", LEG1, BEHIND, 2.3, NULL));
    ok(ns_circuit_source(c, "v0", NS_VOLTAGE, MINUS, SOURCE, &volts[0], NULL));
    ok(ns_circuit_source(c, "v1", NS_VOLTAGE, BEHIND, EMF, &volts[1], NULL));
    for (int i = 0; i < 3; i++)
        ok(ns_circuit_inductor(c, name[i], end[i], STAR, 3.6e-3, NAN, &l[i]));
    for (int i = 0; i < 3; i++)
        ok(ns_circuit_coupling(c, name[3 + i], l[i], l[(i + 1) % 3], 0.9, NULL));
}

/* Their currents are 1e-7 A and pass in 1e-12 s.  With the sum in the place of the row of another node than
 * the one that the leak holds digits were lost, and steps did not get longer than that. */
static void coils_behind_open_devices(void **state) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = NS_SPARSE, .whole = 1};
    rig k = begin();
    double t = 0;
    (void)state;
    add_inverter(k.c);
    make_by(&k, &o);
    start_at_rest(&k);
    while (t < 1e-3) {
        ok(ns_march_try(k.m, 1e-3, NS_TO_STEP, &t));
        ok(ns_march_accept(k.m));
        ok(ns_march_read(k.m, NULL, k.x, NULL, NULL));
        assert_true(fabs(k.x[ns_circuit_node_unknown(k.c, MINUS)]) < 1e-9);
    }
    assert_int_equal(ns_march_engine(k.m), NS_SPARSE);
    assert_true(ns_march_counts(k.m)->steps < 5000);
    end(&k);
}

/* Three phases of 120 V, coupled coils, a bridge of diodes, a coil, a capacitor and a resistor; `ohms` from
 * the star point to ground. */
static void add_rectifier(ns_circuit *c, double ohms) {
    static const char *const name[] = {"0", "1", "2", "3", "4", "5"};
    enum { STAR = 10, PHASE = 20, COIL = 30, TOP = 40, BOTTOM, END };
    const ns_diode d = {.ron = 1e-3, .roff = 1e9, .vz = INFINITY};
    int l[3];
    for (int i = 0; i < 3; i++) {
        const ns_signal volts = {.kind = NS_SIN, .u.sin = {.va = 120, .freq = 400, .phase = -120. * i}};
        ok(ns_circuit_source(c, name[i], NS_VOLTAGE, PHASE + i, STAR, &volts, NULL));
        ok(ns_circuit_inductor(c, name[3 + i], PHASE + i, COIL + i, (6.5 - 0.3 * i) * 1e-4, NAN, &l[i]));
    }
    for (int i = 0; i < 3; i++) {
        char of[3][8];
        snprintf(of[0], sizeof *of, "k%d", i);
        snprintf(of[1], sizeof *of, "u%d", i);
        snprintf(of[2], sizeof *of, "d%d", i);
        ok(ns_circuit_coupling(c, of[0], l[i], l[(i + 1) % 3], 0.3, NULL));
        ok(ns_circuit_diode(c, of[1], COIL + i, TOP, &d, NULL));
        ok(ns_circuit_diode(c, of[2], BOTTOM, COIL + i, &d, NULL));
    }
    ok(ns_circuit_inductor(c, "l", TOP, END, 3.5e-3, NAN, NULL));
    ok(ns_circuit_capacitor(c, "c", END, BOTTOM, 45e-6, NAN, NULL));
    ok(ns_circuit_resistor(c, "r", END, BOTTOM, 7.6, NULL));
    ok(ns_circuit_resistor(c, "g", STAR, 0, ohms, NULL));
}

/* roff ends currents of coils in 1e-12 s.  Digits that one step lost were a transient of that length for the
 * next one: 1e5 steps a microsecond, until the run was refused. */
static void lost_digits_are_no_transient(void **state) {
    (void)state;
    for (int step = 0; step < 3; step++) {
        const double ohms = 900 * pow(1000, step);
        const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = NS_SPARSE, .whole = 1};
        rig k = begin();
        add_rectifier(k.c, ohms);
        make_by(&k, &o);
        start_at_rest(&k);
        go(&k, 1e-3);
        assert_int_equal(ns_march_engine(k.m), NS_SPARSE);
        assert_true(ns_march_counts(k.m)->steps < 3000);
        end(&k);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(one_leak),
                                       cmocka_unit_test(one_leak_of_a_device),
                                       cmocka_unit_test(blocked_bridge),
                                       cmocka_unit_test(a_far_side_between_coils),
                                       cmocka_unit_test(a_divider_of_leaks),
                                       cmocka_unit_test(parts_in_a_row),
                                       cmocka_unit_test(beside_a_sum_of_more),
                                       cmocka_unit_test(coils_behind_open_devices),
                                       cmocka_unit_test(lost_digits_are_no_transient)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
