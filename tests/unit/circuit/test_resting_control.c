/* tests/unit/circuit/test_resting_control.c - thresholds of switches and choices whose control may rest
 * there: shifted by 1e-9 of the threshold, or of 1 mV (choices: by 4e-12 of the control), and only where it
 * may. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "nonsmooth/circuit.h"

static ns_circuit *made;
static int switches;

static ns_signal pulse(double v1, double v2) {
    return (ns_signal){.kind = NS_PULSE, .u.pulse = {v1, v2, 0, 1e-8, 1e-8, 1e-6, 5e-6, 0}};
}

static ns_signal sine(double td) {
    return (ns_signal){.kind = NS_SIN, .u.sin = {0, 1, 1e3, td, 0, 0}};
}

static void begin(void) {
    assert_int_equal(ns_circuit_create(&made), NS_OK);
    switches = 0;
}

static void source(const char *name, int p, int n, ns_signal s) {
    int id;
    assert_int_equal(ns_circuit_source(made, name, NS_VOLTAGE, p, n, &s, &id), NS_OK);
}

/* From node 9 to ground, by nodes cp and cn; open (0) or closed (1) at rest. */
static void add_switch(const char *name, int cp, int cn, double vt, int closed) {
    const ns_switch sw = {.vt = vt, .ron = 1, .roff = INFINITY};
    int id;
    assert_int_equal(ns_circuit_switch(made, name, 9, 0, cp, cn, &sw, &id), NS_OK);
    assert_int_equal(ns_circuit_switch_at_rest(made, id, closed), NS_OK);
    switches++;
}

/* The thresholds of the switches, less vt; then the circuit is freed. */
static void end_with(int count, const double *vt, const double *shift) {
    ns_system *s;
    int id;
    assert_int_equal(ns_circuit_resistor(made, "r9", 9, 0, 1, &id), NS_OK);
    assert_int_equal(ns_circuit_system(made, &s), NS_OK);
    assert_int_equal(s->nc, switches);
    assert_int_equal(count, switches);
    for (int i = 0; i < count; i++) {
        assert_true(fabs(s->command[i].on - vt[i] - shift[i]) <= 1e-15);
        assert_true(s->command[i].off == s->command[i].on);
    }
    ns_system_free(s);
    ns_circuit_free(made);
}

/* A pulse rests at its two values; half way it does not. */
static void by_a_pulse(void **state) {
    (void)state;
    begin();
    source("v1", 1, 0, pulse(0, 1));
    add_switch("s1", 1, 0, 0, 0);
    add_switch("s2", 1, 0, 0.5, 0);
    add_switch("s3", 1, 0, 1, 0);
    add_switch("s4", 0, 1, 0, 1);
    add_switch("s5", 1, 0, 0, -1);
    end_with(5, (double[]){0, 0.5, 1, 0, 0}, (double[]){1e-12, 0, 1e-9, -1e-12, 0});
}

/* A sum rests where each of its inputs rests. */
static void by_a_sum(void **state) {
    (void)state;
    begin();
    source("v1", 1, 0, pulse(-1, 1));
    source("v2", 2, 0, pulse(0, 2));
    source("v3", 3, 0, sine(0));
    source("v4", 4, 0, sine(1e-3)); /* 0 V for 1 ms */
    add_switch("s1", 1, 2, 1, 0);   /* 1 V less 0 V */
    add_switch("s2", 1, 2, 0.5, 0);
    add_switch("s3", 1, 3, 0, 0);
    add_switch("s4", 1, 4, 1, 0);
    add_switch("s5", 4, 0, 0, 0);
    add_switch("s6", 4, 0, 0.5, 0);
    end_with(6, (double[]){1, 0.5, 0, 1, 0, 0.5}, (double[]){1e-9, 0, 0, 1e-9, 1e-12, 0});
}

