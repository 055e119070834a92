/* tests/unit/march/test_march.c - events, jumps, starts and output times, against closed forms. */
#include "march_bench.h"
#include "systems.h"
#include "wrap_alloc.h"

/* --- order across events --- */

static double bridge_error(double theta, double gamma, double h) {
    ns_system *s = system_lc_bridge();
    ns_march *m = marcher(s, theta, gamma, h);
    const double w0[2] = {1e-6 * 10, 0}, end = 2e-3; /* six commutations */
    assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
    go(m, end);
    const double error = fabs(unknown(m, 0) - lc_bridge_v(10, end));
    assert_true(ns_march_counts(m)->events == 6);
    ns_march_free(m);
    ns_system_free(s);
    return error;
}

static void order_holds_across_events(void **state) {
    (void)state;
    const double e1 = bridge_error(1, 1, 1e-6), e2 = bridge_error(1, 1, 0.5e-6);
    const double t1 = bridge_error(0.5, 0.5, 4e-6), t2 = bridge_error(0.5, 0.5, 2e-6);
    print_message("theta 1: %.2e V, order %.3f; theta = gamma = 1/2: %.2e V, order %.3f\n", e2, log2(e1 / e2),
                  t2, log2(t1 / t2));
    assert_true(fabs(log2(e1 / e2) - 1) < 0.05);
    assert_true(fabs(log2(t1 / t2) - 2) < 0.05);
}

/* v(t) = 0 first where tan(w t) = w/a. */
static void the_first_commutation_is_found(void **state) {
    (void)state;
    const double a = 500, w = sqrt(1e8 - a * a), first = atan2(w, a) / w;
    ns_system *s = system_lc_bridge();
    ns_march *m = marcher(s, 0.5, 0.5, 1e-8);
    const double w0[2] = {1e-6 * 10, 0};
    double left, right;
    assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
    assert_int_equal(ns_march_try(m, 5e-3, NS_TO_EVENT, &left), NS_OK);
    assert_true(ns_march_at_event(m));
    assert_true(fabs(left - first) < 2e-13); /* phase error: h^2 w^2 / 12 = 8e-10 of 152 us is 1.3e-13 s */
    assert_int_equal(ns_march_accept(m), NS_OK);
    const double before = unknown(m, 0);
    assert_int_equal(ns_march_try(m, 5e-3, NS_TO_EVENT, &right), NS_OK);
    assert_false(ns_march_at_event(m));
    assert_true(right > left && right < left + 1e-13);
    assert_true(fabs(before) < 1e-8 && before >= -1e-12 && unknown(m, 0) < before);
    ns_march_free(m);
    ns_system_free(s);
}

/* Purely algebraic: conducts from 0 to T/2, blocks from T/2 to T, exactly. */
static void a_rectifier_commutates_with_its_source(void **state) {
    (void)state;
    ns_system *s = system_half_wave(10, 50, 5);
    ns_march *m = marcher(s, 1, 1, 1e-4);
    const double w0[3] = {0};
    assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
    for (int k = 1; k <= 8; k++) {
        double left, right;
        assert_int_equal(ns_march_try(m, 1, NS_TO_EVENT, &left), NS_OK);
        assert_int_equal(ns_march_accept(m), NS_OK);
        assert_true(fabs(left - k * 0.01) < 1e-4 / (1 << 19)); /* events are located to h 2^-20 */
        assert_int_equal(ns_march_try(m, 1, NS_TO_EVENT, &right), NS_OK);
        assert_int_equal(ns_march_accept(m), NS_OK);
        const double middle = k * 0.01 + 0.005, source = 10 * sin(100 * pi * middle);
        go(m, middle);
        assert_true(fabs(unknown(m, 0) - source) < 1e-12);
        assert_true(fabs(unknown(m, 1) - fmax(source, 0)) < 1e-12);
    }
    ns_march_free(m);
    ns_system_free(s);
}

/* --- jumps --- */

