/* tests/unit/exact/test_exact.c - the exact engine: exact between events, whatever h is. */
#include <complex.h>

#include "exact_bench.h"
#include "systems.h"

/* 16 commutations in 5 ms; closed form in systems.h.  Some eps of 10 V for each. */
static void the_lc_bridge_is_right_to_rounding(void **state) {
    (void)state;
    static const double h[] = {1e-7, 1e-6, 1e-4};
    ns_system *s = system_lc_bridge();
    for (int k = 0; k < 3; k++) {
        const ns_march_options o = {.theta = 1, .gamma = 1, .h = h[k], .method = NS_EXACT};
        const double w0[2] = {1e-6 * 10, 0};
        ns_march *m;
        double x[2], reached;
        assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
        assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
        for (int n = 1; n <= 50; n++) {
            const double t = 5e-3 * n / 50;
            assert_int_equal(ns_march_try(m, t, NS_TO_TIME, &reached), NS_OK);
            assert_int_equal(ns_march_accept(m), NS_OK);
            assert_int_equal(ns_march_read(m, NULL, x, NULL, NULL), NS_OK);
            near(x[0], lc_bridge_v(10, t), 1e-11); /* 50 rad, some eps of 10 V for each */
        }
        assert_int_equal(ns_march_counts(m)->events, 16);
        assert_true(ns_march_counts(m)->problems <= 3); /* a mode met before is no problem */
        ns_march_free(m);
    }
    ns_system_free(s);
}

/* Four modes of some 10 kB: with room for next to nothing each is made again when it comes again, and the
 * answer is the same. */
static void memory_is_bounded(void **state) {
    (void)state;
    ns_system *s = system_lc_bridge();
    double reached, x[2][2];
    long evicted[2];
    for (int k = 0; k < 2; k++) {
        const ns_march_options o = {
            .theta = 1, .gamma = 1, .h = 1e-6, .method = NS_EXACT, .map_bytes = k ? 1 : 0};
        const double w0[2] = {1e-6 * 10, 0};
        ns_march *m;
        assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
        assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
        assert_int_equal(ns_march_try(m, 5e-3, NS_TO_TIME, &reached), NS_OK);
        assert_int_equal(ns_march_read(m, NULL, x[k], NULL, NULL), NS_OK);
        evicted[k] = ns_march_counts(m)->evicted;
        ns_march_free(m);
    }
    near(x[1][0], x[0][0], 1e-12);
    near(x[0][0], lc_bridge_v(10, 5e-3), 1e-11);
    assert_true(evicted[0] == 0 && evicted[1] >= 8); /* 16 events */
    ns_system_free(s);
}

/* How many modes are dropped from 40 to 45 ms and from 85 to 90 ms, by so much room: before that a time scale
 * may still be met for the first time. */
static void dropped_early_and_late(const ns_system *s, size_t room, long dropped[2]) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = NS_EXACT, .map_bytes = room};
    const double w0[2] = {1e-6 * 10, 0};
    ns_march *m;
    double reached;
    long at[19];
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
    for (int k = 1; k <= 18; k++) {
        assert_int_equal(ns_march_try(m, 5e-3 * k, NS_TO_TIME, &reached), NS_OK);
        assert_int_equal(ns_march_accept(m), NS_OK);
        at[k] = ns_march_counts(m)->evicted;
    }
    dropped[0] = at[9] - at[8];
    dropped[1] = at[18] - at[17];
    ns_march_free(m);
}

/* The bridge comes through the same modes again and again: where some of them have room, and others not, no
 * more are dropped after 85 ms than after 40 ms, for what a dropped mode took is free again. */
static void room_is_given_back(void **state) {
    (void)state;
    ns_system *s = system_lc_bridge();
    int some = 0;
    for (size_t room = 1000; room < 40000; room += room / 16) {
        long dropped[2];
        dropped_early_and_late(s, room, dropped);
        some += dropped[0] > 2 && dropped[0] < 14; /* of 16 */
        assert_true(dropped[1] <= dropped[0] + 2);
    }
    assert_true(some > 0);
    ns_system_free(s);
}

/* What a scene does not need is not done: no sine, one state for the inputs (the constant); a mode met
 * before, no factor and no problem; guards that stay away, no search. */