/* Twice a pulse of 1 V rests at 2 V, not at 1 V; one of 5 V less one of 1 V at 4 V. */
static void by_a_multiple(void **state) {
    int id;
    (void)state;
    begin();
    source("v1", 1, 0, pulse(0, 1));
    source("v3", 3, 0, pulse(0, 5));
    assert_int_equal(ns_circuit_vcontrolled(made, "e1", NS_VOLTAGE, 2, 0, 1, 0, 2, &id), NS_OK);
    assert_int_equal(ns_circuit_vcontrolled(made, "e2", NS_VOLTAGE, 4, 3, 1, 0, -1, &id), NS_OK);
    add_switch("s1", 2, 0, 2, 0);
    add_switch("s2", 2, 0, 1, 0);
    add_switch("s3", 4, 0, 4, 0); /* 5 V less 1 V */
    end_with(3, (double[]){2, 1, 4}, (double[]){2e-9, 0, 4e-9});
}

/* Behind an inductor a voltage is no function of time: its switch is not shifted, that of the source is. */
static void behind_an_inductor(void **state) {
    int id;
    (void)state;
    begin();
    source("v1", 1, 0, pulse(0, 1));
    assert_int_equal(ns_circuit_inductor(made, "l1", 1, 2, 1e-3, NAN, &id), NS_OK);
    assert_int_equal(ns_circuit_resistor(made, "r1", 2, 0, 1, &id), NS_OK);
    add_switch("s1", 2, 0, 1, 0);
    add_switch("s2", 1, 0, 1, 0);
    end_with(2, (double[]){1, 1}, (double[]){0, 1e-9});
}

/* Three times the current of the first element, a source: no voltage is in the control. */
static void by_a_current(void **state) {
    const ns_switch sw = {.vt = 1, .ron = 1, .roff = INFINITY};
    ns_system *s;
    int r, id;
    (void)state;
    begin();
    assert_int_equal(ns_circuit_source(made, "v0", NS_VOLTAGE, 1, 0, &(ns_signal){.kind = NS_DC}, &r), NS_OK);
    assert_int_equal(r, 0);
    assert_int_equal(ns_circuit_resistor(made, "r1", 1, 0, 1, &id), NS_OK);
    assert_int_equal(ns_circuit_switch_by_current(made, "w1", 2, 0, r, 3, &sw, &id), NS_OK);
    assert_int_equal(ns_circuit_resistor(made, "r2", 2, 0, 1, &id), NS_OK);
    assert_int_equal(ns_circuit_system(made, &s), NS_OK);
    assert_int_equal(s->nc, 1);
    assert_non_null(s->command[0].gx);
    for (int i = 0; i < s->n; i++)
        assert_true(s->command[0].gx[i] == (i == ns_circuit_current_unknown(made, r) ? 3 : 0));
    assert_true(s->command[0].on == 1 && s->command[0].off == 1);
    ns_system_free(s);
    ns_circuit_free(made);
}

/* A line at 1 V from 1 s to 2 s, and from 4 s to 5 s. */
static ns_signal line_at_one(const double *v) {
    static const double t[] = {0, 1, 2, 3, 4, 5};
    return (ns_signal){.kind = NS_PWL, .u.pwl = {6, t, v, NAN, 0}};
}

static void add_as_it_came(const char *name, int cp, int closed) {
    add_switch(name, cp, 0, 1, -1);
    assert_int_equal(ns_circuit_switch_as_it_came(made, ns_circuit_count(made) - 1, closed, 0), NS_OK);
}

/* It comes to 1 V from below: closed there; from above: open; it is there always: as it was asked for. */
static void as_it_came(void **state) {
    (void)state;
    begin();
    source("v1", 1, 0, line_at_one((double[]){0, 1, 1, 0, 1, 1}));
    source("v2", 2, 0, line_at_one((double[]){2, 1, 1, 2, 1, 1}));
    source("v3", 3, 0, line_at_one((double[]){0, 1, 1, 2, 2, 2}));
    source("v4", 4, 0, line_at_one((double[]){1, 1, 1, 1, 1, 1}));
    add_as_it_came("s1", 1, 0);
    add_as_it_came("s2", 2, 0);
    add_as_it_came("s3", 3, 0);
    add_as_it_came("s4", 4, 0);
    add_as_it_came("s5", 4, 1);
    end_with(5, (double[]){1, 1, 1, 1, 1}, (double[]){-1e-9, 1e-9, -1e-9, 1e-9, -1e-9});
}

