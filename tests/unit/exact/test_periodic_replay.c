/* tests/unit/exact/test_periodic_replay.c - periods flown as the one before: each proof of it has a circuit
 * that is wrong without.
 *
 * Flown to events (NS_TO_EVENT) nothing is flown again: what that gives is expected of NS_TO_TIME.
 */
#include "periods.h"

static const ns_diode ideal = {0, 0, INFINITY, INFINITY, 0};

static void resistor(scene *z, const char *name, int p, int n, double ohms) {
    assert_int_equal(ns_circuit_resistor(z->c, name, p, n, ohms, NULL), NS_OK);
}

static void capacitor(scene *z, const char *name, int p, double farads, double volts) {
    assert_int_equal(ns_circuit_capacitor(z->c, name, p, 0, farads, volts, NULL), NS_OK);
}

static void diode(scene *z, const char *name, int p, int n) {
    assert_int_equal(ns_circuit_diode(z->c, name, p, n, &ideal, NULL), NS_OK);
}

static void contact(scene *z, const char *name, int p, int n, int control, double vt, double vh) {
    const ns_switch of = {vt, vh, 0, INFINITY};
    assert_int_equal(ns_circuit_switch(z->c, name, p, n, control, 0, &of, NULL), NS_OK);
}

/* 0.1 uF at node 4, charged and discharged in each period.  The clamp there comes down, until it is met just
 * before the switch opens: that is an event more, not the switch's. */
static void clamp_that_comes_down(scene *z, double load) {
    put(z, "in", 1, 0, dc(10));
    put(z, "gate", 2, 0, square(1, period));
    contact(z, "s", 1, 3, 2, 0.5, 0);
    resistor(z, "r", 3, 4, 100);
    capacitor(z, "c", 4, 1e-7, NAN);
    resistor(z, "load", 4, 0, load);
    diode(z, "clamp", 4, 5);
    capacitor(z, "most", 5, 1e-5, 9);
    resistor(z, "down", 5, 0, 100);
    /* a diode that stops in each period, so that periods are flown */
    resistor(z, "r6", 4, 6, 1e3);
    diode(z, "d", 7, 6);
    put(z, "ramp", 7, 0, pulse(5, -5, 1e-6, 1e-6, 1e-6, 3e-6, period));
}

/* When the switch closes, the charge of node 2 jumps to node 3 through the diode; from when on the supply at
 * node 1 has fallen below, it would have to jump back. */
static void charge_that_does_not_jump_back(scene *z, double ohms) {
    capacitor(z, "supply", 1, 1e-4, 8);
    resistor(z, "falls", 1, 0, 5);
    resistor(z, "r", 1, 2, ohms);
    capacitor(z, "c2", 2, 1e-6, 8);
    diode(z, "d", 2, 4);
    put(z, "gate", 5, 0, square(1, period));
    contact(z, "s", 4, 3, 5, 0.5, 0);
    capacitor(z, "c3", 3, 1e-6, 7);
    contact(z, "s3", 3, 6, 5, 0.5, 0);
    put(z, "low", 7, 0, dc(5));
    resistor(z, "load", 6, 7, 10);
}

/* Two switches with a hysteresis of which now one, now the other is the first. */
static void switches_that_change_places(scene *z, double threshold) {
    put(z, "ramp", 2, 0, pulse(0, 10, 0, period / 2, period / 2 - 1e-9, 1e-9, period));
    resistor(z, "r2", 2, 3, 1000);
    capacitor(z, "c3", 3, 1e-9, NAN);
    capacitor(z, "drift", 1, 1e-4, 8);
    resistor(z, "falls", 1, 0, 3);
    resistor(z, "r1", 1, 8, 1e4);
    resistor(z, "r3", 3, 8, 1e4);
    put(z, "in", 9, 0, dc(10));
    resistor(z, "r4", 9, 4, 100);
    resistor(z, "r5", 9, 5, 100);
    capacitor(z, "c4", 4, 1e-8, NAN);
    capacitor(z, "c5", 5, 1e-8, NAN);
    resistor(z, "r45", 4, 5, 1000);
    resistor(z, "r43", 4, 3, 1e5);
    contact(z, "s4", 4, 6, 8, threshold, 0.5);
    resistor(z, "r6", 6, 0, 100);
    contact(z, "s5", 5, 7, 3, 5, 0.5);
    resistor(z, "r7", 7, 0, 50);
}

