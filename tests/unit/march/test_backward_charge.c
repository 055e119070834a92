/* tests/unit/march/test_backward_charge.c - a transient that is over long before events are told apart, and
 * in whose midst a diode begins to conduct: it does not carry charge backwards as if it had from the
 * beginning.
 *
 * C1 in tests/rig/hysteretic_pump.h is charged with R1 C1 = 2e-13 s or 2e-15 s, by steps up to as long as
 * the run.  The lowest voltage of C2 is 0.5 V; joined with C1 at 0 V it would be 0.5 V 120 / 122 =
 * 0.4918 V.
 */
#include "hysteretic_pump.h"
#include "retries.h"

static const double lowest = 0.5;

static double lowest_of(rig *k, const ns_march_options *o, double from, double until) {
    double t = 0, least = INFINITY;
    long events = 0;
    make_by(k, o);
    start_at_rest(k);
    while (t < until) {
        assert_int_equal(ns_march_try(k->m, until, NS_TO_STEP, &t), NS_OK);
        events += ns_march_at_event(k->m);
        assert_int_equal(ns_march_accept(k->m), NS_OK);
        assert_int_equal(ns_march_read(k->m, NULL, k->x, NULL, NULL), NS_OK);
        if (t > from)
            least = fmin(least, pump_voltage(k, PUMP_OUT));
    }
    assert_true(events > 10);
    return least;
}

static void never_below(double r1, double r2, int other, double until, ns_method method) {
    static const double steps[] = {1e-5, 1e-3, 0.2, 1};
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        const ns_march_options o = {
            .theta = 1, .gamma = 1, .h = steps[i] * until, .method = method, .reltol = 1e-9};
        rig k = build_pump(r1, r2, other, NULL);
        const double least = lowest_of(&k, &o, 0.01 * until, until);
        assert_true(fabs(least - lowest) < 1e-4 * lowest);
        end(&k);
    }
}

static void exact(void **state) {
    (void)state;
    never_below(100e-6, 10, 0, 5e-6, NS_EXACT);
    never_below(1e-6, 0.01, PUMP_SUPPLY, 5e-9, NS_EXACT);
}

static void sparse(void **state) {
    (void)state;
    allow_retries(1); /* the check of a jump finds it */
    never_below(100e-6, 10, 0, 5e-6, NS_SPARSE);
    never_below(1e-6, 0.01, PUMP_SUPPLY, 5e-9, NS_SPARSE);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exact),
        cmocka_unit_test(sparse),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
