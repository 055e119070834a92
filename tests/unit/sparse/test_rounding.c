/* tests/unit/sparse/test_rounding.c - the sparse marcher where digits are easily lost. */
#include "rig.h"

#include <stdio.h>

static int elements; /* of all rigs */

static const char *name(char kind) {
    static char text[16];
    (void)snprintf(text, sizeof text, "%c%d", kind, ++elements);
    return text;
}

static void start_by(rig *k, ns_method method, double h, double reltol) {
    const ns_march_options o = {.h = h, .method = method, .reltol = reltol, .theta = 1, .gamma = 1};
    make_by(k, &o);
    start_at_rest(k);
}

static void start(rig *k, double h, double reltol) {
    start_by(k, NS_SPARSE, h, reltol);
}

static void near(double got, double expected, double off) {
    if (!(fabs(got - expected) <= off))
        fail_msg("%.17g, expected %.17g", got, expected);
}

static void resistor(rig *k, int p, int n, double ohm) {
    assert_int_equal(ns_circuit_resistor(k->c, name('r'), p, n, ohm, NULL), NS_OK);
}

static void capacitor(rig *k, int p, int n, double farad, double v) {
    assert_int_equal(ns_circuit_capacitor(k->c, name('c'), p, n, farad, v, NULL), NS_OK);
}

static int inductor(rig *k, int p, int n, double henry, double i) {
    int id;
    assert_int_equal(ns_circuit_inductor(k->c, name('l'), p, n, henry, i, &id), NS_OK);
    return id;
}

static void diode(rig *k, int p, int n, double roff) {
    const ns_diode d = {0, 0, roff, INFINITY, 0};
    assert_int_equal(ns_circuit_diode(k->c, name('d'), p, n, &d, NULL), NS_OK);
}

