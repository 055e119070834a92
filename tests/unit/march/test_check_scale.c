/* tests/unit/march/test_check_scale.c - the time that the check lets an event take is short beside the
 * shortest ramp of a source: a pulse of 63 ps in a run of 83 ms once hid a jump of 2 V that nothing caused.
 */
#include "march_bench.h"
#include "signals.h"

#include "march/run_internal.h"
#include "verify/verify_internal.h"

static const double h = 1e-3;

/* What the check allows events of a circuit whose source has edges that long, all times in s. */
static ns_verify_options allowed(double edge, ns_method method) {
    const ns_signal s = pulse(0, 1, 1e-3, edge, edge, 1e-3, 3e-3);
    const ns_march_options by = {.theta = 1, .gamma = 1, .method = method, .h = h};
    bench b = open_bench();
    assert_int_equal(ns_circuit_source(b.c, "v1", NS_VOLTAGE, 1, 0, &s, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r1", 1, 2, 1e3, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(b.c, "c1", 2, 0, 1e-9, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
    assert_int_equal(ns_march_create(b.s, &by, &b.m, NULL), NS_OK);
    start_at_rest(&b);
    const ns_verify_options o = ((const ns_run *)(const void *)b.m->engine)->check.verify->o;
    close_bench(&b);
    return o;
}

static void an_event_is_short_beside_ramps(void **state) {
    static const ns_method methods[] = {NS_EXACT, NS_SPARSE};
    (void)state;
    for (int by = 0; by < 2; by++) {
        const ns_verify_options slow = allowed(1e-4, methods[by]), fast = allowed(1e-12, methods[by]);
        assert_true(slow.instant == ldexp(h, -11)); /* what engines locate events to, src/README.md */
        assert_true(fast.instant > 0 && fast.instant <= 0.25e-12);
        assert_true(fast.transient > 0 && fast.transient < 1e-3 * fast.instant);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(an_event_is_short_beside_ramps)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
