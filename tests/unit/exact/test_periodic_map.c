/* tests/unit/exact/test_periodic_map.c - periods of a drive by one product each: as right as event by event,
 * and told.
 *
 * Flown to events (NS_TO_EVENT) nothing is taken together: what that gives is expected of NS_TO_TIME, to
 * rounding, with events and changes of mode counted the same.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "periods.h"

static const double vin = 24;

/* A buck from vin, 100 kHz, from rest: gate on node 4, output on 3; with a diode or another switch; its
 * output is held below `most`. */
static void clamped_buck(scene *z, int diode, double load, ns_signal gate, ns_signal in, size_t bytes,
                         double most) {
    const ns_switch contact = {0.5, 0, 0, INFINITY}, other = {-0.5, 0, 0, INFINITY};
    const ns_diode ideal = {0, 0, INFINITY, INFINITY, 0};
    assert_int_equal(ns_circuit_create(&z->c), NS_OK);
    put(z, "in", 1, 0, in);
    put(z, "gate", 4, 0, gate);
    assert_int_equal(ns_circuit_switch(z->c, "s1", 1, 2, 4, 0, &contact, NULL), NS_OK);
    assert_int_equal(diode ? ns_circuit_diode(z->c, "d", 0, 2, &ideal, NULL)
                           : ns_circuit_switch(z->c, "s2", 2, 0, 0, 4, &other, NULL),
                     NS_OK);
    assert_int_equal(ns_circuit_inductor(z->c, "l", 2, 3, 100e-6, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(z->c, "c", 3, 0, 22e-6, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(z->c, "r", 3, 0, load, NULL), NS_OK);
    if (isfinite(most)) {
        put(z, "most", 5, 0, dc(most));
        assert_int_equal(ns_circuit_diode(z->c, "d5", 3, 6, &ideal, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(z->c, "r5", 6, 5, 10, NULL), NS_OK);
    }
    begin(z, bytes);
    z->watched = ns_circuit_node_unknown(z->c, 3);
}

static void buck(scene *z, int diode, double load, ns_signal gate, ns_signal in, size_t bytes) {
    clamped_buck(z, diode, load, gate, in, bytes, INFINITY);
}

/* Steps that whole periods made in the place of others. */
static long saved;

/* Both ways to t, in `parts`; the laps that there were. */
static long laps_of(scene *a, scene *b, double t, int parts) {
    double most = 0;
    for (int i = 1; i <= parts; i++) {
        go(a, t * i / parts, NS_TO_TIME);
        go(b, t * i / parts, NS_TO_EVENT);
        most = fmax(most, fabs(value(b)));
        assert_true(fabs(value(a) - value(b)) <= 1e-12 * most);
    }
    assert_int_equal(ns_march_counts(b->m)->periods, 0);
    saved = ns_march_counts(b->m)->steps - ns_march_counts(a->m)->steps;
    return ns_march_counts(a->m)->periods;
}

static long compare(scene *a, scene *b, double t, int parts) {
    const long laps = laps_of(a, b, t, parts);
    assert_int_equal(ns_march_counts(a->m)->events, ns_march_counts(b->m)->events);
    end(a);
    end(b);
    return laps;
}

/* 200 periods; in each of seven parts some are flown until two in a row were alike. */
static void a_converter_without_diodes(void **state) {
    (void)state;
    scene a, b;
    buck(&a, 0, 5, square(1, period), dc(vin), 0);
    buck(&b, 0, 5, square(1, period), dc(vin), 0);
    const long laps = compare(&a, &b, 200.3 * period, 7);
    assert_in_range(laps, 150, 197);
    assert_true(saved > 100);
}

/* No period of the gate is like the one before where a sine, or what an exponential has begun, goes on. */
static void waves_that_go_on(void **state) {
    (void)state;
    scene a, b;
    ns_signal sine = {.kind = NS_SIN}, rise = {.kind = NS_EXP};
    sine.u.sin.vo = rise.u.exp.v1 = vin;
    sine.u.sin.va = 1;
    sine.u.sin.freq = 173;
    rise.u.exp.v2 = vin / 2;
    rise.u.exp.tau1 = rise.u.exp.tau2 = 1e-3;
    rise.u.exp.td2 = 1e-4;
    buck(&a, 1, 5, square(1, period), sine, 0);
    buck(&b, 1, 5, square(1, period), sine, 0);
    assert_int_equal(compare(&a, &b, 600.3 * period, 2), 0);
    buck(&a, 1, 5, square(1, period), rise, 0);
    buck(&b, 1, 5, square(1, period), rise, 0);
    assert_int_equal(compare(&a, &b, 600.3 * period, 2), 0);
}

static void guards_are_looked_at(void **state) {
    (void)state;
    scene a, b;
    buck(&a, 1, 5, square(1, period), dc(vin), 0);
    buck(&b, 1, 5, square(1, period), dc(vin), 0);
    assert_in_range(compare(&a, &b, 200.3 * period, 1), 180, 197);
    assert_true(saved > 150);
}

/* From rest the current overshoots and rings, down to zero after some 20 periods, and never stops later. */
static void a_guard_that_comes_near(void **state) {
    (void)state;
    scene a, b;
    buck(&a, 1, 20, square(1, period), dc(vin), 0);
    buck(&b, 1, 20, square(1, period), dc(vin), 0);
    assert_in_range(compare(&a, &b, 600.3 * period, 1), 200, 597);
}

/* The current of a buck with a light load stops in each period, each time at another instant. */
static void events_that_are_found(void **state) {
    (void)state;
    scene a, b;
    buck(&a, 1, 200, square(1, period), dc(vin), 0);
    buck(&b, 1, 200, square(1, period), dc(vin), 0);
    assert_in_range(compare(&a, &b, 600.3 * period, 1), 400, 597);
}

/* As it rises from one period to the next the output comes to where it is held, wherever in a period it is
 * highest then: not one period beyond. */
static void events_that_were_not_there_before(void **state) {
    (void)state;
    for (int most = 2; most < 18; most++) {
        scene a, b;
        clamped_buck(&a, 1, 200, square(1, period), dc(vin), 0, most + 0.3);
        clamped_buck(&b, 1, 200, square(1, period), dc(vin), 0, most + 0.3);
        (void)compare(&a, &b, 600.3 * period, 60);
    }
}

/* A buck whose output is drawn above its input: from then on the current flows back, and when the switch
 * opens it goes on through a diode to 30 V in place of the other one. */
static void drawn_up(scene *z) {
    const ns_diode ideal = {0, 0, INFINITY, INFINITY, 0};
    const ns_switch contact = {0.5, 0, 0, INFINITY};
    assert_int_equal(ns_circuit_create(&z->c), NS_OK);
    put(z, "in", 1, 0, dc(vin));
    put(z, "gate", 4, 0, square(1, period));
    put(z, "up", 5, 0, dc(60));
    put(z, "back", 6, 0, dc(30));
    assert_int_equal(ns_circuit_switch(z->c, "s1", 1, 2, 4, 0, &contact, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(z->c, "d1", 0, 2, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(z->c, "d2", 2, 6, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(z->c, "l", 2, 3, 100e-6, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(z->c, "c", 3, 0, 22e-6, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(z->c, "r", 3, 0, 160, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(z->c, "r5", 5, 3, 200, NULL), NS_OK);
    begin(z, 0);
    z->watched = ns_circuit_node_unknown(z->c, 3);
}

static void modes_that_do_not_follow_again(void **state) {
    (void)state;
    scene a, b;
    drawn_up(&a);
    drawn_up(&b);
    assert_in_range(compare(&a, &b, 600.3 * period, 1), 200, 597);
}

/* Once a period a ramp comes down to 5 V, in edges of its own; a capacitor that is charged through 1 kohm
 * in a millisecond is drawn down with it from then on. */
static void dips(scene *z, double light) {
    const ns_diode ideal = {0, 0, INFINITY, INFINITY, 0};
    ns_signal ramp = {.kind = NS_PULSE};
    ramp.u.pulse.v1 = 12;
    ramp.u.pulse.v2 = 5;
    ramp.u.pulse.td = 1e-6;
    ramp.u.pulse.tr = ramp.u.pulse.tf = 1.5e-6;
    ramp.u.pulse.pw = 10e-9;
    ramp.u.pulse.per = period;
    assert_int_equal(ns_circuit_create(&z->c), NS_OK);
    put(z, "up", 1, 0, dc(10));
    put(z, "ramp", 2, 0, ramp);
    put(z, "square", 5, 0, square(10, period));
    assert_int_equal(ns_circuit_resistor(z->c, "r", 1, 3, 1000, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(z->c, "c", 3, 0, 1e-6, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(z->c, "d", 3, 4, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(z->c, "rd", 4, 2, 10, NULL), NS_OK);
    /* another current, which stops in each period from the first on, of the same island */
    assert_int_equal(ns_circuit_resistor(z->c, "r37", 3, 7, 1e5, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(z->c, "d5", 5, 6, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(z->c, "l", 6, 7, 10e-6, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(z->c, "c7", 7, 0, 1e-6, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(z->c, "r7", 7, 0, light, NULL), NS_OK);
    begin(z, 0);
    z->watched = ns_circuit_node_unknown(z->c, 3);
}

static void ramps_and_excursions(void **state) {
    (void)state;
    for (int k = 0; k < 8; k++) {
        scene a, b;
        dips(&a, 20 + 5 * k);
        dips(&b, 20 + 5 * k);
        assert_in_range(compare(&a, &b, 300.3 * period, 1), 100, 297);
    }
}

/* A source of three fifths of the period (ratio 5/3) does not repeat with it; one of a third does. */
static void only_common_periods(void **state) {
    (void)state;
    for (int third = 0; third < 2; third++) {
        const double every = third ? 30e-6 / 3 : 6e-6;
        scene a, b;
        buck(&a, 0, 5, square(1, third ? 30e-6 : period), square(vin, every), 0);
        buck(&b, 0, 5, square(1, third ? 30e-6 : period), square(vin, every), 0);
        const long laps = compare(&a, &b, 150.3 * period, 1);
        assert_in_range(laps, third ? 40 : 0, third ? 49 : 0);
    }
}

/* vin falls to its half within 1 us at 30 periods: no two of them are alike for ever before, all are later.
 * What was seen of them in a trial that was not accepted is not believed where the march stands then. */
static void a_period_that_only_comes(void **state) {
    (void)state;
    const double at[] = {0, 30 * period, 30 * period + 1e-6}, volts[] = {vin, vin, vin / 2};
    ns_signal in = {.kind = NS_PWL};
    in.u.pwl.n = 3;
    in.u.pwl.t = at;
    in.u.pwl.v = volts;
    in.u.pwl.repeat = NAN;
    scene a, b;
    double reached;
    buck(&a, 0, 5, square(1, period), in, 0);
    buck(&b, 0, 5, square(1, period), in, 0);
    assert_int_equal(ns_march_try(a.m, 31.7 * period, NS_TO_TIME, &reached), NS_OK);
    go(&a, 29.3 * period, NS_TO_TIME);
    assert_int_equal(ns_march_counts(a.m)->periods, 0);
    go(&a, 60.3 * period, NS_TO_TIME);
    assert_in_range(ns_march_counts(a.m)->periods, 20, 29);
    go(&b, 60.3 * period, NS_TO_EVENT);
    assert_true(fabs(value(&a) - value(&b)) <= 1e-12 * vin);
    end(&a);
    end(&b);
}

/* 1 ohm, 10 uH at a square wave with edges of no time: w(t) by hand.  In steady state the current is
 * I tanh(T/4 tau) off its mean at the ends of each half, I = V/2R. */
static void inputs_that_jump(void **state) {
    (void)state;
    const double tau = 10e-6, half = period / 2, v = 10;
    ns_signal s = square(v, period);
    s.u.pulse.tr = s.u.pulse.tf = 0;
    s.u.pulse.pw = half;
    scene z;
    int coil;
    assert_int_equal(ns_circuit_create(&z.c), NS_OK);
    put(&z, "v", 1, 0, s);
    assert_int_equal(ns_circuit_resistor(z.c, "r", 1, 2, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(z.c, "l", 2, 0, 10e-6, NAN, &coil), NS_OK);
    begin(&z, 0);
    z.watched = ns_circuit_current_unknown(z.c, coil);
    go(&z, 1000 * period, NS_TO_TIME);
    assert_in_range(ns_march_counts(z.m)->periods, 990, 998);
    const double low = v / 2 * (1 - tanh(half / (2 * tau)));
    assert_true(fabs(value(&z) - low) < 1e-13 * v); /* 1000 periods: gone since long */
    end(&z);
}

/* 1 mH, 1 uF at a square wave, nothing lost, from 1000 s on: t rounds by 1.1e-13 s in each period, in the
 * same way.  Legs of one length are told apart by 4 eps t, so that both ways are as good as 1e-12 s, which
 * the ring turns by 3e-8 in; not told of, rounding would come to 1e-9 s in 10,000 periods. */
static void far_from_zero(void **state) {
    (void)state;
    scene z[2];
    double w0[MOST] = {0}, v[2];
    for (int i = 0; i < 2; i++) {
        assert_int_equal(ns_circuit_create(&z[i].c), NS_OK);
        put(&z[i], "v", 1, 0, square(10, period));
        assert_int_equal(ns_circuit_inductor(z[i].c, "l", 1, 2, 1e-3, NAN, NULL), NS_OK);
        assert_int_equal(ns_circuit_capacitor(z[i].c, "c", 2, 0, 1e-6, NAN, NULL), NS_OK);
        begin(&z[i], 0);
        z[i].watched = ns_circuit_node_unknown(z[i].c, 2);
        assert_int_equal(ns_march_start(z[i].m, 1000, w0), NS_OK);
        go(&z[i], 1000.1, i ? NS_TO_EVENT : NS_TO_TIME);
        v[i] = value(&z[i]);
    }
    assert_true(ns_march_counts(z[0].m)->periods > 5000);
    assert_true(fabs(v[0] - v[1]) < 1e-6 * 10);
    end(&z[0]);
    end(&z[1]);
}

/* With hardly any memory legs and modes are dropped again and again. */
static void little_memory(void **state) {
    (void)state;
    scene a, b;
    buck(&a, 1, 5, square(1, period), dc(vin), 4096);
    buck(&b, 1, 5, square(1, period), dc(vin), 4096);
    (void)compare(&a, &b, 100.3 * period, 3);
}

/* Started anew at another time, and far from zero. */
static void started_again(void **state) {
    (void)state;
    scene a, b;
    double w0[MOST] = {0};
    buck(&a, 1, 5, square(1, period), dc(vin), 0);
    buck(&b, 1, 5, square(1, period), dc(vin), 0);
    go(&a, 50 * period, NS_TO_TIME);
    assert_int_equal(ns_march_start(a.m, 3.3e-6, w0), NS_OK);
    assert_int_equal(ns_march_start(b.m, 3.3e-6, w0), NS_OK);
    go(&a, 1e5 * period, NS_TO_TIME);
    go(&b, 1e5 * period, NS_TO_EVENT);
    assert_true(fabs(value(&a) - value(&b)) <= 1e-12 * vin);
    end(&a);
    end(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_converter_without_diodes),
        cmocka_unit_test(waves_that_go_on),
        cmocka_unit_test(guards_are_looked_at),
        cmocka_unit_test(a_guard_that_comes_near),
        cmocka_unit_test(events_that_are_found),
        cmocka_unit_test(events_that_were_not_there_before),
        cmocka_unit_test(modes_that_do_not_follow_again),
        cmocka_unit_test(ramps_and_excursions),
        cmocka_unit_test(only_common_periods),
        cmocka_unit_test(a_period_that_only_comes),
        cmocka_unit_test(inputs_that_jump),
        cmocka_unit_test(far_from_zero),
        cmocka_unit_test(little_memory),
        cmocka_unit_test(started_again),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