/* 2 uF, charged by a source of 14 to 24 V, give their charge in a rush of some 50 ns when the switch closes:
 * what is fast is over soon after each event, and must be resolved there. */
static void charge_in_a_rush(scene *z, double ohms) {
    put(z, "in", 1, 0, pulse(14, 24, 1e-6, 0.5e-6, 1e-6, 4e-6, period));
    resistor(z, "r", 1, 2, 1);
    capacitor(z, "c2", 2, 2e-6, 16);
    diode(z, "d", 2, 4);
    resistor(z, "rush", 4, 5, ohms);
    put(z, "gate", 6, 0, pulse(0, 1, 7e-6, 0.3e-6, 0.3e-6, 6.5e-6, period));
    contact(z, "s", 5, 3, 6, 0.5, 0);
    capacitor(z, "c3", 3, 70e-6, NAN);
    resistor(z, "load", 3, 0, 1400);
}

/* An edge turns where no mode changes: asked for just before it, the march stands on its left side. */
static void edges_without_events(scene *z, double most) {
    put(z, "edges", 1, 0, pulse(0, 10, 0, 0.3 * period, 0.3 * period, 0.1 * period, period));
    resistor(z, "r", 1, 2, 100);
    capacitor(z, "c", 2, 1e-8, NAN);
    diode(z, "d", 2, 3);
    put(z, "most", 3, 0, dc(most));
    resistor(z, "r2", 2, 4, 200);
    assert_int_equal(ns_circuit_inductor(z->c, "l", 4, 0, 1e-3, NAN, NULL), NS_OK);
}

typedef void make(scene *z, double value);

static void begin_of(scene *z, make *of, double value) {
    assert_int_equal(ns_circuit_create(&z->c), NS_OK);
    of(z, value);
    begin(z, 0);
}

/* All unknowns, both ways to t; *most: the largest so far. */
static void same_at(scene *a, scene *b, double t, double *most) {
    double x[MOST], y[MOST];
    go(a, t, NS_TO_TIME);
    go(b, t, NS_TO_EVENT);
    assert_int_equal(ns_march_read(a->m, NULL, x, NULL, NULL), NS_OK);
    assert_int_equal(ns_march_read(b->m, NULL, y, NULL, NULL), NS_OK);
    for (int k = 0; k < a->s->n; k++)
        *most = fmax(*most, fabs(y[k]));
    for (int k = 0; k < a->s->n; k++)
        assert_true(fabs(x[k] - y[k]) <= 1e-11 * *most);
}

/* Every five periods and `phase` of one, a hair before that, and two periods later. */
static void same_both_ways(make *of, double with, double phase) {
    scene a, b;
    double most = 0;
    begin_of(&a, of, with);
    begin_of(&b, of, with);
    for (int i = 1; i <= 60; i++) {
        const double t = (5 * i + phase) * period * (1 - 5e-16);
        same_at(&a, &b, t, &most);
        same_at(&a, &b, t + 2.1 * period, &most);
    }
    assert_int_equal(ns_march_counts(a.m)->events, ns_march_counts(b.m)->events);
    end(&a);
    end(&b);
}

static void an_event_more(void **state) {
    (void)state;
    for (int k = 0; k < 4; k++)
        same_both_ways(clamp_that_comes_down, 1100 + 300 * k, 0.3);
}

static void a_jump_is_asked(void **state) {
    (void)state;
    for (int k = 0; k < 4; k++)
        same_both_ways(charge_that_does_not_jump_back, 2 + 25 * k, 0.3);
}

static void commands_by_the_state(void **state) {
    (void)state;
    for (int k = 0; k < 4; k++)
        same_both_ways(switches_that_change_places, 3 + k, 0.3);
}

static void what_is_fast_after_an_event(void **state) {
    (void)state;
    for (int k = 0; k < 4; k++)
        same_both_ways(charge_in_a_rush, 0.01 * (1 + k), 0.3);
}

static void on_the_left_side(void **state) {
    (void)state;
    const double phase[] = {0, 0.3, 0.4, 0.7};
    for (int k = 0; k < 4; k++)
        same_both_ways(edges_without_events, 6, phase[k]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_event_more),         cmocka_unit_test(a_jump_is_asked),
        cmocka_unit_test(commands_by_the_state), cmocka_unit_test(what_is_fast_after_an_event),
        cmocka_unit_test(on_the_left_side),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