static void what_is_not_needed_is_skipped(void **state) {
    (void)state;
    ns_system *s = system_lc_bridge();
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = NS_EXACT};
    const double w0[2] = {1e-6 * 10, 0};
    double reached;
    ns_march *m;
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
    assert_int_equal(ns_march_try(m, 2.5e-3, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_accept(m), NS_OK);
    const ns_counts before = *ns_march_counts(m);
    assert_int_equal(before.input_states, 1);
    assert_int_equal(ns_march_try(m, 5e-3, NS_TO_TIME, &reached), NS_OK);
    const ns_counts *after = ns_march_counts(m);
    assert_true(after->events - before.events >= 7);
    assert_int_equal(after->problems, before.problems);
    assert_int_equal(after->pivots, before.pivots);
    assert_int_equal(after->factors, before.factors);
    assert_int_equal(after->predicted - before.predicted, after->events - before.events);
    assert_true(after->searches - before.searches <= 2 * (after->events - before.events) + 2);
    ns_march_free(m);
    ns_system_free(s);
}

/* 1 V behind 1 ohm onto 1 F, no device: 20 s are some steps, though each is of 1 us at most for the scheme.
 */
static void without_guards_there_is_nothing_to_stop_for(void **state) {
    (void)state;
    bench b = open_bench();
    source(&b, "v1", 1, 0, (ns_signal){.kind = NS_DC, .u.dc = 1});
    assert_int_equal(ns_circuit_resistor(b.c, "r1", 1, 2, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c1", 2, 0, 1, NAN, NULL), NS_OK);
    start(&b, 1e-6);
    for (int k = 1; k <= 20; k++) {
        go(&b, k, NS_TO_TIME);
        near(v_of(&b, 2), -expm1(-k), 1e-12);
    }
    assert_true(ns_march_counts(b.m)->steps < 1000);
    close_bench(&b);
}

/* R C v' = u - v from v = 0; between corners a sum of exponentials. */
static const double rc = 1e-3;

/* u = vo + Im(a e^(p (t-td))) from td on, before the constant u0: v from v0 at td is
 * vo + Im(a/(1 + p rc) e^(p(t-td))) + (v0 - vo - Im(a/(1 + p rc))) e^(-(t-td)/rc). */
static double after_wave(double vo, double complex a, double complex p, double v0, double t) {
    const double complex b = a / (1 + p * rc);
    return vo + cimag(b * cexp(p * t)) + (v0 - vo - cimag(b)) * exp(-t / rc);
}

static void sines_and_exponentials_are_exact(void **state) {
    (void)state;
    bench b = open_bench();
    ns_signal sine = {.kind = NS_SIN}, rise = {.kind = NS_EXP};
    sine.u.sin.vo = 0.5;
    sine.u.sin.va = 2;
    sine.u.sin.freq = 700;
    sine.u.sin.td = 0.2e-3;
    sine.u.sin.theta = 300;
    sine.u.sin.phase = 30;
    rise.u.exp.v1 = 1;
    rise.u.exp.v2 = 5;
    rise.u.exp.td1 = 0.1e-3;
    rise.u.exp.tau1 = 0.3e-3;
    rise.u.exp.td2 = 2e-3;
    rise.u.exp.tau2 = 0.2e-3;
    source(&b, "vs", 1, 0, sine);
    source(&b, "ve", 3, 0, rise);
    assert_int_equal(ns_circuit_resistor(b.c, "r1", 1, 2, 1e3, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c1", 2, 0, 1e-6, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r2", 3, 4, 1e3, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c2", 4, 0, 1e-6, NAN, NULL), NS_OK);
    start(&b, 1e-5);
    const double complex p = -300 + 2 * pi * 700 * I, a = 2 * cexp(I * pi / 6);
    const double u0 = 0.5 + 2 * sin(pi / 6), at_td = u0 * (1 - exp(-0.2e-3 / rc));
    /* e1 = e^(-(t-td1)/tau1): u = 1 + 4 (1 - e1) - 4 (1 - e2); Im(i e^(pt)) is the real exponential */
    const double v1 = 1 - exp(-0.1e-3 / rc), v2 = after_wave(5, -4 * I, -1 / 0.3e-3, v1, 1.9e-3);
    for (int n = 1; n <= 40; n++) {
        const double t = 0.1e-3 * n;
        go(&b, t, NS_TO_TIME);
        near(v_of(&b, 2), t <= 0.2e-3 ? u0 * (1 - exp(-t / rc)) : after_wave(0.5, a, p, at_td, t - 0.2e-3),
             1e-13);
        double right = t <= 0.1e-3 ? 1 - exp(-t / rc) : after_wave(5, -4 * I, -1 / 0.3e-3, v1, t - 0.1e-3);
        if (t > 2e-3) /* -4 e1 goes on as it was, by e^(-1.9/0.3) smaller */
            right = after_wave(1, -4 * exp(-1.9 / 0.3) * I, -1 / 0.3e-3, v2, t - 2e-3) +
                    after_wave(0, 4 * I, -1 / 0.2e-3, 0, t - 2e-3);
        near(v_of(&b, 4), right, 1e-13);
    }
    close_bench(&b);
}

/* What is over in nanoseconds does not hold up what takes milliseconds, nor is it lost: 1 V through 1 ohm
 * onto 1 nF, and on through 1 kohm onto 1 uF.  By the eigenvalues of the two states, in long double. */
static void fast_and_slow_are_both_exact(void **state) {
    (void)state;
    bench b = open_bench();
    source(&b, "v", 1, 0, dc(1));
    assert_int_equal(ns_circuit_resistor(b.c, "r1", 1, 2, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c1", 2, 0, 1e-9, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r2", 2, 3, 1e3, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c2", 3, 0, 1e-6, NAN, NULL), NS_OK);
    start(&b, 1e-6);
    /* v1' = (1 - v1)/1n - (v1 - v2)/1u, v2' = (v1 - v2)/1m; e = v - 1 decays: e = sum of two modes, e(0) = -1
     */
    const long double a = -1e9L - 1e6L, c = 1e6L, d = 1e3L, e = -1e3L;
    const long double half = (a + e) / 2, root = sqrtl((a - e) * (a - e) / 4 + c * d);
    const long double fast = half - root, slow = (a * e - c * d) / fast;
    /* mode (1, d/(s - e)) for rate s: e1 = p + q = -1, e2 = p d/(fast-e) + q d/(slow-e) = -1 */
    const long double f2 = d / (fast - e), s2 = (slow - a) != 0 ? d / (slow - e) : 0;
    const long double q = (-1 + f2) / (s2 - f2), p = -1 - q;
    static const double at[] = {1e-10, 1e-9, 3e-9, 1e-8, 3e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 3e-3};
    for (size_t n = 0; n < sizeof at / sizeof *at; n++) {
        const long double ef = p * expl(fast * (long double)at[n]), es = q * expl(slow * (long double)at[n]);
        go(&b, at[n], NS_TO_TIME);
        near(v_of(&b, 2), (double)(1 + ef + es), 1e-12); /* 3 ms are 3e6 of the fast time constant */
        near(v_of(&b, 3), (double)(1 + ef * f2 + es * s2), 1e-12);
    }
    close_bench(&b);
}

/* While a mode stands, points cost products only. */
static void points_between_events_cost_no_factor(void **state) {
    (void)state;
    ns_system *s = system_decay();
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-3, .method = NS_EXACT};
    const double w0[1] = {1};
    ns_march *m;
    double x[1], reached;
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
    ns_counts before = {0};
    for (int n = 1; n <= 1000; n++) {
        assert_int_equal(ns_march_try(m, n * 1e-3, NS_TO_TIME, &reached), NS_OK);
        assert_int_equal(ns_march_accept(m), NS_OK);
        if (n == 10)
            before = *ns_march_counts(m);
    }
    assert_int_equal(ns_march_read(m, NULL, x, NULL, NULL), NS_OK);
    near(x[0], exp(-1), 1e-13); /* some eps for each of 1000 */
    const ns_counts *after = ns_march_counts(m);
    assert_int_equal(after->factors, before.factors);
    assert_int_equal(after->maps, before.maps);
    assert_int_equal(after->problems, before.problems);
    ns_march_free(m);
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_lc_bridge_is_right_to_rounding),
        cmocka_unit_test(memory_is_bounded),
        cmocka_unit_test(room_is_given_back),
        cmocka_unit_test(without_guards_there_is_nothing_to_stop_for),
        cmocka_unit_test(what_is_not_needed_is_skipped),
        cmocka_unit_test(sines_and_exponentials_are_exact),
        cmocka_unit_test(fast_and_slow_are_both_exact),
        cmocka_unit_test(points_between_events_cost_no_factor),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
