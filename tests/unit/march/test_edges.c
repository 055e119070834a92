/* tests/unit/march/test_edges.c - what a marcher could step over: pulses, crests, instants behind an event.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "signals.h"

static const double pi = 3.14159265358979323846;

typedef struct bench {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
} bench;

static bench open_bench(void) {
    bench b = {0};
    assert_int_equal(ns_circuit_create(&b.c), NS_OK);
    return b;
}

static ns_method method; /* each test by the scheme and by auto */

static void start_at(bench *b, double t0, double theta, double h) {
    const ns_march_options o = {.theta = theta, .gamma = theta, .h = h, .method = method};
    double w0[32];
    assert_int_equal(ns_circuit_system(b->c, &b->s), NS_OK);
    assert_true(b->s->n <= 32);
    assert_int_equal(ns_march_create(b->s, &o, &b->m, NULL), NS_OK);
    assert_int_equal(ns_circuit_rest(b->c, w0), NS_OK);
    assert_int_equal(ns_march_start(b->m, t0, w0), NS_OK);
}

static void start(bench *b, double theta, double h) {
    start_at(b, 0, theta, h);
}

static double v_at(bench *b, double t, int node) {
    double reached, x[32];
    assert_int_equal(ns_march_try(b->m, t, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_accept(b->m), NS_OK);
    assert_int_equal(ns_march_read(b->m, NULL, x, NULL, NULL), NS_OK);
    return x[ns_circuit_node_unknown(b->c, node)];
}

static void close_bench(bench *b) {
    ns_march_free(b->m);
    ns_system_free(b->s);
    ns_circuit_free(b->c);
}

static void add_source(bench *b, const char *name, ns_output kind, int p, int n, const ns_signal *s) {
    assert_int_equal(ns_circuit_source(b->c, name, kind, p, n, s, NULL), NS_OK);
}

/* A clamp: a source through 1 ohm and 70 nF onto a node that a diode keeps above 0 (another lies across the
 * capacitor). While the source is at -6.5 V the capacitor charges to 6.5 V (70 ns against 6 us); back at 2.5
 * V the node is at 2.5 + 6.5 = 9 V.  The diode's current dies out exponentially before the pulse ends: a
 * guard without a clear break, from which nothing behind it may be stepped over, however far the caller asks
 * for. */
static void a_guard_that_fades_hides_no_pulse(void **state) {
    (void)state;
    const double thetas[] = {1, 0.5}, steps[] = {1e-6, 1e-7, 1e-8};
    const int calls[] = {1, 4, 200};
    for (int k = 0; k < 18; k++) {
        bench b = open_bench();
        const ns_signal s = pulse(2.5, -6.5, 40e-6, 1.5e-6, 2e-6, 6e-6, 1e-3);
        const ns_diode d1 = {0.7, 0.01, 1e12, INFINITY, 0}, d2 = {0, 0, 1e12, INFINITY, 0};
        add_source(&b, "v", NS_VOLTAGE, 3, 0, &s);
        assert_int_equal(ns_circuit_resistor(b.c, "r", 3, 1, 1, NULL), NS_OK);
        assert_int_equal(ns_circuit_capacitor(b.c, "c", 2, 1, 70e-9, -4, NULL), NS_OK);
        assert_int_equal(ns_circuit_diode(b.c, "d1", 1, 2, &d1, NULL), NS_OK);
        assert_int_equal(ns_circuit_diode(b.c, "d2", 0, 2, &d2, NULL), NS_OK);
        start(&b, thetas[k % 2], steps[k / 2 % 3]);
        const int count = calls[k / 6];
        double v = 0;
        for (int i = 1; i <= count; i++)
            v = v_at(&b, 200e-6 * i / count, 2);
        assert_true(fabs(v / 9 - 1) < 1e-6); /* the leaks: 140 us of 1e-12 S against 70 nF */
        close_bench(&b);
    }
}

/* 1 A for pw into 1 F makes pw volts, however short the pulse is against h; scaled to 1 V. */
static void short_pulses_keep_their_charge(void **state) {
    (void)state;
    const double h = 1e-2;
    for (int k = 2; k <= 6; k++) {
        const double pw = h * pow(10, -k);
        bench b = open_bench();
        const ns_signal s = pulse(0, 1 / pw, 0.0123, 0, 0, pw, INFINITY);
        add_source(&b, "i", NS_CURRENT, 0, 1, &s);
        assert_int_equal(ns_circuit_capacitor(b.c, "c", 1, 0, 1, NAN, NULL), NS_OK);
        start(&b, 1, h);
        const double rounding = 16 * 2.3e-16 * 0.0123 / pw; /* of the instants at 12.3 ms */
        assert_true(fabs(v_at(&b, 0.1, 1) - 1) < 1e-12 + 16 * rounding);
        close_bench(&b);
    }
}

/* Closed while sin(2 pi 1k t) > 0.99: acos(0.99)/(1000 pi) = 45 us a period, with h = 100 us; 1 V through 1
 * ohm into 1 F for 100 periods: 1 - exp(-100 acos(0.99)/(1000 pi)). */
static void a_short_crest_closes_its_switch(void **state) {
    (void)state;
    bench b = open_bench();
    ns_signal sine = {.kind = NS_SIN}, dc = {.kind = NS_DC};
    const ns_switch sw = {0.99, 0, 0, INFINITY};
    sine.u.sin.va = 1;
    sine.u.sin.freq = 1e3;
    dc.u.dc = 1;
    add_source(&b, "vg", NS_VOLTAGE, 4, 0, &sine);
    add_source(&b, "v1", NS_VOLTAGE, 1, 0, &dc);
    assert_int_equal(ns_circuit_switch(b.c, "s", 1, 2, 4, 0, &sw, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 2, 3, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c", 3, 0, 1, NAN, NULL), NS_OK);
    start(&b, 1, 1e-4);
    const double expected = 1 - exp(-100 * acos(0.99) / (1000 * pi));
    assert_true(fabs(v_at(&b, 0.1, 3) / expected - 1) < 1e-4); /* theta = 1: 45 us/2 s of it; 2e-5 */
    close_bench(&b);
}

/* The next event, both its sides: the left one is at instant, right of it node is at v. */
static void switches_at(bench *b, double instant, int node, double v) {
    double left, right, x[32];
    assert_int_equal(ns_march_try(b->m, 1, NS_TO_EVENT, &left), NS_OK);
    assert_int_equal(ns_march_accept(b->m), NS_OK);
    assert_true(fabs(left / instant - 1) < 1e-15); /* a few ulps */
    assert_int_equal(ns_march_try(b->m, 1, NS_TO_EVENT, &right), NS_OK);
    assert_int_equal(ns_march_accept(b->m), NS_OK);
    assert_int_equal(ns_march_read(b->m, NULL, x, NULL, NULL), NS_OK);
    assert_true(fabs(x[ns_circuit_node_unknown(b->c, node)] - v) < 1e-9);
}

/* A control that ramps from 0 to 1 in tr crosses 0.5 at td + tr/2 + k per and, back, pw + tr later.  At 200
 * us an ulp of time is 2.7e-20 s: 2.7e-8 of a ramp of 1 ps. */
static void steep_commands_are_obeyed_at_once(void **state) {
    (void)state;
    const double ramps[] = {1e-9, 1e-12}, td = 1e-6, pw = 2e-6, per = 10e-6;
    for (int k = 0; k < 2; k++) {
        const double tr = ramps[k];
        bench b = open_bench();
        const ns_signal gate = pulse(0, 1, td, tr, tr, pw, per), dc = {.kind = NS_DC, .u.dc = 12};
        const ns_switch sw = {0.5, 0, 0, INFINITY};
        add_source(&b, "vg", NS_VOLTAGE, 3, 0, &gate);
        add_source(&b, "v1", NS_VOLTAGE, 1, 0, &dc);
        assert_int_equal(ns_circuit_switch(b.c, "s", 1, 2, 3, 0, &sw, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(b.c, "r", 2, 0, 5, NULL), NS_OK);
        start(&b, 0.5, 19e-9);
        for (int n = 0; n < 20; n++) {
            switches_at(&b, td + tr / 2 + n * per, 2, 12);
            switches_at(&b, td + tr / 2 + n * per + pw + tr, 2, 0);
        }
        close_bench(&b);
    }
}

/* At rest 20 V through 100 ohm flow in the inductor, not in the closed switch across it. */
static void an_inductor_at_rest_takes_the_current(void **state) {
    (void)state;
    bench b = open_bench();
    ns_signal v = {.kind = NS_DC}, on = {.kind = NS_DC};
    const ns_switch sw = {0.5, 0, 0, INFINITY};
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = method};
    double x[8];
    int l;
    v.u.dc = 20;
    on.u.dc = 1;
    add_source(&b, "v1", NS_VOLTAGE, 1, 0, &v);
    add_source(&b, "vg", NS_VOLTAGE, 4, 0, &on);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 2, 100, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(b.c, "l", 2, 0, 1e-3, NAN, &l), NS_OK);
    assert_int_equal(ns_circuit_switch(b.c, "s", 2, 0, 4, 0, &sw, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
    assert_int_equal(ns_march_create(b.s, &o, &b.m, NULL), NS_OK);
    assert_int_equal(ns_march_start_dc(b.m, 0, 0, NULL, NULL, x), NS_OK);
    assert_true(fabs(x[ns_circuit_current_unknown(b.c, l)] / 0.2 - 1) < 1e-12);
    close_bench(&b);
}

/* 1 V through R C = 5000 h: 1 - exp(-1) after that time, less exp(-1) (h / RC)^2 / 12 = 1.2e-9 of theta =
 * 1/2. From 1000 s on, t moves by up to 6e-14 s too much or too little in every step of 1e-9 s: 4e-6 of 1 V.
 * What t itself, read at the end, may be off by, some ulps of 1.1e-13 s, is 1e-8 V here and taken from it. */
static void late_starts_lose_no_time(void **state) {
    (void)state;
    const double h = 1e-9, rc = 5000 * h, t0 = 1000;
    bench b = open_bench();
    ns_signal v = {.kind = NS_DC};
    v.u.dc = 1;
    add_source(&b, "v1", NS_VOLTAGE, 1, 0, &v);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 2, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c", 2, 0, rc, 0, NULL), NS_OK);
    start_at(&b, t0, 0.5, h);
    const double t1 = t0 + rc, right = -expm1(-(t1 - t0) / rc);
    assert_true(fabs(v_at(&b, t1, 2) - right) < 3e-9);
    close_bench(&b);
}

/* A ramp of 5 V in 1 us across 1 uF takes 5 A, and nothing from its end on: half a step of theta = 1/2 that
 * still has the 5 A of before would be answered by -5 A in the other half, and so on for ever. */
static void a_ramp_that_ends_leaves_no_current(void **state) {
    (void)state;
    double reached, x[8];
    for (int k = 0; k < 3; k++) {
        bench b = open_bench();
        const ns_signal v = pulse(0, 5, 50e-6, 1e-6, 1e-6, 49e-6, 100e-6);
        int id;
        assert_int_equal(ns_circuit_source(b.c, "v1", NS_VOLTAGE, 1, 0, &v, &id), NS_OK);
        assert_int_equal(ns_circuit_capacitor(b.c, "c", 1, 0, 1e-6, NAN, NULL), NS_OK);
        start(&b, 0.5, k == 0 ? 1e-6 : k == 1 ? 1e-5 : 1e-3);
        const int i = ns_circuit_current_unknown(b.c, id);
        static const double at[] = {50.5e-6, 51e-6, 52e-6, 60e-6, 90e-6}, right[] = {-5, -5, 0, 0, 0};
        for (int n = 0; n < 5; n++) {
            assert_int_equal(ns_march_try(b.m, at[n], NS_TO_TIME, &reached), NS_OK);
            assert_int_equal(ns_march_accept(b.m), NS_OK);
            assert_int_equal(ns_march_read(b.m, NULL, x, NULL, NULL), NS_OK);
            assert_true(fabs(x[i] - right[n]) < 1e-6); /* rates are read off steps of h/2^10 and less */
        }
        close_bench(&b);
    }
}

/* C from a clock of 5 V with ramps of 1 us, a diode from ground, 100 kohm: more events than are located
 * within one h.  Nothing lifts node 2 above the clock's 5 V; what leaks of the charge in 50 us is 2.5 mV. */
static void a_clamp_stays_below_its_clock(void **state) {
    (void)state;
    bench b = open_bench();
    const ns_signal v = pulse(0, 5, 50e-6, 1e-6, 1e-6, 49e-6, 100e-6);
    const ns_diode d = {.vf = 0, .ron = 0, .roff = INFINITY, .vz = INFINITY, .rz = 0};
    add_source(&b, "v1", NS_VOLTAGE, 1, 0, &v);
    assert_int_equal(ns_circuit_capacitor(b.c, "c", 1, 2, 1e-6, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(b.c, "d", 0, 2, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 2, 0, 1e5, NULL), NS_OK);
    start(&b, 0.5, 1e-3);
    double most = 0;
    for (int n = 1; n <= 400; n++)
        most = fmax(most, v_at(&b, n * 25e-6 + 5e-7, 2));
    assert_true(most > 4.99 && most <= 5);
    close_bench(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_guard_that_fades_hides_no_pulse),
        cmocka_unit_test(short_pulses_keep_their_charge),
        cmocka_unit_test(a_short_crest_closes_its_switch),
        cmocka_unit_test(steep_commands_are_obeyed_at_once),
        cmocka_unit_test(an_inductor_at_rest_takes_the_current),
        cmocka_unit_test(late_starts_lose_no_time),
        cmocka_unit_test(a_ramp_that_ends_leaves_no_current),
        cmocka_unit_test(a_clamp_stays_below_its_clock),
    };
    method = NS_THETA;
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    method = NS_AUTO;
    return failed + cmocka_run_group_tests_name("auto", tests, NULL, NULL);
}
