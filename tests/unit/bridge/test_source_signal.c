/* tests/unit/bridge/test_source_signal.c - ngspice's parameters of sources, with its defaults, as signals. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "source_signal.h"

enum { TSTEP = 2, TSTOP = 100 };

/* A source with the parameters of a list. */
#define SOURCE(kind, ...)                                                                                    \
    {                                                                                                        \
        .function = (kind), .order = (int)(sizeof((double[]){__VA_ARGS__}) / sizeof(double)),                \
        .coeffs = (double[]){__VA_ARGS__}, .m = 1.0, .tstep = TSTEP, .tstop = TSTOP                          \
    }

/* The signal, of a kind that has no points. */
static ns_signal signal_of(const ns_source *s) {
    ns_signal z;
    double *points;
    assert_null(ns_bridge_source_signal(s, &z, &points));
    assert_null(points);
    assert_int_equal(ns_signal_check(&z), NS_OK);
    return z;
}

static void assert_refused(const ns_source *s, const char *wanted) {
    ns_signal z;
    double *points;
    const char *why = ns_bridge_source_signal(s, &z, &points);
    assert_non_null(why);
    assert_string_equal(why, wanted);
    assert_null(points);
}

static void dc_is_a_constant(void **state) {
    ns_source s = {.function = SOURCE_DC, .dc = -3.0, .m = 2.0};
    ns_signal z = signal_of(&s);
    (void)state;
    assert_int_equal(z.kind, NS_DC);
    assert_true(z.u.dc == -6.0);
}

static void pulse_as_written(void **state) {
    const ns_source s = SOURCE(SOURCE_PULSE, 1, 5, 3, 0.5, 0.25, 4, 9, 7);
    const ns_signal z = signal_of(&s);
    (void)state;
    assert_int_equal(z.kind, NS_PULSE);
    assert_true(z.u.pulse.v1 == 1 && z.u.pulse.v2 == 5 && z.u.pulse.td == 3);
    assert_true(z.u.pulse.tr == 0.5 && z.u.pulse.tf == 0.25 && z.u.pulse.pw == 4 && z.u.pulse.per == 9);
    assert_int_equal(z.u.pulse.cycles, 7);
}

static void pulse_defaults(void **state) {
    const ns_source sources[] = {SOURCE(SOURCE_PULSE, 1, 5), SOURCE(SOURCE_PULSE, 1, 5, 0, 0, 0, 0, 0)};
    (void)state;
    for (size_t k = 0; k < 2; k++) { /* missing, or 0 */
        const ns_signal z = signal_of(&sources[k]);
        assert_true(z.u.pulse.td == 0 && z.u.pulse.tr == TSTEP && z.u.pulse.tf == TSTEP);
        assert_true(z.u.pulse.pw == TSTOP && z.u.pulse.per == TSTOP);
        assert_int_equal(z.u.pulse.cycles, 0);
    }
}

/* vsrcload.c and isrcload.c of ngspice 46 and 47: what they take for the times that are missing or not
 * positive. */
static void pulse_defaults_of_later_versions(void **state) {
    const struct {
        ns_source source;
        ns_source_pulse pulse;
        double tr, tf, pw, per;
    } cases[] = {{SOURCE(SOURCE_PULSE, 0, 1), PULSE_OF_46, TSTEP, TSTEP, 0, 2 * TSTEP},
                 {SOURCE(SOURCE_PULSE, 0, 1, 3, 0.5, 0.25), PULSE_OF_46, 0.5, 0.25, 0, 0.75},
                 {SOURCE(SOURCE_PULSE, 0, 1, 3, 0.5, 0.25, 4), PULSE_OF_46, 0.5, 0.25, 4, 4.75},
                 {SOURCE(SOURCE_PULSE, 0, 1, 3, -1, -1, -1, -1), PULSE_OF_46, TSTEP, TSTEP, 0, 2 * TSTEP},
                 {SOURCE(SOURCE_PULSE, 0, 1, 3, 1, 1, 4, 9), PULSE_OF_46, 1, 1, 4, 9},
                 {SOURCE(SOURCE_PULSE, 0, 1), PULSE_OF_47, TSTEP, TSTEP, TSTOP, TSTOP},
                 {SOURCE(SOURCE_PULSE, 0, 1, 3, 0.5), PULSE_OF_47, 0.5, TSTEP, TSTOP, TSTOP},
                 {SOURCE(SOURCE_PULSE, 0, 1, 3, 0.5, 0.25), PULSE_OF_47, 0.5, 0.25, 0, TSTOP},
                 {SOURCE(SOURCE_PULSE, 0, 1, 3, 0.5, 0.25, 0), PULSE_OF_47, 0.5, 0.25, 0, TSTOP},
                 {SOURCE(SOURCE_PULSE, 0, 1, 3, -1, -1, -1, -1), PULSE_OF_47, TSTEP, TSTEP, TSTOP, TSTOP},
                 {SOURCE(SOURCE_PULSE, 0, 1, 3, 1, 1, 4, 9), PULSE_OF_47, 1, 1, 4, 9}};
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        ns_source s = cases[k].source;
        s.pulse = cases[k].pulse;
        const ns_signal z = signal_of(&s);
        assert_true(z.u.pulse.tr == cases[k].tr && z.u.pulse.tf == cases[k].tf);
        assert_true(z.u.pulse.pw == cases[k].pw && z.u.pulse.per == cases[k].per);
    }
}

