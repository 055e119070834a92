/* tests/unit/reinit/test_jump.c - whether short steps showed a jump, and what is put in their place: charges
 * by hand.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "net.h"
#include "reinit/jump.h"

static const double pi = 3.14159265358979323846;
static const double longest = 1e-6; /* s: the engine's longest step */

typedef struct event {
    net k;
    ns_jump j;
    ns_clock now;
    double z[NET_MOST];
} event;

static void step_by(event *e, double h) {
    ns_theta *s = e->k.step;
    const double t = e->now.t + h;
    ns_system_inputs(e->k.s, t, NS_RIGHT, e->z);
    assert_int_equal(ns_theta_try(s, h, e->z, 1, NS_RESOLVE), NS_OK);
    assert_int_equal(ns_theta_accept(s), NS_OK);
    ns_clock_advance(&e->now, t, h);
}

/* Two short steps of length h from where the circuit is, and what they show: how many jumps were taken. */
static long two_steps(event *e, double h) {
    ns_theta *s = e->k.step;
    const long before = e->j.jumps;
    ns_reinit_jump_begin(&e->j, s, e->now);
    step_by(e, h);
    ns_reinit_jump_last_step(&e->j, s, e->now.t);
    step_by(e, h);
    assert_int_equal(ns_reinit_jump_commit(&e->j, s, longest, &e->now, e->z), NS_OK);
    assert_int_equal(e->j.refused, 0);
    return e->j.jumps - before;
}

static void ready(event *e) {
    net_prepare(&e->k);
    assert_int_equal(ns_reinit_jump_create(e->k.step, &e->j), NS_OK);
}

static void leave(event *e) {
    ns_reinit_jump_free(&e->j);
    net_end(&e->k);
}

/* 1 nF at 3 V beside 2 nF at v, joined by a closed switch and so many ohm; beside them 1 F at `rest` V. */
static event two_capacitors(double v, double ohm, double rest) {
    event e = {.k = net_begin()};
    net_capacitor(&e.k, "c1", 1, 0, 1e-9, 3);
    net_capacitor(&e.k, "c2", 2, 0, 2e-9, v);
    net_contact(&e.k, "s", 1, ohm > 0 ? 3 : 2, 1);
    if (ohm > 0)
        net_resistor(&e.k, "r", 3, 2, ohm);
    net_capacitor(&e.k, "c3", 4, 0, 1, rest);
    ready(&e);
    return e;
}

static double voltage(event *e, int node) {
    double x[2 * NET_MOST];
    assert_int_equal(ns_theta_read(e->k.step, x, x + NET_MOST, NULL), NS_OK);
    return net_voltage_of(&e->k, x, node);
}

/* 3 nC on 3 nF: 1 V each, 2 nC through the switch, in no time. */
static void charges_are_shared(void **state) {
    event e = two_capacitors(0, 0, 0);
    (void)state;
    assert_int_equal(two_steps(&e, 1e-12), 1);
    assert_true(e.now.t == 0 && e.now.lost == 0);
    assert_true(fabs(voltage(&e, 1) - 1) < 1e-14 && fabs(voltage(&e, 2) - 1) < 1e-14);
    assert_true(fabs(fabs(e.j.to.Lambda[0]) - 2e-9) < 1e-22);
    assert_int_equal(two_steps(&e, 1e-12), 0); /* once more nothing jumps, and the steps stay */
    assert_true(fabs(e.now.t - 2e-12) < 1e-26);
    leave(&e);
}

/* The same at 0.5 s, which 1e-17 s were lost on the way to. */
static void the_time_goes_back(void **state) {
    event e = two_capacitors(0, 0, 0);
    (void)state;
    e.now = (ns_clock){0.5, 1e-17};
    assert_int_equal(two_steps(&e, 1e-12), 1);
    assert_true(e.now.t == 0.5 && e.now.lost == 1e-17);
    leave(&e);
}

/* 10 ohm: 1 nF beside 2 nF take 6.7 ns.  A step of 1 ns moves much, and so do rates. */
static void what_takes_time_is_no_jump(void **state) {
    event e = two_capacitors(0, 10, 0);
    const double h[] = {1e-12, 1e-10, 1e-9};
    (void)state;
    for (int i = 0; i < 3; i++)
        assert_int_equal(two_steps(&e, h[i]), 0);
    assert_true(voltage(&e, 1) < 2.9 && voltage(&e, 1) > 2);
    leave(&e);
}

/* 1e-5 ohm: 6.7 fs are over within the first of two steps of 1 ns; after it nothing moves any more: a jump.
 */
static void a_short_transient_stays(void **state) {
    event e = two_capacitors(0, 1e-5, 0);
    (void)state;
    assert_int_equal(two_steps(&e, 1e-9), 0);
    assert_true(fabs(voltage(&e, 1) - 1) < 1e-4);
    leave(&e);
}

