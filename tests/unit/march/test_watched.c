/* tests/unit/march/test_watched.c - thresholds that a marcher watches (ns_march_watch()): found at the
 * instants of their closed forms, by every engine. */
#include "march_bench.h"

#include <time.h>

/* An RC of 1 us that 1 V charges from t = 0 on: v = 1 - exp(-t/RC). */
static bench rc(ns_method method) {
    bench b = open_bench();
    const ns_march_options o = {.theta = 0.5, .gamma = 0.5, .h = 1e-8, .method = method};
    add_dc(&b, "v", 1, 0, 1, NULL);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 2, 1e3, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c", 2, 0, 1e-9, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
    assert_int_equal(ns_march_create(b.s, &o, &b.m, NULL), NS_OK);
    start_at_rest(&b);
    return b;
}

/* To t, or to where something is crossed: 1. */
static int go_until_crossed(ns_march *m, double t, double *reached) {
    *reached = 0;
    while (*reached < t && !ns_march_crossed(m)) {
        assert_int_equal(ns_march_try(m, t, NS_TO_TIME, reached), NS_OK);
        assert_int_equal(ns_march_accept(m), NS_OK);
    }
    return ns_march_crossed(m) != NULL;
}

static void rc_crosses(ns_method method, double tolerance) {
    bench b = rc(method);
    const int v2 = ns_circuit_node_unknown(b.c, 2);
    double reached;
    for (int k = 1; k < 10; k++) {
        const ns_threshold at[2] = {{v2, -1, 0.1 * k, 0, 0}, {-1, v2, -2, 1, 1}}; /* the other is never met */
        assert_int_equal(ns_march_watch(b.m, 2, at), NS_OK);
        assert_int_equal(go_until_crossed(b.m, 1e-5, &reached), 1);
        assert_int_equal(ns_march_crossed(b.m)[0], 1);
        assert_int_equal(ns_march_crossed(b.m)[1], 0);
        assert_true(fabs(reached - -1e-6 * log(1 - 0.1 * k)) < tolerance);
        double t;
        assert_int_equal(ns_march_try(b.m, 1e-5, NS_TO_TIME, &t), NS_E_STATE);
    }
    assert_int_equal(ns_march_watch(b.m, 0, NULL), NS_OK);
    assert_int_equal(go_until_crossed(b.m, 1e-5, &reached), 0);
    assert_true(fabs(unknown(b.m, v2) - (1 - exp(-10))) < 1e-4);
    close_bench(&b);
}

static void of_an_rc(void **state) {
    (void)state;
    rc_crosses(NS_EXACT, 1e-18); /* beyond by 4e-14 of 1 V, at a slope of 0.1 V/us */
    rc_crosses(NS_AUTO, 1e-18);
    rc_crosses(NS_SPARSE, 1e-14); /* reltol 1e-9 of 1 us */
    rc_crosses(NS_THETA, 1e-8);   /* within a step */
}

/* LC of 1 us/(2 pi) from 1 V: cos(2 pi t/us); peaks reach 0.9999 but for a few ns, from far between samples.
 */
static void of_a_ring(void **state) {
    (void)state;
    bench b = open_bench();
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-7, .method = NS_EXACT};
    const double us = 1e-6 / (2 * pi);
    assert_int_equal(ns_circuit_capacitor(b.c, "c", 1, 0, us, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(b.c, "l", 1, 0, us, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
    assert_int_equal(ns_march_create(b.s, &o, &b.m, NULL), NS_OK);
    start_at_rest(&b);
    const int v1 = ns_circuit_node_unknown(b.c, 1);
    const double level = 0.9999, from_peak = 1e-6 * acos(level) / (2 * pi);
    for (int k = 0; k < 40; k++) { /* down after the peak, up before the next */
        const ns_threshold at = {v1, -1, level, k % 2 == 0, 0};
        const int periods = (k + 1) / 2;
        const double expected = 1e-6 * periods + (k % 2 ? -from_peak : from_peak);
        double reached;
        assert_int_equal(ns_march_watch(b.m, 1, &at), NS_OK);
        assert_int_equal(go_until_crossed(b.m, 1e-3, &reached), 1);
        assert_true(fabs(reached - expected) < 1e-15); /* level is off by 1e-14, at a slope of 0.09 / us */
    }
    close_bench(&b);
}

/* A source that jumps over the threshold: crossed at that instant, on its right side. */
static void of_a_jump(void **state) {
    (void)state;
    for (int method = NS_AUTO; method <= NS_SPARSE; method++) {
        bench b = open_bench();
        const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-7, .method = (ns_method)method};
        add_step(&b, "v", 1, 0, 0, 3, 1e-6);
        assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 2, 1, NULL), NS_OK);
        assert_int_equal(ns_circuit_diode(b.c, "d", 2, 0, &ideal_diode, NULL), NS_OK);
        assert_int_equal(ns_circuit_capacitor(b.c, "c", 1, 0, 1e-9, NAN, NULL), NS_OK);
        assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
        assert_int_equal(ns_march_create(b.s, &o, &b.m, NULL), NS_OK);
        start_at_rest(&b);
        const ns_threshold at = {ns_circuit_node_unknown(b.c, 1), -1, 1, 0, 1};
        double reached;
        assert_int_equal(ns_march_watch(b.m, 1, &at), NS_OK);
        assert_int_equal(go_until_crossed(b.m, 2e-6, &reached), 1);
        assert_true(fabs(reached - 1e-6) < 1e-12); /* h/2^20 */
        close_bench(&b);
    }
}