static void pulses_are_counted_in_whole_numbers(void **state) {
    const ns_source part = SOURCE(SOURCE_PULSE, 1, 5, 3, 1, 1, 4, 9, 2.5);
    const ns_source half = SOURCE(SOURCE_PULSE, 1, 5, 3, 1, 1, 4, 9, 0.5);
    const ns_source many = SOURCE(SOURCE_PULSE, 1, 5, 3, 1, 1, 4, 9, 2e9);
    const ns_source most = SOURCE(SOURCE_PULSE, 1, 5, 3, 1, 1, 4, 9, 1e9);
    const ns_source one = SOURCE(SOURCE_PULSE, 1, 5, 3, 1, 1, 4, 9, 1);
    const ns_source negative = SOURCE(SOURCE_PULSE, 1, 5, 3, 1, 1, 4, 9, -2);
    (void)state;
    assert_refused(&part, "the number of pulses must be a whole number of at most 1e9");
    assert_refused(&half, "the number of pulses must be a whole number of at most 1e9");
    assert_refused(&many, "the number of pulses must be a whole number of at most 1e9");
    assert_int_equal(signal_of(&most).u.pulse.cycles, 1000000000);
    assert_int_equal(signal_of(&one).u.pulse.cycles, 1);
    assert_int_equal(signal_of(&negative).u.pulse.cycles, 0);
}

static void sine_and_its_defaults(void **state) {
    const ns_source full = SOURCE(SOURCE_SINE, 1, 2, 50, 0.5, 3, 90);
    const ns_source bare = SOURCE(SOURCE_SINE, 1, 2);
    ns_signal z = signal_of(&full);
    (void)state;
    assert_int_equal(z.kind, NS_SIN);
    assert_true(z.u.sin.vo == 1 && z.u.sin.va == 2 && z.u.sin.freq == 50);
    assert_true(z.u.sin.td == 0.5 && z.u.sin.theta == 3 && z.u.sin.phase == 90);
    z = signal_of(&bare);
    assert_true(z.u.sin.freq == 1.0 / TSTOP && z.u.sin.td == 0 && z.u.sin.theta == 0 && z.u.sin.phase == 0);
}

static void exponential_and_its_defaults(void **state) {
    const ns_source full = SOURCE(SOURCE_EXP, 1, 2, 3, 4, 5, 6);
    const ns_source bare = SOURCE(SOURCE_EXP, 1, 2);
    const ns_source delayed = SOURCE(SOURCE_EXP, 1, 2, 7);
    ns_signal z = signal_of(&full);
    (void)state;
    assert_int_equal(z.kind, NS_EXP);
    assert_true(z.u.exp.v1 == 1 && z.u.exp.v2 == 2 && z.u.exp.td1 == 3 && z.u.exp.tau1 == 4);
    assert_true(z.u.exp.td2 == 5 && z.u.exp.tau2 == 6);
    z = signal_of(&bare);
    assert_true(z.u.exp.td1 == TSTEP && z.u.exp.tau1 == TSTEP && z.u.exp.td2 == 2 * TSTEP &&
                z.u.exp.tau2 == TSTEP);
    assert_true(signal_of(&delayed).u.exp.td2 == 7 + TSTEP);
}

