/* tests/unit/waveform/test_kinds.c - the largest value of a kind, of which rounding is a part. */
#include "rows_rig.h"

static double largest(const ns_waveform *w) {
    return w->kind_largest[w->kind[0]];
}

/* 1e13 V for an instant, then 10 V: 1e-12 of the first would be as much as all of the second. */
static void a_kick_is_forgotten(void **state) {
    rig r = prepared(&(ns_waveform_options){.lines = 1e-4});
    (void)state;
    has_been(r.w, 10, -5);
    has_been(r.w, -1e13, 10);
    assert_true(largest(r.w) == 1e13);
    for (int k = 0; k < 10; k++)
        has_been(r.w, 10, -5);
    assert_true(largest(r.w) <= 1e4);
    assert_true(largest(r.w) >= 10);
    rig_end(&r);
}

/* Pulses of 100 V with 0 V between them for long: in each pulse rounding is that of 100 V. */
static void pulses_come_back(void **state) {
    rig r = prepared(&(ns_waveform_options){.lines = 1e-4});
    (void)state;
    for (int pulse = 0; pulse < 3; pulse++) {
        has_been(r.w, 100, 50);
        assert_true(largest(r.w) == 100);
        for (int k = 0; k < 20; k++)
            has_been(r.w, 0, 0);
        assert_true(largest(r.w) < 1e-12);
    }
    rig_end(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_kick_is_forgotten),
                                       cmocka_unit_test(pulses_come_back)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