/* A pulse from 0 to 1 V and back: its ends are at the thresholds, which they belong to or not. */
static void of_what_comes_to_rest(void **state) {
    (void)state;
    const double us = 1e-6, t[4] = {us, 2 * us, 3 * us, 4 * us}, v[4] = {0, 1, 1, 0};
    const struct {
        double value;
        int includes;
        double up, down; /* s */
    } cases[] = {{0, 0, us, 4 * us}, {1, 1, 2 * us, 3 * us}, {0.25, 0, 1.25 * us, 3.75 * us}};
    for (int k = 0; k < 3; k++) {
        bench b = open_bench();
        ns_signal s = {.kind = NS_PWL};
        const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-7, .method = NS_EXACT};
        s.u.pwl.n = 4;
        s.u.pwl.t = t;
        s.u.pwl.v = v;
        s.u.pwl.repeat = NAN;
        assert_int_equal(ns_circuit_source(b.c, "v", NS_VOLTAGE, 1, 0, &s, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 2, 1, NULL), NS_OK);
        assert_int_equal(ns_circuit_capacitor(b.c, "c", 2, 0, 1e-7, NAN, NULL), NS_OK);
        assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
        assert_int_equal(ns_march_create(b.s, &o, &b.m, NULL), NS_OK);
        start_at_rest(&b);
        ns_threshold at = {ns_circuit_node_unknown(b.c, 1), -1, cases[k].value, 0, cases[k].includes};
        for (int half = 0; half < 2; half++) {
            double reached;
            assert_int_equal(ns_march_watch(b.m, 1, &at), NS_OK);
            assert_int_equal(go_until_crossed(b.m, 10 * us, &reached), 1);
            assert_true(fabs(reached - (half ? cases[k].down : cases[k].up)) < 1e-18); /* 4e-14 of 1 V / us */
            at.above = 1;
        }
        close_bench(&b);
    }
}

/* The pulse from 0 to 1 V in series with 0.1, 0.2 and -0.3 V: it rests at 6e-17 V, which is 0 V but for
 * rounding: where 1 V is another threshold of it, and after it was at 1 V. */
static void of_what_rests_but_for_rounding(void **state) {
    static const double us = 1e-6, t[4] = {1e-6, 2e-6, 3e-6, 4e-6}, v[4] = {0, 1, 1, 0};
    (void)state;
    for (int pair = 0; pair < 2; pair++) {
        bench b = open_bench();
        ns_signal s = {.kind = NS_PWL};
        const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-7, .method = NS_EXACT};
        s.u.pwl.n = 4;
        s.u.pwl.t = t;
        s.u.pwl.v = v;
        s.u.pwl.repeat = NAN;
        add_dc(&b, "a", 1, 0, 0.1, NULL);
        add_dc(&b, "b", 2, 1, 0.2, NULL);
        add_dc(&b, "c", 3, 2, -0.3, NULL);
        assert_int_equal(ns_circuit_source(b.c, "v", NS_VOLTAGE, 4, 3, &s, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(b.c, "r", 4, 5, 1, NULL), NS_OK);
        assert_int_equal(ns_circuit_capacitor(b.c, "k", 5, 0, 1e-7, NAN, NULL), NS_OK);
        assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
        assert_int_equal(ns_march_create(b.s, &o, &b.m, NULL), NS_OK);
        start_at_rest(&b);
        const int v4 = ns_circuit_node_unknown(b.c, 4);
        ns_threshold at[2] = {{v4, -1, 0, 0, 0}, {v4, -1, 1, 0, 1}};
        assert_true(unknown(b.m, v4) > 0); /* though at rest */
        const double up = pair ? us : us * (1 + 1e-9);
        double reached;
        assert_int_equal(ns_march_watch(b.m, 1 + pair, at), NS_OK);
        assert_int_equal(go_until_crossed(b.m, 10 * us, &reached), 1);
        assert_true(pair ? fabs(reached - up) < 1e-18 : reached < up);
        at[0].above = 1;
        assert_int_equal(ns_march_watch(b.m, 1, at), NS_OK);
        assert_int_equal(go_until_crossed(b.m, 10 * us, &reached), 1);
        assert_true(fabs(reached - 4 * us) < 1e-18);
        close_bench(&b);
    }
}