/* The rate before the steps counts: 3 V on 1 nF and 1 kohm fall by 1e-3 of 3 V each ns. */
static void rates_before_explain(void **state) {
    event e = {.k = net_begin()};
    (void)state;
    net_capacitor(&e.k, "c", 1, 0, 1e-9, 3);
    net_resistor(&e.k, "r", 1, 0, 1e3);
    ready(&e);
    step_by(&e, 1e-9);
    ns_reinit_jump_begin(&e.j, e.k.step, e.now);
    assert_true(fabs(e.j.rate[0] - 3e-12 / 1e-9 / (1 + 1e-3)) <
                1e-15); /* 3 mA after an Euler step of h/RC = 1e-3 */
    assert_int_equal(two_steps(&e, 1e-9), 0);
    assert_true(fabs(voltage(&e, 1) - 3 / pow(1 + 1e-3, 3)) < 1e-14);
    leave(&e);
}

/* Unlike by 1e-9 of 3 V they jump; by 1e-14, which is rounding, they do not. */
static void rounding_is_no_jump(void **state) {
    const double unlike[] = {1e-9, 1e-14};
    (void)state;
    for (int i = 0; i < 2; i++) {
        event e = two_capacitors(3 * (1 - unlike[i]), 0, 0);
        assert_int_equal(two_steps(&e, 1e-12), i == 0);
        leave(&e);
    }
}

/* Charges are compared in units of an energy's square root: 2 nC on 1 nF against 1e6 V on 1 F are 6e-11 of
 * it, and jump; against 1e9 V 6e-14: they do not matter. */
static void what_matters_beside_others(void **state) {
    const double rest[] = {1e6, 1e9};
    (void)state;
    for (int i = 0; i < 2; i++) {
        event e = two_capacitors(0, 0, rest[i]);
        assert_int_equal(two_steps(&e, 1e-12), i == 0);
        leave(&e);
    }
}

/* 1 nF from a source of 1 GV, or 1 V, to each of two nodes, at 0 and 0.1 mV; joined they share 0.1 pC. Beside
 * 2 C, which their charges are the difference of, that is rounding. */
static void what_matters_beside_its_terms(void **state) {
    const double volts[] = {1, 1e9};
    (void)state;
    for (int i = 0; i < 2; i++) {
        event e = {.k = net_begin()};
        net_voltage(&e.k, "v", 1, 0, volts[i]);
        net_capacitor(&e.k, "c1", 1, 2, 1e-9, 0);
        net_capacitor(&e.k, "c2", 1, 3, 1e-9, 1e-4);
        net_contact(&e.k, "s", 2, 3, 1);
        ready(&e);
        assert_int_equal(two_steps(&e, 1e-12), i == 0);
        leave(&e);
    }
}

/* A source across 1 nF, which is at 0 V: 1 V at t = 0 and rising.  On the right side of the jump its current
 * is C dv/dt, by the slope there: of a line to rounding, of a sine by two points 2^-14 and 2^-13 of the
 * longest step away. */
static void slopes_are_those_on_the_right(void **state) {
    static const double at[3] = {0, 1e-7, 3e-7}, volts[3] = {1, 3, 3};
    const ns_signal rising[2] = {
        {.kind = NS_PWL, .u.pwl = {.n = 3, .t = at, .v = volts, .repeat = NAN}},
        {.kind = NS_SIN, .u.sin = {.vo = 1, .va = 2, .freq = 1e5}},
    };
    const double slope[2] = {2e7, 2 * 2 * pi * 1e5}, off[2] = {1e-12, 1e-6};
    (void)state;
    for (int i = 0; i < 2; i++) {
        event e = {.k = net_begin()};
        int id;
        assert_int_equal(ns_circuit_source(e.k.c, "v", NS_VOLTAGE, 1, 0, &rising[i], &id), NS_OK);
        net_capacitor(&e.k, "c", 1, 0, 1e-9, 0);
        ready(&e);
        assert_int_equal(two_steps(&e, 1e-12), 1);
        assert_true(fabs(e.j.slope[0] / slope[i] - 1) < off[i]);
        assert_true(fabs(voltage(&e, 1) - 1) < 1e-14);
        assert_true(fabs(fabs(net_current_of(&e.k, e.j.to.x, id)) / (1e-9 * slope[i]) - 1) < 10 * off[i]);
        leave(&e);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(charges_are_shared),           cmocka_unit_test(the_time_goes_back),
        cmocka_unit_test(what_takes_time_is_no_jump),   cmocka_unit_test(a_short_transient_stays),
        cmocka_unit_test(rates_before_explain),         cmocka_unit_test(rounding_is_no_jump),
        cmocka_unit_test(what_matters_beside_others),   cmocka_unit_test(what_matters_beside_its_terms),
        cmocka_unit_test(slopes_are_those_on_the_right)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
