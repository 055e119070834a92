/* tests/unit/march/test_commanded_switches.c - switches that command each other through the circuit, by each
 * engine.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"

enum { MOST = 16 };

typedef struct rig {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    double x[MOST];
} rig;

static rig begin(void) {
    rig k = {0};
    assert_int_equal(ns_circuit_create(&k.c), NS_OK);
    return k;
}

static void end(rig *k) {
    ns_march_free(k->m);
    ns_system_free(k->s);
    ns_circuit_free(k->c);
}

static void capacitor(rig *k, const char *name, int p, int n, double farad, double v) {
    assert_int_equal(ns_circuit_capacitor(k->c, name, p, n, farad, v, NULL), NS_OK);
}

static void resistor(rig *k, const char *name, int p, int n, double ohm) {
    assert_int_equal(ns_circuit_resistor(k->c, name, p, n, ohm, NULL), NS_OK);
}

/* Closed while the voltage of a node is above vt. */
static void contact(rig *k, const char *name, int p, int n, int by, double vt) {
    const ns_switch of = {vt, 0, 0, INFINITY};
    assert_int_equal(ns_circuit_switch(k->c, name, p, n, by, 0, &of, NULL), NS_OK);
}

static void make(rig *k, ns_method method) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = method, .reltol = 1e-6};
    assert_int_equal(ns_circuit_system(k->c, &k->s), NS_OK);
    assert_true(k->s->n <= MOST);
    assert_int_equal(ns_march_create(k->s, &o, &k->m, NULL), NS_OK);
    assert_int_equal(ns_circuit_rest(k->c, k->x), NS_OK);
}

static void start(rig *k, ns_method method) {
    make(k, method);
    assert_int_equal(ns_march_start(k->m, 0, k->x), NS_OK);
    assert_int_equal(ns_march_read(k->m, NULL, k->x, NULL, NULL), NS_OK);
}