/* Two ramps to 1 V whose times are numbers next to each other: what they cross is crossed together, on the
 * way and at their ends. */
static void of_what_rounding_tells_apart(void **state) {
    const double us = 1e-6, from = 0.3e-6, to = 1.3e-6, v[2] = {0, 1},
                 t[2][2] = {{from, to}, {nextafter(from, 1), nextafter(to, 1)}};
    (void)state;
    for (int order = 0; order < 2; order++) {
        bench b = open_bench();
        const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-7, .method = NS_EXACT};
        ns_threshold at[2];
        for (int k = 0; k < 2; k++) {
            ns_signal s = {.kind = NS_PWL};
            s.u.pwl.n = 2;
            s.u.pwl.t = t[k ^ order];
            s.u.pwl.v = v;
            s.u.pwl.repeat = NAN;
            assert_int_equal(ns_circuit_source(b.c, k ? "b" : "a", NS_VOLTAGE, k + 1, 0, &s, NULL), NS_OK);
        }
        assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 3, 1, NULL), NS_OK);
        assert_int_equal(ns_circuit_capacitor(b.c, "c", 3, 0, 1e-7, NAN, NULL), NS_OK);
        assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
        assert_int_equal(ns_march_create(b.s, &o, &b.m, NULL), NS_OK);
        start_at_rest(&b);
        for (int end = 0; end < 2; end++) {
            double reached;
            for (int k = 0; k < 2; k++)
                at[k] = (ns_threshold){ns_circuit_node_unknown(b.c, k + 1), -1, end ? 1 : 0.5, 0, end};
            assert_int_equal(ns_march_watch(b.m, 2, at), NS_OK);
            assert_int_equal(go_until_crossed(b.m, 10 * us, &reached), 1);
            assert_int_equal(ns_march_crossed(b.m)[0], 1);
            assert_int_equal(ns_march_crossed(b.m)[1], 1);
            assert_true(fabs(reached - (end ? to : 0.8 * us)) < 1e-18);
        }
        close_bench(&b);
    }
}

/* The current into 1 uF is C dv/dt: 0, and 1 A while its source rises by 1 V/us. */
static void of_a_current_that_jumps(void **state) {
    static const ns_method methods[] = {NS_EXACT, NS_SPARSE};
    static const double t[3] = {1e-6, 2e-6, 3e-6}, v[3] = {0, 1, 1};
    (void)state;
    for (int k = 0; k < 2; k++) {
        bench b = open_bench();
        ns_signal s = {.kind = NS_PWL};
        const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-7, .method = methods[k]};
        int id;
        s.u.pwl.n = 3;
        s.u.pwl.t = t;
        s.u.pwl.v = v;
        s.u.pwl.repeat = NAN;
        assert_int_equal(ns_circuit_source(b.c, "v", NS_VOLTAGE, 1, 0, &s, &id), NS_OK);
        assert_int_equal(ns_circuit_capacitor(b.c, "c", 1, 0, 1e-6, NAN, NULL), NS_OK);
        assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
        assert_int_equal(ns_march_create(b.s, &o, &b.m, NULL), NS_OK);
        start_at_rest(&b);
        ns_threshold at = {ns_circuit_current_unknown(b.c, id), -1, -0.5, 1, 0};
        for (int half = 0; half < 2; half++) {
            double reached;
            assert_int_equal(ns_march_watch(b.m, 1, &at), NS_OK);
            assert_int_equal(go_until_crossed(b.m, 1.3e-6 + half * 1e-6, &reached), 1);
            assert_true(fabs(reached - (half + 1) * 1e-6) < 1e-18);
            at.above = 0;
        }
        close_bench(&b);
    }
}