/* What moves through 1 V, however slowly, does not rest there. */
static void slowly_through_the_threshold(void **state) {
    static const double t[] = {0, 1, 2, 3, 4, 5, 6},
                        v[] = {0, 1 - 1e-10, 1 + 1e-10, 2, 1 + 1e-10, 1 - 1e-10, 0};
    (void)state;
    begin();
    source("v1", 1, 0, (ns_signal){.kind = NS_PWL, .u.pwl = {7, t, v, NAN, 0}});
    add_as_it_came("s1", 1, 0);
    end_with(1, (double[]){1}, (double[]){0});
}

/* From both sides no shift does that. */
static void as_it_came_both_ways(void **state) {
    ns_system *s;
    (void)state;
    begin();
    source("v1", 1, 0, line_at_one((double[]){0, 1, 1, 2, 1, 1}));
    add_as_it_came("s1", 1, 0);
    assert_int_equal(ns_circuit_resistor(made, "r9", 9, 0, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(made, &s), NS_E_RANGE);
    ns_circuit_free(made);
}

/* A line that is over before the run begins may be set later; what is no function of time may rest at 0 V;
 * complements change in the same instant. */
static void by_what_is_not_known(void **state) {
    static const double t[] = {-2, -1}, v[] = {0, 5};
    int id;
    (void)state;
    begin();
    source("v1", 1, 0, (ns_signal){.kind = NS_PWL, .u.pwl = {2, t, v, NAN, 0}});
    assert_int_equal(ns_circuit_resistor(made, "r1", 1, 2, 1, &id), NS_OK);
    assert_int_equal(ns_circuit_capacitor(made, "c1", 2, 0, 1, NAN, &id), NS_OK);
    add_switch("s1", 1, 0, 0, 0);
    add_switch("s2", 1, 0, 5, 0);
    add_switch("s3", 2, 0, 0, 0);
    add_switch("s4", 2, 0, 1, 0);
    add_switch("s5", 2, 1, 0, 0);
    add_switch("s6", 1, 2, 0, 0);
    add_switch("s7", 2, 0, 1, 0); /* at 1 V, as the caller knows */
    assert_int_equal(ns_circuit_switch_rests(made, id + 7), NS_OK);
    end_with(7, (double[]){0, 5, 0, 1, 0, 0, 1}, (double[]){1e-12, 0, 1e-12, 0, 0, 0, 1e-9});
}

/* Of v(p) - v(n), 1 where it is above the threshold; there: `holds`. */
static void add_choice_above(const char *name, int p, int n, int holds, int group, double threshold) {
    const ns_affine control = {0, 2, (ns_term[]){{0, p, 1}, {0, n, -1}}}, one = {1, 0, NULL};
    int id;
    assert_int_equal(ns_circuit_choice(made, name, &control, threshold, &one, &id), NS_OK);
    assert_int_equal(ns_circuit_choice_at_rest(made, id, holds, group), NS_OK);
    switches++;
}

static void add_choice(const char *name, int p, int n, int holds, int group) {
    add_choice_above(name, p, n, holds, group, 0);
}

/* By 4e-12 of what the terms are at most, 3 V and 1 V: at equality from 4 us on each period; those in
 * antiphase have equal levels, but never at one time. */
static void choice_by_time(void **state) {
    ns_signal late = pulse(0, 3), opposite = pulse(1, 0);
    (void)state;
    late.u.pulse.td = 2e-6;
    begin();
    source("v1", 1, 0, pulse(0, 1));
    source("v2", 2, 0, late);
    source("v3", 3, 0, opposite);
    add_choice("c1", 1, 2, 0, 1);
    add_choice("c2", 2, 1, 1, 2);
    add_choice("c3", 1, 3, 0, 3);
    end_with(3, (double[]){0, 0, 0}, (double[]){16e-12, -16e-12, 0});
}

/* -1 V, and 0 V from 2 ms on, less a sine of 1 kHz that is 0 V until 1 ms: levels that add up to the
 * threshold, but while one is there the other is not.  The sine is zero at quarters of the second after 2 ms.
 */
static void choice_of_a_sine(void **state) {
    const double t[] = {0, 2e-3, 2e-3}, v[] = {-1, -1, 0};
    ns_signal step = {.kind = NS_PWL};
    step.u.pwl.n = 3;
    step.u.pwl.t = t;
    step.u.pwl.v = v;
    step.u.pwl.repeat = NAN;
    (void)state;
    begin();
    source("v1", 1, 0, step);
    source("v2", 2, 0, sine(1e-3));
    add_choice("c1", 1, 2, 0, 1);
    add_choice("c2", 2, 1, 1, 2);
    end_with(2, (double[]){0, 0}, (double[]){0, 0});
}

/* By 4e-12 of twice the largest source, 3 V; opposite ones of two groups change in one instant, those of one
 * group (a sign) need not. */
static void choice_by_state(void **state) {
    int id;
    (void)state;
    begin();
    source("v1", 1, 0, pulse(0, 3));
    for (int node = 2; node < 6; node++) {
        const char *const name[] = {"r2", "r3", "r4", "r5"};
        assert_int_equal(ns_circuit_resistor(made, name[node - 2], node - 1, node, 1, &id), NS_OK);
    }
    add_choice("c1", 2, 3, 0, 1);
    add_choice("c2", 3, 4, 0, 2);
    add_choice("c3", 4, 3, 0, 3);
    add_choice("c4", 4, 5, 1, 4);
    add_choice("c5", 5, 4, 1, 4);
    end_with(5, (double[]){0, 0, 0, 0, 0}, (double[]){24e-12, 0, 0, -24e-12, -24e-12});
}

/* v(1) + 2 v(2) - v(3): sources of 3 V and 5 V, and what is not known counts as the largest, 5 V: 3 + 10 + 5
 * in all. */
static void choice_by_sources_and_the_state(void **state) {
    const ns_affine control = {0, 3, (ns_term[]){{0, 1, 1}, {0, 2, 2}, {0, 3, -1}}}, one = {1, 0, NULL};
    int id;
    (void)state;
    begin();
    source("v1", 1, 0, pulse(0, 3));
    source("v2", 2, 0, pulse(0, 5));
    assert_int_equal(ns_circuit_resistor(made, "r1", 1, 3, 1, &id), NS_OK);
    assert_int_equal(ns_circuit_resistor(made, "r2", 3, 0, 1, &id), NS_OK);
    assert_int_equal(ns_circuit_choice(made, "c1", &control, 0, &one, &id), NS_OK);
    assert_int_equal(ns_circuit_choice_at_rest(made, id, 0, 1), NS_OK);
    switches++;
    end_with(1, (double[]){0}, (double[]){4e-12 * 18});
}

/* A sign (group 1: both ways) beside a comparison: the latter has an opposite in a group that also has its
 * like, the former has its opposites in its own group; so neither is left at its threshold. */
static void a_sign_beside_a_comparison(void **state) {
    int id;
    (void)state;
    begin();
    source("v1", 1, 0, pulse(0, 3));
    assert_int_equal(ns_circuit_resistor(made, "r1", 1, 2, 1, &id), NS_OK);
    assert_int_equal(ns_circuit_resistor(made, "r2", 2, 3, 1, &id), NS_OK);
    add_choice("c1", 2, 3, 0, 1);
    add_choice("c2", 3, 2, 0, 1);
    add_choice("c3", 3, 2, 1, 2);
    end_with(3, (double[]){0, 0, 0}, (double[]){24e-12, 24e-12, -24e-12});
}

/* Thresholds beside zero by rounding, less than 24e-12 V: opposite choices change in one instant all the
 * same; those of 1 V do not. */
static void opposite_choices_beside_zero(void **state) {
    int id;
    (void)state;
    begin();
    source("v1", 1, 0, pulse(0, 3));
    assert_int_equal(ns_circuit_resistor(made, "r1", 1, 2, 1, &id), NS_OK);
    assert_int_equal(ns_circuit_resistor(made, "r2", 2, 3, 1, &id), NS_OK);
    assert_int_equal(ns_circuit_resistor(made, "r3", 3, 4, 1, &id), NS_OK);
    add_choice_above("c1", 2, 3, 0, 1, 2e-13);
    add_choice_above("c2", 3, 2, 0, 2, 2e-13);
    add_choice_above("c3", 3, 4, 0, 3, 1);
    add_choice_above("c4", 4, 3, 0, 4, 1);
    end_with(4, (double[]){0, 0, 1, 1}, (double[]){0, 0, 0, 0});
}

/* The same where the choices are the first elements of the circuit. */
static void opposite_choices_come_first(void **state) {
    int id;
    (void)state;
    begin();
    add_choice("c1", 2, 3, 0, 1);
    add_choice("c2", 3, 2, 0, 2);
    source("v1", 1, 0, pulse(0, 3));
    assert_int_equal(ns_circuit_resistor(made, "r1", 1, 2, 1, &id), NS_OK);
    assert_int_equal(ns_circuit_resistor(made, "r2", 2, 3, 1, &id), NS_OK);
    assert_int_equal(ns_circuit_resistor(made, "r3", 3, 0, 1, &id), NS_OK);
    end_with(2, (double[]){0, 0}, (double[]){0, 0});
}

static void refused(void **state) {
    const ns_switch sw = {.vt = 1, .vh = 0.5, .ron = 1, .roff = INFINITY};
    int id;
    (void)state;
    assert_int_equal(ns_circuit_switch_at_rest(NULL, 0, 0), NS_E_NULL);
    assert_int_equal(ns_circuit_switch_rests(NULL, 0), NS_E_NULL);
    assert_int_equal(ns_circuit_choice_at_rest(NULL, 0, 0, 1), NS_E_NULL);
    begin();
    assert_int_equal(ns_circuit_switch_at_rest(made, 0, 0), NS_E_SIZE);
    assert_int_equal(ns_circuit_choice_at_rest(made, 0, 0, 1), NS_E_SIZE);
    source("v1", 1, 0, pulse(0, 1));
    assert_int_equal(ns_circuit_switch_at_rest(made, 0, 0), NS_E_SIZE);
    assert_int_equal(ns_circuit_choice_at_rest(made, 0, 0, 1), NS_E_SIZE);
    /* with hysteresis there is nothing to say */
    assert_int_equal(ns_circuit_switch(made, "s1", 9, 0, 1, 0, &sw, &id), NS_OK);
    assert_int_equal(ns_circuit_switch_at_rest(made, id, 0), NS_OK);
    ns_system *s;
    assert_int_equal(ns_circuit_resistor(made, "r9", 9, 0, 1, &id), NS_OK);
    assert_int_equal(ns_circuit_system(made, &s), NS_OK);
    assert_true(s->command[0].on == 1.5 && s->command[0].off == 0.5);
    ns_system_free(s);
    ns_circuit_free(made);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(by_a_pulse),
        cmocka_unit_test(by_a_sum),
        cmocka_unit_test(by_a_multiple),
        cmocka_unit_test(by_a_current),
        cmocka_unit_test(behind_an_inductor),
        cmocka_unit_test(as_it_came),
        cmocka_unit_test(as_it_came_both_ways),
        cmocka_unit_test(slowly_through_the_threshold),
        cmocka_unit_test(by_what_is_not_known),
        cmocka_unit_test(opposite_choices_come_first),
        cmocka_unit_test(choice_by_time),
        cmocka_unit_test(choice_of_a_sine),
        cmocka_unit_test(choice_by_state),
        cmocka_unit_test(a_sign_beside_a_comparison),
        cmocka_unit_test(choice_by_sources_and_the_state),
        cmocka_unit_test(opposite_choices_beside_zero),
        cmocka_unit_test(refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
