/* tests/unit/bridge/test_source_compare.c - at which instants sources are compared with ngspice's, and what
 * counts as the same. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "source_compare.h"

static const double tstop = 1e-2;

static ns_signal pulse(double pw, double per) {
    return (ns_signal){.kind = NS_PULSE,
                       .u.pulse = {.v1 = 0, .v2 = 5, .td = 0, .tr = 1e-9, .tf = 1e-9, .pw = pw, .per = per}};
}

/* 1 if at one of the instants for z and `n - 1` constants z is not what `other` is. */
static int is_told_apart(const ns_signal *z, const ns_signal *other, int n) {
    ns_signal all[200] = {0};
    double t[SOURCE_INSTANTS];
    double wanted;
    int seen = 0;
    all[n - 1] = *z;
    const int count = ns_bridge_source_instants(all, n, tstop, t);
    assert_in_range(count, 1, SOURCE_INSTANTS);
    for (int k = 0; k < count; k++) {
        assert_true(t[k] >= 0.0 && t[k] <= tstop);
        seen |= !ns_bridge_source_agrees(z, t[k], tstop, ns_signal_value(other, t[k], NS_LEFT), &wanted);
    }
    return seen;
}

/* What ngspice 39, 46 and 47 make of pulse(0 5 0 1n 1n): width and period. */
static void defaults_of_other_versions_are_seen(void **state) {
    const ns_signal of_39 = pulse(tstop, tstop), of_46 = pulse(0, 2e-9), of_47 = pulse(0, tstop);
    (void)state;
    assert_false(is_told_apart(&of_39, &of_39, 1));
    assert_true(is_told_apart(&of_39, &of_46, 1));
    assert_true(is_told_apart(&of_39, &of_47, 1));
    assert_true(is_told_apart(&of_46, &of_39, 1));
    assert_true(is_told_apart(&of_47, &of_39, 1));
    assert_true(is_told_apart(&of_39, &of_47, 200)); /* the last of many */
}

/* A needle of a thousandth of the period is in the middle of a segment. */
static void narrow_pulses_are_seen(void **state) {
    const ns_signal narrow = pulse(1e-8, 1e-5), none = pulse(0, 1e-5);
    (void)state;
    assert_true(is_told_apart(&narrow, &none, 1));
    assert_true(is_told_apart(&narrow, &none, 20));
}

static void repetition_is_seen(void **state) {
    const double t[] = {0, 1e-4, 2e-4}, v[] = {0, 1, 0};
    ns_signal repeated = {.kind = NS_PWL, .u.pwl = {.n = 3, .t = t, .v = v, .repeat = 0.0}};
    ns_signal once = repeated;
    (void)state;
    once.u.pwl.repeat = NAN;
    assert_true(is_told_apart(&repeated, &once, 1));
    assert_true(is_told_apart(&once, &repeated, 1));
    assert_false(is_told_apart(&once, &once, 1));
}

/* At a corner the next number before t may lie on the other side: t is known to rounding of tstop. */
static void rounding_is_no_difference(void **state) {
    const ns_signal z = pulse(5e-6, 1e-5);
    const double edge = 100 * 1e-5;
    double wanted;
    (void)state;
    assert_true(ns_bridge_source_agrees(&z, edge + 1e-9, tstop, 5.0 * (1 - 1e-10), &wanted));
    assert_true(ns_bridge_source_agrees(&z, edge + 5e-10, tstop, 2.5 * (1 + 1e-8), &wanted)); /* 2e-17 s */
    assert_false(ns_bridge_source_agrees(&z, edge + 5e-10, tstop, 2.6, &wanted));
    assert_true(fabs(wanted - 2.5) < 1e-6);
    assert_false(ns_bridge_source_agrees(&z, 2e-6, tstop, 5.0 + 1e-6, &wanted));
    assert_false(ns_bridge_source_agrees(&z, 2e-6, tstop, NAN, &wanted));
}

/* A sine of a million periods: its phase is known to rounding of the number of periods. */
static void fast_sines_agree(void **state) {
    const ns_signal z = {.kind = NS_SIN, .u.sin = {.va = 325, .freq = 1e8}};
    double t[SOURCE_INSTANTS];
    double wanted;
    (void)state;
    const int count = ns_bridge_source_instants(&z, 1, tstop, t);
    for (int k = 0; k < count; k++) {
        const double value = 325 * sin(2 * acos(-1.0) * 1e8 * t[k]); /* as vsrcload.c has it */
        assert_true(ns_bridge_source_agrees(&z, t[k], tstop, value, &wanted));
        assert_false(ns_bridge_source_agrees(&z, t[k], tstop, value + 1e-3, &wanted));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(defaults_of_other_versions_are_seen), cmocka_unit_test(narrow_pulses_are_seen),
        cmocka_unit_test(repetition_is_seen), cmocka_unit_test(rounding_is_no_difference),
        cmocka_unit_test(fast_sines_agree)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