static void go(rig *k, double t) {
    double reached;
    assert_int_equal(ns_march_try(k->m, t, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_accept(k->m), NS_OK);
    assert_int_equal(ns_march_read(k->m, NULL, k->x, NULL, NULL), NS_OK);
}

static double voltage(const rig *k, int node) {
    return k->x[ns_circuit_node_unknown(k->c, node)];
}

static void near(double got, double expected, double off) {
    if (!(fabs(got - expected) <= off))
        fail_msg("%.17g, expected %.17g", got, expected);
}

/* With s1 and s2 open no current flows: v(2) = 0 closes s2, v(1) = 7.5 V closes s1.  Both closed, v(2) = -7.5
 * V opens s2 again, and that stays: v(1) is C2's 0 V, from where C1 and C2 in series discharge by R.  That s2
 * slides, with v(2) at its threshold, would take 6.3 V out of nothing. */
static void none_slides_from_afar(void **state) {
    enum { N1 = 1, N2, N3 };
    const double C1 = 1e-4, C2 = 1e-5, R = 200, t = 1e-4;
    rig k = begin();
    contact(&k, "s1", 0, N3, N1, -3.8);
    contact(&k, "s2", 0, N1, N2, -1.2);
    capacitor(&k, "c1", N1, N2, C1, 7.5);
    capacitor(&k, "c2", N1, N3, C2, 0);
    resistor(&k, "r", N2, 0, R);
    start(&k, *(const ns_method *)*state);
    near(voltage(&k, N1), 0, 1e-6);
    go(&k, t);
    const double i = 7.5 / R * exp(-t / R * (1 / C1 + 1 / C2)),
                 charge = 7.5 * (1 - exp(-t / R * (1 / C1 + 1 / C2))) / (1 / C1 + 1 / C2);
    near(voltage(&k, N2), -R * i, 1e-5);
    near(voltage(&k, N1), charge / C2, 1e-5);
    end(&k);
}

static void refuse(ns_method method, double C) {
    enum { N1 = 1, N2 };
    const ns_switch of = {-4, 0.5, 0, INFINITY};
    double reached;
    rig k = begin();
    assert_int_equal(ns_circuit_switch(k.c, "s", 0, N1, N2, 0, &of, NULL), NS_OK);
    capacitor(&k, "c", N1, N2, C, 6);
    resistor(&k, "r", N2, 0, 10);
    make(&k, method);
    int status = ns_march_start(k.m, 0, k.x);
    if (status == NS_OK)
        status = ns_march_try(k.m, 1e-5, NS_TO_TIME, &reached);
    assert_int_equal(status, NS_E_LIMIT);
    assert_int_equal(ns_march_fault(k.m)->npairs, 1);
    assert_int_equal(ns_march_fault(k.m)->pair[0], 0);
    end(&k);
}

/* Open: no current, v(2) = 0 closes it.  Closed: v(2) = -6 V opens it.  A hysteresis leaves no state between:
 * no engine has an answer, and which switch it is, is told; nor is there one where steps, however short,
 * would discharge the capacitor (1 ns), so that it came to an end. */
static void neither_open_nor_closed(void **state) {
    const ns_method method = *(const ns_method *)*state;
    refuse(method, 1e-4);
    refuse(method, 1e-10);
}

/* The same where a second switch joins the loop at 1 us: the first one is told. */
static void neither_open_nor_closed_later(void **state) {
    enum { N1 = 1, N2, N3, GATE };
    const double at[] = {1e-6, 1e-6}, volts[] = {0, 1};
    const ns_signal gate = {.kind = NS_PWL, .u.pwl = {2, at, volts, NAN, 0}};
    const ns_switch of = {-4, 0.5, 0, INFINITY};
    double reached;
    rig k = begin();
    assert_int_equal(ns_circuit_switch(k.c, "s1", N3, N1, N2, 0, &of, NULL), NS_OK);
    contact(&k, "s2", 0, N3, GATE, 0.5);
    assert_int_equal(ns_circuit_source(k.c, "vg", NS_VOLTAGE, GATE, 0, &gate, NULL), NS_OK);
    capacitor(&k, "c", N1, N2, 1e-4, 6);
    resistor(&k, "r", N2, 0, 10);
    resistor(&k, "r3", N3, 0, 1e6);
    start(&k, *(const ns_method *)*state);
    int status = ns_march_try(k.m, 1e-5, NS_TO_TIME, &reached);
    if (status == NS_OK)
        status = ns_march_try(k.m, 2e-5, NS_TO_TIME, &reached);
    assert_int_equal(status, NS_E_LIMIT);
    const ns_fault *f = ns_march_fault(k.m);
    near(f->t, 1e-6, 1e-9);
    assert_int_equal(f->npairs, 1);
    assert_int_equal(f->pair[0], 0);
    end(&k);
}

/* 1 V behind R and a C of 100 ns / R from an edge on, or until then. */
static void gate(rig *k, const char *name, const char *r, const char *c, int node, double ohm, int falls) {
    static const double at[] = {1e-6, 1e-6, 1e-5, 1e-5}, rising[] = {0, 1, 1, 0}, falling[] = {1, 0, 0, 1};
    const ns_signal v = {.kind = NS_PWL, .u.pwl = {4, at, falls ? falling : rising, NAN, 0}};
    assert_int_equal(ns_circuit_source(k->c, name, NS_VOLTAGE, node + 1, 0, &v, NULL), NS_OK);
    resistor(k, r, node + 1, node, ohm);
    capacitor(k, c, node, 0, 1e-7 / ohm, falls);
}

/* Both gates pass 0.5 V in one instant, 100 ns ln 2 behind each edge, though they are no multiples of one
 * another: the leg does not short its capacitor, whichever of the two is a rounding earlier.  1 uF and 10 ohm
 * are one while s1 is closed.  (exact opened and closed one after the other, and lost all 100 V.) */
static void share_an_instant(ns_method method, double ohm, double other) {
    enum { IN = 1, A, G1, H1, G2, H2 };
    const double closes = 1e-6 + 1e-7 * log(2), opens = 1e-5 + 1e-7 * log(2);
    const double off = method == NS_THETA ? 2 : 1e-4; /* its steps are a tenth of 10 us */
    rig k = begin();
    contact(&k, "s1", IN, A, G1, 0.5);
    contact(&k, "s2", A, 0, G2, 0.5);
    capacitor(&k, "c", IN, 0, 1e-6, 100);
    resistor(&k, "r", A, 0, 10);
    gate(&k, "v1", "r1", "c1", G1, ohm, 0);
    gate(&k, "v2", "r2", "c2", G2, other, 1);
    start(&k, method);
    go(&k, 5e-6);
    near(voltage(&k, IN), 100 * exp((closes - 5e-6) / 1e-5), off);
    near(voltage(&k, A), voltage(&k, IN), 1e-9);
    go(&k, 2e-5);
    near(voltage(&k, IN), 100 * exp((closes - opens) / 1e-5), off);
    near(voltage(&k, A), 0, 1e-9);
    end(&k);
}

static void gates_in_one_instant(void **state) {
    static const double ohms[] = {1, 3, 70, 1100, 13000};
    for (int i = 0; i < 25; i++)
        share_an_instant(*(const ns_method *)*state, ohms[i / 5], ohms[i % 5]);
}

/* Rises at `rises`, after `high` it falls, each edge in 1 ns, every 10 us. */
static void pulses(rig *k, const char *name, int node, double rises, double high) {
    const ns_signal v = {.kind = NS_PULSE, .u.pulse = {0, 1, rises, 1e-9, 1e-9, high, 1e-5, 0}};
    assert_int_equal(ns_circuit_source(k->c, name, NS_VOLTAGE, node, 0, &v, NULL), NS_OK);
}

/* One gate is a source's, of the other one a switch leads to its source: one instant is known ahead, the
 * other is found, at the same time but for rounding.  While s1 is closed 1 uF discharges by 100 ohm; 100
 * times `high` in all. */
static void share_a_known_instant(ns_method method, double high, int which) {
    enum { IN = 1, A, G, H, K, E };
    rig k = begin();
    contact(&k, "s1", IN, A, which == 1 ? G : H, 0.5);
    contact(&k, "s2", A, 0, which == 2 ? G : K, 0.5);
    contact(&k, "s3", which == 1 ? H : K, G, E, 0.5);
    resistor(&k, "r3", G, 0, 1e3);
    capacitor(&k, "c", IN, 0, 1e-6, 100);
    resistor(&k, "r", A, 0, 100);
    pulses(&k, "v1", H, 0, high - 1e-9);
    pulses(&k, "v2", K, high, 1e-5 - high - 1e-9);
    pulses(&k, "v3", E, -1, 100);
    start(&k, method);
    go(&k, 1e-3);
    near(voltage(&k, IN), 100 * exp(-100 * high / 1e-4), method == NS_THETA ? 2 : 1e-4);
    end(&k);
}

static void known_and_found_in_one_instant(void **state) {
    static const double high[] = {5e-6, 3.337e-6, 7.77e-6, 2.5e-6, 1.1e-6};
    for (int i = 0; i < 10; i++)
        share_a_known_instant(*(const ns_method *)*state, high[i / 2], 1 + i % 2);
}

/* The same beside diodes, a coil and a second snubber, with 4e-11 ohm: exact finds no mode and leaves the
 * instant to the ladder.  583 nF lose to 2 snubbers of 98 pF 3.3e-4 of their voltage, and to the coil less
 * than 1e-3 in 1 ns.  (The ladder was told of one of two commands, and the capacitor was emptied.) */
static void left_to_the_ladder(void **state) {
    enum { IN = 1, A, G, H, K, B };
    const double high = 1.9528795811518323e-6;
    const ns_switch leg = {0.5, 0, 4.316e-11, INFINITY};
    const ns_diode diode = {0, 0.002719, INFINITY, INFINITY, 0};
    rig k = begin();
    capacitor(&k, "c", IN, 0, 5.833e-7, 62.54);
    pulses(&k, "v1", H, 0, high - 1e-9);
    pulses(&k, "v2", K, high, 1e-5 - high - 1e-9);
    contact(&k, "s3", H, G, 0, -1);
    assert_int_equal(ns_circuit_switch(k.c, "s1", IN, A, G, 0, &leg, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(k.c, "d1", A, IN, &diode, NULL), NS_OK);
    capacitor(&k, "c1", A, IN, 9.756e-11, 0);
    assert_int_equal(ns_circuit_switch(k.c, "s2", A, 0, K, 0, &leg, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(k.c, "d2", 0, A, &diode, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(k.c, "l", A, 0, 3.053e-5, 0, NULL), NS_OK);
    capacitor(&k, "c2", IN, B, 9.756e-11, 0);
    assert_int_equal(ns_circuit_diode(k.c, "d3", 0, B, &diode, NULL), NS_OK);
    resistor(&k, "r", B, 0, 18.48);
    start(&k, *(const ns_method *)*state);
    go(&k, high - 1e-12);
    const double before = voltage(&k, IN);
    go(&k, high + 1e-9);
    near(voltage(&k, IN), before, 2e-3 * before);
    end(&k);
}

/* A leg whose second gate is the inverse of the first one's, by a switch that pulls it down, or the other way
 * round; deep: behind two more such inverters.  Where one gate rises the other falls in the same instant, and
 * the leg is never a short circuit: C and what `snubber` (F) holds discharge by R while s1 is closed, and
 * that is charged from C when it closes, and emptied when s2 does.  (C lost all 100 V, by each engine.) */
static void invert_a_gate(ns_method method, int which, int deep, double snubber, double ron) {
    enum { IN = 1, A, H, ONE, G, G2, G3, PULL };
    const double C = 1e-6, R = 100, high = 3.337e-6, other = 1e-5 - high;
    const int last = deep ? G3 : G;
    const ns_signal one = {.kind = NS_DC, .u.dc = 1};
    const ns_switch leg = {0.5, 0, ron, INFINITY};
    rig k = begin();
    assert_int_equal(ns_circuit_switch(k.c, "s1", IN, A, which == 1 ? H : last, 0, &leg, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(k.c, "s2", A, 0, which == 1 ? last : H, 0, &leg, NULL), NS_OK);
    contact(&k, "s3", G, 0, H, 0.5);
    assert_int_equal(ns_circuit_source(k.c, "one", NS_VOLTAGE, ONE, 0, &one, NULL), NS_OK);
    resistor(&k, "r3", ONE, G, 1e3);
    if (deep) {
        contact(&k, "s4", G2, 0, G, 0.5);
        resistor(&k, "r4", ONE, G2, 2e3);
        contact(&k, "s5", G3, 0, G2, 0.5);
        resistor(&k, "r5", ONE, G3, 3e3);
    }
    capacitor(&k, "c", IN, 0, C, 100);
    if (snubber > 0)
        capacitor(&k, "cs", A, 0, snubber, 0);
    resistor(&k, "r", A, 0, R);
    pulses(&k, "v1", H, 0, (which == 1 ? high : other) - 1e-9);
    start(&k, method);
    go(&k, 1e-3);
    const double each = exp(-high / (R * (C + snubber))) * C / (C + snubber);
    const double before = which == 1 ? 1 : C / (C + snubber); /* s1 is closed at the start */
    near(voltage(&k, IN), 100 * before * pow(each, 100), method == NS_THETA ? 2 : 1e-3);
    end(&k);
}

static void inverted_gate(void **state) {
    for (int i = 0; i < 16; i++)
        invert_a_gate(*(const ns_method *)*state, 1 + i % 2, i / 2 % 2, i / 4 % 2 ? 1e-9 : 0,
                      i < 8 ? 0 : 1e-9);
}

/* A leg at an ideal source, with a coil that no diode takes over: the same as with gates from two sources. */
static double coil_of_a_leg(ns_method method, int inverted) {
    enum { IN = 1, A, H, ONE, G, B };
    const ns_signal one = {.kind = NS_DC, .u.dc = 1}, dc = {.kind = NS_DC, .u.dc = 100};
    rig k = begin();
    contact(&k, "s1", IN, A, H, 0.5);
    contact(&k, "s2", A, 0, G, 0.5);
    assert_int_equal(ns_circuit_source(k.c, "in", NS_VOLTAGE, IN, 0, &dc, NULL), NS_OK);
    if (inverted) {
        contact(&k, "s3", G, 0, H, 0.5);
        assert_int_equal(ns_circuit_source(k.c, "one", NS_VOLTAGE, ONE, 0, &one, NULL), NS_OK);
        resistor(&k, "r3", ONE, G, 1e3);
    } else {
        pulses(&k, "v2", G, 5e-6, 5e-6 - 1e-9);
    }
    assert_int_equal(ns_circuit_inductor(k.c, "l", A, B, 1e-4, 0, NULL), NS_OK);
    resistor(&k, "r", B, 0, 10);
    pulses(&k, "v1", H, 0, 5e-6 - 1e-9);
    start(&k, method);
    go(&k, 1.03e-4);
    const double v = voltage(&k, B);
    end(&k);
    return v;
}

static void inverted_gate_and_a_coil(void **state) {
    const ns_method method = *(const ns_method *)*state;
    near(coil_of_a_leg(method, 1), coil_of_a_leg(method, 0), method == NS_THETA ? 0.1 : 1e-6);
}

int main(void) {
    static ns_method theta = NS_THETA, exact = NS_EXACT, sparse = NS_SPARSE;
    const struct CMUnitTest tests[] = {
        {"none slides from afar, exact", none_slides_from_afar, NULL, NULL, &exact},
        {"none slides from afar, sparse", none_slides_from_afar, NULL, NULL, &sparse},
        {"gates in one instant, theta", gates_in_one_instant, NULL, NULL, &theta},
        {"gates in one instant, exact", gates_in_one_instant, NULL, NULL, &exact},
        {"gates in one instant, sparse", gates_in_one_instant, NULL, NULL, &sparse},
        {"known and found in one instant, theta", known_and_found_in_one_instant, NULL, NULL, &theta},
        {"known and found in one instant, exact", known_and_found_in_one_instant, NULL, NULL, &exact},
        {"known and found in one instant, sparse", known_and_found_in_one_instant, NULL, NULL, &sparse},
        {"left to the ladder, theta", left_to_the_ladder, NULL, NULL, &theta},
        {"left to the ladder, exact", left_to_the_ladder, NULL, NULL, &exact},
        {"left to the ladder, sparse", left_to_the_ladder, NULL, NULL, &sparse},
        {"inverted gate, theta", inverted_gate, NULL, NULL, &theta},
        {"inverted gate, exact", inverted_gate, NULL, NULL, &exact},
        {"inverted gate, sparse", inverted_gate, NULL, NULL, &sparse},
        {"inverted gate and a coil, theta", inverted_gate_and_a_coil, NULL, NULL, &theta},
        {"inverted gate and a coil, exact", inverted_gate_and_a_coil, NULL, NULL, &exact},
        {"inverted gate and a coil, sparse", inverted_gate_and_a_coil, NULL, NULL, &sparse},
        {"neither open nor closed, theta", neither_open_nor_closed, NULL, NULL, &theta},
        {"neither open nor closed, exact", neither_open_nor_closed, NULL, NULL, &exact},
        {"neither open nor closed, sparse", neither_open_nor_closed, NULL, NULL, &sparse},
        {"neither open nor closed later, theta", neither_open_nor_closed_later, NULL, NULL, &theta},
        {"neither open nor closed later, exact", neither_open_nor_closed_later, NULL, NULL, &exact},
        {"neither open nor closed later, sparse", neither_open_nor_closed_later, NULL, NULL, &sparse},
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