/* 1 uF at 10 V onto 3 uF at 2 V: (10 + 6)/4 = 4 V; energy 50 + 6 = 56 uJ falls to 32 uJ. */
static void a_capacitor_closed_onto_another_keeps_the_charge(void **state) {
    (void)state;
    bench b = open_bench();
    assert_int_equal(ns_circuit_capacitor(b.c, "c1", 1, 0, 1e-6, 10, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c2", 2, 0, 3e-6, 2, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(b.c, "s1", 1, 2, 3, 0, &ideal_switch, NULL), NS_OK);
    add_step(&b, "vg", 3, 0, 0, 1, 1e-3);
    build(&b, 1e-5);
    start_at_rest(&b);
    double left, right;
    assert_int_equal(ns_march_try(b.m, 2e-3, NS_TO_EVENT, &left), NS_OK);
    assert_true(left == 1e-3);
    assert_int_equal(ns_march_accept(b.m), NS_OK);
    assert_true(fabs(v_of(&b, 1) - 10) < 1e-12 && fabs(v_of(&b, 2) - 2) < 1e-12);
    assert_int_equal(ns_march_try(b.m, 2e-3, NS_TO_EVENT, &right), NS_OK);
    assert_int_equal(ns_march_accept(b.m), NS_OK);
    assert_true(fabs(v_of(&b, 1) / 4 - 1) < 1e-12 && fabs(v_of(&b, 2) / 4 - 1) < 1e-12);
    go(b.m, 2e-3);
    assert_true(fabs(v_of(&b, 1) / 4 - 1) < 1e-12);
    close_bench(&b);
}

/* 2 A in 1 mH, interrupted into 3 mH that is at rest: flux 2 mWb in 4 mH, 0.5 A in both. */
static void an_interrupted_inductor_keeps_the_flux(void **state) {
    (void)state;
    bench b = open_bench();
    int l1, l2;
    assert_int_equal(ns_circuit_inductor(b.c, "l1", 0, 1, 1e-3, 2, &l1), NS_OK);
    assert_int_equal(ns_circuit_inductor(b.c, "l2", 1, 0, 3e-3, 0, &l2), NS_OK);
    assert_int_equal(ns_circuit_switch(b.c, "s1", 1, 0, 3, 0, &ideal_switch, NULL), NS_OK);
    add_step(&b, "vg", 3, 0, 1, 0, 1e-3);
    build(&b, 1e-5);
    start_at_rest(&b);
    go(b.m, 0.9e-3);
    assert_true(fabs(i_of(&b, l1) - 2) < 1e-12 && fabs(i_of(&b, l2)) < 1e-12);
    go(b.m, 1.1e-3);
    assert_true(fabs(i_of(&b, l1) / 0.5 - 1) < 1e-12 && fabs(i_of(&b, l2) / 0.5 - 1) < 1e-12);
    close_bench(&b);
}

/* The start of the literature's bridge with filter: 1 uF at 10 V onto 0.3 uF through two diodes: 10/1.3 V. */
static void an_inconsistent_start_jumps(void **state) {
    (void)state;
    bench b = open_bench();
    assert_int_equal(ns_circuit_capacitor(b.c, "c", 1, 2, 1e-6, 10, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(b.c, "l", 1, 2, 1e-2, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(b.c, "d1", 1, 3, &ideal_diode, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(b.c, "d2", 2, 3, &ideal_diode, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(b.c, "d3", 0, 1, &ideal_diode, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(b.c, "d4", 0, 2, &ideal_diode, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "cf", 3, 0, 0.3e-6, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 3, 0, 1e3, NULL), NS_OK);
    build(&b, 1e-6);
    start_at_rest(&b);
    assert_true(fabs(v_of(&b, 1) - v_of(&b, 2) - 10 / 1.3) < 1e-12 * 10);
    assert_true(fabs(v_of(&b, 3) - 10 / 1.3) < 1e-12 * 10);
    go(b.m, 5e-3);
    close_bench(&b);
}

/* --- commands --- */

/* A ramp 0 -> 1 V from 0 to 1 ms crosses 0.5 V at 0.5 ms; a sine 0.6 sin(2 pi 1k t) at asin(5/6)/(2 pi 1k).
 */
static void time_driven_switches_switch_exactly(void **state) {
    (void)state;
    for (int sine = 0; sine < 2; sine++) {
        bench b = open_bench();
        ns_signal g = {.kind = sine ? NS_SIN : NS_PULSE};
        if (sine) {
            g.u.sin.va = 0.6;
            g.u.sin.freq = 1e3;
        } else {
            g.u.pulse.v2 = 1;
            g.u.pulse.tr = 1e-3;
            g.u.pulse.pw = 1;
            g.u.pulse.per = INFINITY;
        }
        assert_int_equal(ns_circuit_source(b.c, "vg", NS_VOLTAGE, 3, 0, &g, NULL), NS_OK);
        add_dc(&b, "vin", 1, 0, 12, NULL);
        assert_int_equal(ns_circuit_switch(b.c, "s1", 1, 2, 3, 0, &ideal_switch, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(b.c, "r", 2, 0, 10, NULL), NS_OK);
        build(&b, 3.3e-5); /* no multiple of it is the instant */
        start_at_rest(&b);
        const double instant = sine ? asin(5.0 / 6) / (2000 * pi) : 0.5e-3;
        double left, right;
        assert_int_equal(ns_march_try(b.m, 1e-3, NS_TO_EVENT, &left), NS_OK);
        assert_int_equal(ns_march_accept(b.m), NS_OK);
        assert_true(fabs(left / instant - 1) < 1e-15); /* a few ulps */
        assert_true(fabs(v_of(&b, 2)) < 1e-12);
        assert_int_equal(ns_march_try(b.m, 1e-3, NS_TO_EVENT, &right), NS_OK);
        assert_int_equal(ns_march_accept(b.m), NS_OK);
        assert_true(fabs(v_of(&b, 2) - 12) < 1e-12);
        close_bench(&b);
    }
}

/* A relaxation oscillator: C charged through R from 1 V; a switch on its own voltage, closed above 0.6, open
 * below 0.4 V, discharges it through r.  Charging from 0.4 to 0.6: RC ln(0.6/0.4); with R = r = 1k the closed
 * target is 0.5 V at half the time constant: never below 0.4; so use r = 100: target 1/11 V, tau = RC/11:
 * (RC/11) ln((0.6 - 1/11)/(0.4 - 1/11)). */
static void state_driven_switches_switch_where_they_should(void **state) {
    (void)state;
    bench b = open_bench();
    const ns_switch s = {0.5, 0.1, 0, INFINITY};
    add_dc(&b, "vin", 1, 0, 1, NULL);
    assert_int_equal(ns_circuit_resistor(b.c, "r1", 1, 2, 1e3, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c", 2, 0, 1e-6, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(b.c, "s1", 2, 3, 2, 0, &s, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r2", 3, 0, 100, NULL), NS_OK);
    ns_circuit_system(b.c, &b.s);
    b.m = marcher(b.s, 0.5, 0.5, 1e-7);
    start_at_rest(&b);
    const double rc = 1e-3, up = rc * log(0.6 / 0.4), first = rc * log(1 / 0.4);
    const double down = rc / 11 * log((0.6 - 1.0 / 11) / (0.4 - 1.0 / 11));
    double expected = first;
    for (int k = 0; k < 6; k++) {
        double left, right;
        assert_int_equal(ns_march_try(b.m, 1, NS_TO_EVENT, &left), NS_OK);
        assert_int_equal(ns_march_accept(b.m), NS_OK);
        assert_true(fabs(left - expected) <
                    2e-11); /* three closed legs, h^2/(12 tau^2) 45 us = 4.6e-12 s each */
        assert_int_equal(ns_march_try(b.m, 1, NS_TO_EVENT, &right), NS_OK);
        assert_int_equal(ns_march_accept(b.m), NS_OK);
        expected += k % 2 ? up : down;
    }
    close_bench(&b);
}

/* No hysteresis, no capacitor at the control's threshold to cross slowly: a chopper that holds v(2) at 0.5 V
 * by switching infinitely often.  It must finish and stay near 0.5 V. */
static void chatter_ends(void **state) {
    (void)state;
    bench b = open_bench();
    const ns_switch s = {0.5, 0, 0, INFINITY};
    add_dc(&b, "vin", 1, 0, 1, NULL);
    assert_int_equal(ns_circuit_resistor(b.c, "r1", 1, 2, 1e3, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c", 2, 0, 1e-6, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(b.c, "s1", 2, 3, 2, 0, &s, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r2", 3, 0, 100, NULL), NS_OK);
    build(&b, 1e-6);
    start_at_rest(&b);
    go(b.m, 5e-3);
    assert_true(fabs(v_of(&b, 2) - 0.5) <
                0.01); /* a step of h/4 at full discharge: 5 mA / 1 uF 1 us = 5 mV */
    close_bench(&b);
}

/* --- trying and going back --- */

static void trials_leave_the_accepted_point_alone(void **state) {
    (void)state;
    ns_system *s = system_lc_bridge();
    ns_march *m = marcher(s, 1, 1, 1e-6), *straight = marcher(s, 1, 1, 1e-6);
    const double w0[2] = {1e-6 * 10, 0};
    double reached, x[2], y[2];
    assert_int_equal(ns_march_try(m, 1, NS_TO_TIME, &reached), NS_E_STATE);
    assert_int_equal(ns_march_start(m, 0, w0), NS_OK);
    assert_int_equal(ns_march_start(straight, 0, w0), NS_OK);
    for (int k = 1; k <= 50; k++) {
        const double t = k * 20e-6;
        assert_int_equal(ns_march_try(m, t + 333e-6, NS_TO_TIME, &reached), NS_OK);
        assert_int_equal(ns_march_try(m, t - 7e-6, NS_TO_TIME, &reached), NS_OK);
        assert_int_equal(ns_march_try(m, t + 1e-3, NS_TO_EVENT, &reached), NS_OK);
        go(m, t);
        go(straight, t);
        assert_int_equal(ns_march_read(m, NULL, x, NULL, NULL), NS_OK);
        assert_int_equal(ns_march_read(straight, NULL, y, NULL, NULL), NS_OK);
        assert_memory_equal(x, y, sizeof x);
    }
    assert_int_equal(ns_march_try(m, 50 * 20e-6, NS_TO_TIME, &reached),
                     NS_E_RANGE); /* not after the accepted point */
    assert_int_equal(ns_march_accept(m), NS_E_STATE);
    ns_march_free(m);
    ns_march_free(straight);
    ns_system_free(s);
}

static void every_allocation_may_fail(void **state) {
    (void)state;
    ns_system *s = system_lc_bridge();
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6};
    for (long k = 1;; k++) {
        ns_march *m;
        double reached;
        fail_alloc_at(k);
        int status = ns_march_create(s, &o, &m, NULL);
        if (status == NS_OK)
            status = ns_march_start_dc(m, 0, 0, NULL, NULL, NULL);
        if (status == NS_OK)
            status = ns_march_try(m, 4e-6, NS_TO_TIME, &reached);
        const long made = allocs_made();
        fail_alloc_off();
        ns_march_free(m);
        if (made < k)
            break;
        assert_int_equal(status, NS_E_MEMORY);
        assert_true(k < 1000);
    }
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(order_holds_across_events),
        cmocka_unit_test(the_first_commutation_is_found),
        cmocka_unit_test(a_rectifier_commutates_with_its_source),
        cmocka_unit_test(a_capacitor_closed_onto_another_keeps_the_charge),
        cmocka_unit_test(an_interrupted_inductor_keeps_the_flux),
        cmocka_unit_test(an_inconsistent_start_jumps),
        cmocka_unit_test(time_driven_switches_switch_exactly),
        cmocka_unit_test(state_driven_switches_switch_where_they_should),
        cmocka_unit_test(chatter_ends),
        cmocka_unit_test(trials_leave_the_accepted_point_alone),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