/* Closed from `from` to `to`. */
static void contact(rig *k, int p, int n, double from, double to) {
    const double t[] = {from, from, to, to}, v[] = {from > 0 ? 0 : 1, 1, 1, 0};
    const ns_switch sw = {0.5, 0, 0, INFINITY};
    const int gate = 100 + elements;
    ns_signal s = {.kind = NS_PWL};
    s.u.pwl.n = 4;
    s.u.pwl.t = t;
    s.u.pwl.v = v;
    s.u.pwl.repeat = NAN;
    assert_int_equal(ns_circuit_source(k->c, name('v'), NS_VOLTAGE, gate, 0, &s, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(k->c, name('s'), p, n, gate, 0, &sw, NULL), NS_OK);
}

static double voltage(const rig *k, int p, int n) {
    const int i = ns_circuit_node_unknown(k->c, p), j = ns_circuit_node_unknown(k->c, n);
    return (i < 0 ? 0 : k->x[i]) - (j < 0 ? 0 : k->x[j]);
}

/* 0.4 A in a coil from ground to a part that nothing else leads out of, but diodes that block them, one
 * behind 10 ohm: they stop at once, and all that comes after is the part's own ring, i(t) of L i' = v,  C v'
 * = -i:  i = i0 cos wt + v0 sqrt(C/L) sin wt,  w = 1/sqrt(LC). */
static void test_interrupted(void **state) {
    const double roff = *(double *)*state, L = 1e-2, C = 1e-6, w = 1 / sqrt(L * C), t = 3e-6;
    rig k = begin();
    capacitor(&k, 1, 4, 1e-8, 9);
    const int ring = inductor(&k, 1, 5, L, -0.1);
    capacitor(&k, 1, 5, C, 5);
    diode(&k, 2, 1, roff);
    diode(&k, 0, 2, roff);
    resistor(&k, 4, 2, 10);
    const int cut = inductor(&k, 0, 4, 1e-3, 0.4);
    start(&k, 1e-6, 0);
    go(&k, 1e-6);
    near(current(&k, cut), 0, 1e-10); /* the leaks' 10 V / 1e12 ohm */
    go(&k, t);
    near(current(&k, cut), 0, 1e-10);
    near(current(&k, ring), -0.1 * cos(w * t) + 5 * sqrt(C / L) * sin(w * t), 1e-8);
    near(voltage(&k, 1, 4), 9, 1e-6);
    end(&k);
}

/* Coils of 0.1 mH to 0.1 H among capacitors and two switches side by side, both closed from 7 us to 18 us,
 * with 10 kohm for all that leads to ground: how both share their current is open, and hardly anything holds
 * the whole.  Expected: what matrices of the modes (exact) make of it. */
static int many_coils(rig *k) {
    capacitor(k, 4, 2, 1e-6, 8);
    (void)inductor(k, 3, 1, 1e-3, -0.1);
    capacitor(k, 5, 1, 1e-4, -3);
    const int id = inductor(k, 3, 0, 1e-2, -0.5);
    capacitor(k, 1, 2, 1e-4, -1);
    contact(k, 3, 5, 7e-6, 1);
    contact(k, 3, 5, 0, 1.8e-5);
    (void)inductor(k, 2, 3, 0.1, -0.8);
    (void)inductor(k, 1, 4, 1e-4, -0.4);
    resistor(k, 4, 0, 1e4);
    diode(k, 0, 2, INFINITY);
    return id;
}

static void test_side_by_side(void **state) {
    (void)state;
    rig k = begin(), exact = begin();
    const int id = many_coils(&k);
    (void)many_coils(&exact);
    start(&k, 1e-6, 0);
    start_by(&exact, NS_EXACT, 1e-6, 0);
    for (int i = 1; i < 30; i += 4) {
        go(&k, i * 1e-6);
        go(&exact, i * 1e-6);
        near(current(&k, id), current(&exact, id), 1e-8);
        near(voltage(&k, 4, 2), voltage(&exact, 4, 2), 1e-7);
    }
    end(&k);
    end(&exact);
}

/* 0.6 A that a diode interrupts, whose leak makes it a transient of so many volts: 6e11 V for 1e-13 s, or 6e5
 * V for 1e-7 s, in which something happens elsewhere.  What is beside it keeps its own volts:
 *
 *     C v' = i,  L i' = -v:   v = v0 cos wt + 0.4 sqrt(L/C) sin wt,   w = 1/sqrt(LC) = 1e4 1/s
 *
 * is 0 at tan wt = -v0/40, from where on a diode keeps it there. */
typedef struct transient {
    double roff, v0;
} transient;

static void test_beside_a_transient(void **state) {
    enum { N1 = 1, N2, N3 };
    const transient *of = *state;
    const double at = atan(-of->v0 / 40) / 1e4;
    double reached;
    rig k = begin();
    inductor(&k, N2, N3, 0.1, -0.6);
    diode(&k, N3, N2, of->roff);
    capacitor(&k, N1, 0, 1e-6, of->v0);
    inductor(&k, 0, N1, 0.01, 0.4);
    diode(&k, N1, 0, INFINITY);
    start(&k, 1e-6, 1e-6);
    go(&k, at / 16);
    assert_int_equal(ns_march_try(k.m, 2 * at, NS_TO_EVENT, &reached), NS_OK);
    near(reached, at, 1e-6 * at);
    go(&k, 2 * at);
    near(voltage(&k, N1, 0), 0, 1e-6);
    end(&k);
}

/* 1 uA to -1 uA into a node of 1 nF, in T = 1 ms, of which a diode leads what is positive to 50 mF at 15 V:
 * in steps of 50 ns the charges of these are known to 1e-16 C, 1e-9 A. From T/2 on the diode blocks, and
 * after another s the node is at  15 V - (2 uA / T) s^2 / (2 * 1 nF),  14.75 V at T. Another diode carries 1
 * A: what is judged by the circuit's own laws (verify/) does not see a microampere beside it. */
static void test_beside_large_capacitor(void **state) {
    static const double t[] = {0, 1e-3}, i[] = {1e-6, -1e-6};
    const ns_signal ramp = {.kind = NS_PWL, .u.pwl = {.n = 2, .t = t, .v = i, .repeat = NAN}},
                    dc = {.kind = NS_DC, .u.dc = 10};
    const double h = *(const double *)*state;
    rig k = begin();
    assert_int_equal(ns_circuit_source(k.c, name('i'), NS_CURRENT, 0, 1, &ramp, NULL), NS_OK);
    capacitor(&k, 1, 0, 1e-9, 15);
    diode(&k, 1, 2, INFINITY);
    capacitor(&k, 2, 0, 0.05, 15);
    assert_int_equal(ns_circuit_source(k.c, name('v'), NS_VOLTAGE, 3, 0, &dc, NULL), NS_OK);
    diode(&k, 3, 4, INFINITY);
    resistor(&k, 4, 0, 10);
    resistor(&k, 4, 2, 1e12); /* else this part is a run of its own */
    start(&k, h, 0);
    go(&k, 0.75e-3);
    near(voltage(&k, 1, 0), 15 - 0.0625, 1e-6);
    go(&k, 1e-3);
    near(voltage(&k, 1, 0), 14.75, 1e-6);
    end(&k);
}

/* 10 V through 0.07 ohm and a diode into ground, from where R alone leads to the other end of the only
 * capacitor: all charge that there ever is is rounding, of two switches side by side that carry nothing, and
 * none of it is to be resolved.  From a random circuit, whose steps were 2^17 times shorter than h from when
 * these closed. */
static void test_nothing_but_rounding(void **state) {
    enum { FAR = 1, NEAR, FLOATS, S };
    const ns_signal dc = {.kind = NS_DC, .u.dc = 10};
    rig k = begin();
    (void)state;
    assert_int_equal(ns_circuit_source(k.c, name('v'), NS_VOLTAGE, S, 0, &dc, NULL), NS_OK);
    resistor(&k, S, NEAR, 0.071445757280364675);
    resistor(&k, FAR, 0, 0.33853884862180361);
    capacitor(&k, NEAR, FAR, 4.9264440860030621e-11, 0);
    contact(&k, NEAR, FLOATS, 1e-4, 1);
    contact(&k, NEAR, FLOATS, 1e-4, 1);
    contact(&k, FAR, NEAR, 0, 1e-4);
    diode(&k, NEAR, 0, INFINITY);
    start(&k, 1e-6, 0);
    go(&k, 2e-4);
    near(voltage(&k, NEAR, FAR), 0, 1e-9);
    assert_true(ns_march_counts(k.m)->steps < 250);
    end(&k);
}

int main(void) {
    static double short_step = 5e-8, shorter_step = 1e-9;
    static transient brief = {1e12, -8}, longer = {1e6, -0.04};
    static double none = INFINITY, leaky = 1e12;
    const struct CMUnitTest tests[] = {
        {"an interrupted coil, floating parts", test_interrupted, NULL, NULL, &none},
        {"an interrupted coil, leaks", test_interrupted, NULL, NULL, &leaky},
        cmocka_unit_test(test_side_by_side),
        cmocka_unit_test(test_nothing_but_rounding),
        {"beside a large capacitor", test_beside_large_capacitor, NULL, NULL, &short_step},
        {"beside a large capacitor, 1 ns", test_beside_large_capacitor, NULL, NULL, &shorter_step},
        {"beside a transient, short", test_beside_a_transient, NULL, NULL, &brief},
        {"beside a transient", test_beside_a_transient, NULL, NULL, &longer},
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
