/* tests/unit/march/test_pause.c - a trial that may end anywhere does so after a while, so that the engine
 * that costs less is chosen within a ring, too.
 *
 * From a burst of edges of 1e-16 s (13 elements): exact followed a ring of 1e-12 s in one trial of 0.01 s,
 * without end, where sparse takes 3 ms for all.
 */
#include "rig.h"

#include "march/run_internal.h"
#include "signals.h"

/* Two rings in series, 0.6 V cos(wt) and -0.6 V cos(2wt) of 5 GHz, for 2e5 periods: 0.675 V at most.  A diode
 * opens at 1 V: each could be on its way there, so that exact has to look for the event in every period. */
static const double stop = 4e-5, C = 1e-12, L = 1e-9;

static double volts(double t) {
    const double x = t / sqrt(L * C);
    return 0.6 * (cos(x) - cos(2 * x));
}

static rig ringing(ns_method method) {
    rig k = begin();
    const ns_signal rail = dc(1);
    const ns_diode d = {0, 0, INFINITY, INFINITY, 0};
    assert_int_equal(ns_circuit_capacitor(k.c, "c1", 1, 0, C, 0.6, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(k.c, "l1", 1, 0, L, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c2", 4, 1, C, -0.6, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(k.c, "l2", 4, 1, L / 4, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(k.c, "v1", NS_VOLTAGE, 2, 0, &rail, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "r1", 2, 3, 1e3, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(k.c, "d1", 4, 3, &d, NULL), NS_OK);
    make_by(&k, &(ns_march_options){.theta = 1, .gamma = 1, .h = 1e-9, .method = method, .whole = 1});
    start_at_rest(&k);
    return k;
}

static void a_step_ends_after_a_while(void **state) {
    rig k = ringing(NS_AUTO);
    double t;
    (void)state;
    ns_run *r = (ns_run *)(void *)k.m->engine;
    assert_int_equal(ns_march_try(k.m, stop, NS_TO_STEP, &t), NS_OK);
    assert_true(t > 0 && t < stop);
    assert_true(ns_march_run_work(r).all < ns_march_first_question(r->s, 1));
    end(&k);
}

/* Where no engine is chosen it goes on. */
static void a_step_of_one_engine_does_not_end(void **state) {
    rig k = ringing(NS_EXACT);
    double t;
    (void)state;
    assert_int_equal(ns_march_try(k.m, stop / 10, NS_TO_STEP, &t), NS_OK);
    assert_true(t == stop / 10);
    end(&k);
}

/* What comes after it is as if it had gone on. */
static void the_waveform_goes_on(void **state) {
    const double wanted = 5e-8;
    rig k = ringing(NS_AUTO);
    double t = 0;
    int trials = 0;
    (void)state;
    ns_run *r = (ns_run *)(void *)k.m->engine;
    r->choice.patience = 1; /* instructions: it ends each time that it looks */
    for (; t < wanted && trials < 1000; trials++) {
        assert_int_equal(ns_march_try(k.m, wanted, NS_TO_STEP, &t), NS_OK);
        assert_int_equal(ns_march_accept(k.m), NS_OK);
    }
    assert_true(t == wanted);
    assert_in_range(trials, 3, 999);
    assert_int_equal(ns_march_read(k.m, NULL, k.x, NULL, NULL), NS_OK);
    assert_true(fabs(k.x[ns_circuit_node_unknown(k.c, 4)] - volts(wanted)) < 1e-6);
    end(&k);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_step_ends_after_a_while),
        cmocka_unit_test(a_step_of_one_engine_does_not_end),
        cmocka_unit_test(the_waveform_goes_on),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
