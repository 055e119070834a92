/* tests/unit/exact/test_events.c - the exact engine at events: where they are, and both sides of them. */
#include "exact_bench.h"

/* 10 V through a switch that is closed for 1 us in 4, a diode, 2 uH onto 4 V: the current rises by 3 A/us to
 * 3 A and falls by 2 A/us until it ends 2.5 us after the begin. */
static bench buck(double h) {
    bench b = open_bench();
    ns_signal gate = {.kind = NS_PULSE};
    const ns_switch sw = {0.5, 0, 0, INFINITY};
    const ns_diode d = {0, 0, INFINITY, INFINITY, 0};
    gate.u.pulse.v2 = 1;
    gate.u.pulse.pw = 1e-6;
    gate.u.pulse.per = 4e-6;
    source(&b, "vin", 1, 0, dc(10));
    source(&b, "vg", 9, 0, gate);
    assert_int_equal(ns_circuit_switch(b.c, "s", 1, 2, 9, 0, &sw, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(b.c, "d", 0, 2, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(b.c, "l", 2, 3, 2e-6, NAN, NULL), NS_OK);
    source(&b, "vout", 3, 0, dc(4));
    start(&b, h);
    return b;
}

static double buck_current(double t) {
    const double phase = fmod(t, 4e-6);
    return phase < 1e-6 ? 3e6 * phase : fmax(0, 3 - 2e6 * (phase - 1e-6));
}

static void a_current_ends_in_time(void **state) {
    (void)state;
    bench b = buck(1e-7);
    int l = 0;
    while (ns_circuit_current_unknown(b.c, l) < 0 || l < 4)
        l++; /* vin, vg, s, d, l */
    double t = 0;
    for (int n = 1; n <= 700; n++) {
        t = n * 0.37e-6;
        go(&b, t, NS_TO_TIME);
        near(i_of(&b, l), buck_current(t), 1e-9); /* ulps of t by 3e6 A/s */
    }
    assert_int_equal(ns_march_counts(b.m)->events, 3 * 64 + 2); /* 64.75 periods */
    assert_true(ns_march_counts(b.m)->problems <= 8);
    close_bench(&b);
}

/* Both sides of the first three events; the current's is a kink, the gate's instants are given. */
static void events_have_two_sides(void **state) {
    (void)state;
    static const double instant[] = {1e-6, 2.5e-6, 4e-6};
    bench b = buck(1e-7);
    for (int n = 0; n < 3; n++) {
        const double left = go(&b, 1, NS_TO_EVENT);
        assert_true(ns_march_at_event(b.m));
        near(left, instant[n], 4e-21); /* some ulps */
        near(i_of(&b, 4), n == 0 ? 3 : 0, 1e-14);
        near(v_of(&b, 2), n == 0 ? 10 : n == 1 ? 0 : 4, 1e-13);
        const double right = go(&b, 1, NS_TO_EVENT);
        assert_true(right == left && !ns_march_at_event(b.m));
        near(v_of(&b, 2), n == 0 ? 0 : n == 1 ? 4 : 10, 1e-13);
    }
    close_bench(&b);
}

/* A try changes nothing that another one sees. */
static void tries_leave_the_accepted_point_alone(void **state) {
    (void)state;
    bench b = buck(1e-7);
    double once[MOST], again[MOST], reached;
    go(&b, 3.3e-6, NS_TO_TIME);
    assert_int_equal(ns_march_try(b.m, 9.1e-6, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_read(b.m, NULL, once, NULL, NULL), NS_OK);
    assert_int_equal(ns_march_try(b.m, 3.9e-6, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_try(b.m, 30e-6, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_try(b.m, 9.1e-6, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_read(b.m, NULL, again, NULL, NULL), NS_OK);
    for (int i = 0; i < b.s->n; i++)
        near(again[i], once[i], 1e-13);
    close_bench(&b);
}

/* 1 uF at 10 V and 3 uF at 2 V, 1 ohm across each, joined at 1 us: v = q/(C1+C2) at once, then e^(-t/2us). */
static void charges_are_kept(void **state) {
    (void)state;
    bench b = open_bench();
    const ns_switch contact = {0.5, 0, 0, INFINITY};
    static const double t[2] = {1e-6, 1e-6}, v[2] = {0, 1};
    ns_signal gate = {.kind = NS_PWL};
    gate.u.pwl.n = 2;
    gate.u.pwl.t = t;
    gate.u.pwl.v = v;
    gate.u.pwl.repeat = NAN;
    assert_int_equal(ns_circuit_capacitor(b.c, "c1", 1, 0, 1e-6, 10, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c2", 2, 0, 3e-6, 2, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r1", 1, 0, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r2", 2, 0, 1, NULL), NS_OK);
    source(&b, "vg", 9, 0, gate);
    assert_int_equal(ns_circuit_switch(b.c, "s", 1, 2, 9, 0, &contact, NULL), NS_OK);
    start(&b, 1e-7);
    go(&b, 0.7e-6, NS_TO_TIME);
    near(v_of(&b, 1), 10 * exp(-0.7), 1e-14);
    const double joined = (10 * exp(-1) + 3 * 2 * exp(-1. / 3)) / 4;
    for (int n = 0; n < 10; n++) {
        go(&b, 1e-6 + 0.5e-6 * (n + 1), NS_TO_TIME);
        near(v_of(&b, 1), joined * exp(-0.25 * (n + 1)), 1e-13);
        near(v_of(&b, 2), joined * exp(-0.25 * (n + 1)), 1e-13);
    }
    close_bench(&b);
}

/* An edge of 9.6 V in 0.12 ns, within which a diode begins to conduct, at 0.3 mH and 1 ohm; what the source
 * has in a capacitor is an instantaneous part of the mode.  An event in it is no jump of the current. */
static void an_event_in_a_steep_edge(void **state) {
    (void)state;
    const double v1 = 14.4, v2 = 24, td = 13e-6, tr = 0.12e-9, tau = 0.3e-3;
    const ns_diode d = {0, 0, INFINITY, INFINITY, 0};
    for (int until = 0; until < 2; until++) {
        bench b = open_bench();
        int l;
        source(&b, "v", 1, 0, pulse(v1, v2, td, tr, tr, 1, INFINITY));
        assert_int_equal(ns_circuit_capacitor(b.c, "c", 1, 0, 1e-7, v1, NULL), NS_OK);
        assert_int_equal(ns_circuit_inductor(b.c, "l", 1, 2, tau, NAN, &l), NS_OK);
        assert_int_equal(ns_circuit_resistor(b.c, "r", 2, 0, 1, NULL), NS_OK);
        assert_int_equal(ns_circuit_diode(b.c, "d", 1, 3, &d, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(b.c, "r3", 3, 4, 50, NULL), NS_OK);
        source(&b, "v4", 4, 0, dc(14.5));
        start(&b, 1e-6);
        for (double t = 0; t < 14e-6;)
            t = go(&b, 14e-6, until ? NS_TO_TIME : NS_TO_EVENT);
        const double rise = 1 - tau / tr * expm1(tr / tau) * exp((td - 14e-6) / tau);
        near(i_of(&b, l), -v1 * expm1(-14e-6 / tau) + (v2 - v1) * rise, 1e-11);
        close_bench(&b);
    }
}

/* A Cockcroft-Walton multiplier from rest: nothing in it jumps, though most of its charges differ by nothing
 * but rounding before they are first pushed up, and the exact needs no steps of the scheme at any h. */
static void charges_of_rounding_do_not_jump(void **state) {
    (void)state;
    const ns_diode d = {0, 0, INFINITY, INFINITY, 0};
    for (int k = 5; k <= 10; k++) {
        bench b = open_bench();
        ns_signal sine = {.kind = NS_SIN};
        sine.u.sin.va = 100;
        sine.u.sin.freq = 10e3;
        source(&b, "v1", 11, 0, sine);
        for (int j = 0; j < 10; j++) {
            const int below = j == 0 ? 11 : j - 1;
            const char name[] = {(char)('a' + j), 0}, of[] = {(char)('A' + j), '1', 0};
            assert_int_equal(ns_circuit_diode(b.c, name, j, j + 1, &d, NULL), NS_OK);
            assert_int_equal(ns_circuit_capacitor(b.c, of, below, j + 1, 1e-6, NAN, NULL), NS_OK);
        }
        assert_int_equal(ns_circuit_resistor(b.c, "r", 10, 0, 1e6, NULL), NS_OK);
        start(&b, ldexp(1e-4, -k));
        go(&b, 1e-3, NS_TO_TIME);
        const ns_counts *c = ns_march_counts(b.m);
        assert_int_equal(c->trials, 0);
        assert_true(c->events > 80 && c->problems <= 20);
        close_bench(&b);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_current_ends_in_time),
        cmocka_unit_test(events_have_two_sides),
        cmocka_unit_test(tries_leave_the_accepted_point_alone),
        cmocka_unit_test(charges_are_kept),
        cmocka_unit_test(an_event_in_a_steep_edge),
        cmocka_unit_test(charges_of_rounding_do_not_jump),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