/* 20 trials whose end is the next number after their begin: each is one sample of the sparse engine, which
 * asks for sixteen of a step.  A search that does not get on takes its bound of a million samples each, of
 * which 20 million took 1.2 s. */
static void of_the_shortest_trial(void **state) {
    (void)state;
    bench b = rc(NS_SPARSE);
    const ns_threshold never = {ns_circuit_node_unknown(b.c, 2), -1, 2, 0, 0};
    double t;
    assert_int_equal(ns_march_watch(b.m, 1, &never), NS_OK);
    assert_int_equal(go_until_crossed(b.m, 1e-7, &t), 0);
    const clock_t since = clock();
    for (int k = 0; k < 20; k++) {
        const double next = nextafter(t, INFINITY);
        assert_int_equal(ns_march_try(b.m, next, NS_TO_TIME, &t), NS_OK);
        assert_true(t == next);
        assert_int_equal(ns_march_accept(b.m), NS_OK);
    }
    assert_true((double)(clock() - since) < 0.1 * CLOCKS_PER_SEC);
    close_bench(&b);
}

static void bad_calls(void **state) {
    (void)state;
    bench b = rc(NS_EXACT);
    const ns_threshold low = {-2, -1, 0, 0, 0}, high = {0, b.s->n, 0, 0, 0}, none = {0, -1, NAN, 0, 0};
    const ns_threshold beyond = {0, -1, 0.5, 0, 0}; /* v(1) is 1 V */
    double reached;
    assert_int_equal(ns_march_watch(NULL, 0, NULL), NS_E_NULL);
    assert_int_equal(ns_march_watch(b.m, 1, NULL), NS_E_NULL);
    assert_int_equal(ns_march_watch(b.m, -1, &low), NS_E_SIZE);
    assert_int_equal(ns_march_watch(b.m, 1, &low), NS_E_SIZE);
    assert_int_equal(ns_march_watch(b.m, 1, &high), NS_E_SIZE);
    assert_int_equal(ns_march_watch(b.m, 1, &none), NS_E_NUMBER);
    assert_null(ns_march_crossed(b.m));
    assert_int_equal(ns_march_watch(b.m, 1, &beyond), NS_OK);
    assert_non_null(ns_march_crossed(b.m));
    assert_int_equal(ns_march_try(b.m, 1e-6, NS_TO_TIME, &reached), NS_E_STATE);
    start_at_rest(&b);
    assert_null(ns_march_crossed(b.m));
    assert_int_equal(ns_march_try(b.m, 1e-6, NS_TO_TIME, &reached), NS_OK);
    close_bench(&b);
}

/* 1 V, 10 kHz beside a ring of 1.1 GHz without losses, which samples are as close as: v is above 0.5 V from
 * 1/12 to 5/12 of its period, 2 million samples after the start of a trial of 0.1 ms.  After one million the
 * end of the trial was looked at next, where v is 0 again: both were passed without a word. */
static void of_more_samples_than_a_trial_may_take(void **state) {
    (void)state;
    bench b = open_bench();
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-4, .method = NS_EXACT, .whole = 1};
    const ns_signal sine = {.kind = NS_SIN, .u.sin = {.va = 1, .freq = 1e4}};
    double reached;
    assert_int_equal(ns_circuit_source(b.c, "v", NS_VOLTAGE, 1, 0, &sine, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c", 2, 0, 1e-11, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(b.c, "l", 2, 0, 2e-9, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
    assert_int_equal(ns_march_create(b.s, &o, &b.m, NULL), NS_OK);
    start_at_rest(&b);
    const ns_threshold at = {ns_circuit_node_unknown(b.c, 1), -1, 0.5, 0, 0};
    assert_int_equal(ns_march_watch(b.m, 1, &at), NS_OK);
    assert_int_equal(go_until_crossed(b.m, 1e-4, &reached), 1);
    assert_true(ns_march_counts(b.m)->looks > 1000000);
    assert_true(fabs(reached - 1e-4 / 12) < 1e-16);
    close_bench(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(of_an_rc),
        cmocka_unit_test(of_a_ring),
        cmocka_unit_test(of_a_jump),
        cmocka_unit_test(of_what_comes_to_rest),
        cmocka_unit_test(of_what_rests_but_for_rounding),
        cmocka_unit_test(of_what_rounding_tells_apart),
        cmocka_unit_test(of_a_current_that_jumps),
        cmocka_unit_test(of_the_shortest_trial),
        cmocka_unit_test(of_more_samples_than_a_trial_may_take),
        cmocka_unit_test(bad_calls),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