static void pwl_points(void **state) {
    ns_source s = SOURCE(SOURCE_PWL, 0, 1, 2, 3, 4, 5, 6); /* the last time has no value */
    ns_signal z;
    double *points;
    (void)state;
    s.m = 10.0;
    s.delay = 0.5;
    assert_null(ns_bridge_source_signal(&s, &z, &points));
    assert_int_equal(z.kind, NS_PWL);
    assert_int_equal(z.u.pwl.n, 3);
    for (int i = 0; i < 3; i++) {
        assert_true(z.u.pwl.t[i] == 2 * i && z.u.pwl.v[i] == 10 * (2 * i + 1));
    }
    assert_true(z.u.pwl.td == 0.5 && isnan(z.u.pwl.repeat));
    free(points);
    s.repeats = 1;
    s.repeat_index = 2;
    assert_null(ns_bridge_source_signal(&s, &z, &points));
    assert_true(z.u.pwl.repeat == 2);
    free(points);
    s.order = 1;
    assert_refused(&s, "a PWL source needs at least one point");
}

static void equal_sources_add_up(void **state) {
    ns_source pulse = SOURCE(SOURCE_PULSE, 1, 5, 3);
    ns_source sine = SOURCE(SOURCE_SINE, 1, 2, 50);
    ns_source exponential = SOURCE(SOURCE_EXP, 1, 2, 3);
    ns_signal z;
    (void)state;
    pulse.m = sine.m = exponential.m = 3.0;
    z = signal_of(&pulse);
    assert_true(z.u.pulse.v1 == 3 && z.u.pulse.v2 == 15 && z.u.pulse.td == 3);
    z = signal_of(&sine);
    assert_true(z.u.sin.vo == 3 && z.u.sin.va == 6 && z.u.sin.freq == 50);
    z = signal_of(&exponential);
    assert_true(z.u.exp.v1 == 3 && z.u.exp.v2 == 6 && z.u.exp.td1 == 3);
}

static void as_dc_is_the_dc_value_or_that_at_0(void **state) {
    ns_source sine = SOURCE(SOURCE_SINE, 1, 2, 50, 0, 0, 90);
    ns_source pwl = SOURCE(SOURCE_PWL, -1, 4, 1, 8);
    ns_signal z;
    double *points;
    (void)state;
    sine.as_dc = pwl.as_dc = 1;
    sine.m = 2.0;
    sine.dc = 7.0;
    z = signal_of(&sine);
    assert_int_equal(z.kind, NS_DC);
    assert_true(fabs(z.u.dc - 6.0) < 1e-15);
    sine.dc_given = 1;
    assert_true(signal_of(&sine).u.dc == 14.0);
    assert_null(ns_bridge_source_signal(&pwl, &z, &points));
    assert_int_equal(z.kind, NS_DC);
    assert_true(z.u.dc == 6.0);
    free(points);
}

static void other_functions_are_refused(void **state) {
    static const char why[] = "this function of a source is not supported; DC, PULSE, SIN, EXP and PWL are";
    (void)state;
    for (int function = 4; function < 12; function += function == 4 ? 2 : 1) { /* SFFM, AM and so on */
        ns_source s = SOURCE(function, 1, 2);
        assert_refused(&s, why);
        s.as_dc = 1; /* without a DC value */
        assert_refused(&s, why);
        s.dc_given = 1;
        assert_int_equal(signal_of(&s).kind, NS_DC);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dc_is_a_constant),
        cmocka_unit_test(pulse_as_written),
        cmocka_unit_test(pulse_defaults),
        cmocka_unit_test(pulse_defaults_of_later_versions),
        cmocka_unit_test(pulses_are_counted_in_whole_numbers),
        cmocka_unit_test(sine_and_its_defaults),
        cmocka_unit_test(exponential_and_its_defaults),
        cmocka_unit_test(pwl_points),
        cmocka_unit_test(equal_sources_add_up),
        cmocka_unit_test(as_dc_is_the_dc_value_or_that_at_0),
        cmocka_unit_test(other_functions_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
