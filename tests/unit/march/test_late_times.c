/* tests/unit/march/test_late_times.c - starts at late times: what t rounds off is not lost, however many
 * steps there are.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth.h"

enum { MOST = 16, PERIODS = 1000 };
static const double pi = 3.14159265358979323846;

typedef struct late {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    double x[MOST];
} late;

/* From rest at t0 on to t. */
static void go(late *k, ns_method method, double h, double t0, double t) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = h, .method = method, .reltol = 1e-13};
    double w0[MOST], reached;
    assert_int_equal(ns_circuit_system(k->c, &k->s), NS_OK);
    assert_true(k->s->n <= MOST);
    assert_int_equal(ns_circuit_rest(k->c, w0), NS_OK);
    assert_int_equal(ns_march_create(k->s, &o, &k->m, NULL), NS_OK);
    assert_int_equal(ns_march_start(k->m, t0, w0), NS_OK);
    assert_int_equal(ns_march_try(k->m, t, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_read(k->m, NULL, k->x, NULL, NULL), NS_OK);
}

static void end(late *k) {
    ns_march_free(k->m);
    ns_system_free(k->s);
    ns_circuit_free(k->c);
}

/* 1 mH and 1 uF ring from 1 V: v = cos wt, i sqrt(L/C) = sin wt, w = 1/sqrt(LC), t from the start on (a
 * double holds t - t0 exactly: Sterbenz).  At t0 = 1e6 s a step of 32 us is off by up to 58 ps, always the
 * same: 2e-3 rad by exact, 5e-2 by sparse, if nobody counts them.  What is left is the rounding of some 1e6
 * steps. */
static double ring(ns_method method, double t0, double t) {
    const double w = 1 / sqrt(1e-3 * 1e-6);
    int l1;
    late k;
    assert_int_equal(ns_circuit_create(&k.c), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c1", 1, 0, 1e-6, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(k.c, "l1", 1, 0, 1e-3, 0, &l1), NS_OK);
    go(&k, method, 1e-6, t0, t);
    const double v = k.x[ns_circuit_node_unknown(k.c, 1)], i = k.x[ns_circuit_current_unknown(k.c, l1)];
    const double phase = fmod(w * (t - t0), 2 * pi), a = cos(phase), b = sin(phase);
    end(&k);
    return atan2(i * sqrt(1e3) * a - v * b, v * a + i * sqrt(1e3) * b);
}

static void rings(void **unused) {
    (void)unused;
    const double starts[] = {0, 1, 1e3, 1e6};
    const ns_method methods[] = {NS_EXACT, NS_SPARSE};
    for (int a = 0; a < 4; a++)
        for (int b = 0; b < 2; b++) {
            const double t = starts[a] + 2 * pi * sqrt(1e-9) * (PERIODS + 0.1);
            const double off = ring(methods[b], starts[a], t);
            print_message("%s from %g s: off by %.1e rad\n", b ? "sparse" : "exact", starts[a], off);
            assert_true(fabs(off) < 1e-11); /* 6284 rad, known to 1e-16 of that, by each of some operations */
        }
}

/* 1 V charges 1 uF by 1 kohm; from 0.6 V down to 0.4 V a switch puts 1/3 kohm across it: up for RC
 * ln(0.6/0.4), down, towards 0.25 V by RC/4, for RC/4 ln(0.35/0.15).  Events come at times that t rounds,
 * too. */
static double oscillator(ns_method method, double t0) {
    const double RC = 1e-3, up = RC * log(1.5), down = RC / 4 * log(0.35 / 0.15), first = -RC * log(0.4);
    const double t = t0 + first + PERIODS * (up + down) + 0.5 * down, since = t - t0 - first;
    const ns_switch sw = {0.5, 0.1, 0, INFINITY};
    ns_signal one = {.kind = NS_DC};
    late k;
    one.u.dc = 1;
    assert_int_equal(ns_circuit_create(&k.c), NS_OK);
    assert_int_equal(ns_circuit_source(k.c, "v1", NS_VOLTAGE, 1, 0, &one, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "r1", 1, 2, 1e3, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c1", 2, 0, 1e-6, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(k.c, "s1", 2, 3, 2, 0, &sw, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "r2", 3, 0, 1e3 / 3, NULL), NS_OK);
    go(&k, method, 1e-5, t0, t);
    const double v = k.x[ns_circuit_node_unknown(k.c, 2)];
    const double want = 0.25 + 0.35 * exp(-(since - PERIODS * (up + down)) / (RC / 4));
    end(&k);
    return v - want;
}

static void oscillators(void **unused) {
    (void)unused;
    const ns_method methods[] = {NS_EXACT, NS_SPARSE};
    for (int b = 0; b < 2; b++) {
        const double off = oscillator(methods[b], 1e6);
        print_message("%s: off by %.1e V\n", b ? "sparse" : "exact", off);
        assert_true(fabs(off) < 1e-9);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(rings), cmocka_unit_test(oscillators)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
