/* tests/unit/march/test_goes_again.c - a trial that was found wrong is gone again by an engine put aside. */
#include "rig.h"

#include "exact/exact_internal.h"
#include "march/dense_internal.h"
#include "march/run_internal.h"
#include "retries.h"
#include "signals.h"

/* 10 V, 1 kHz through a diode into 1 mF beside 10 ohm. */
static rig rectifier(void) {
    rig k = begin();
    const ns_diode d = {0, 0, INFINITY, INFINITY, 0};
    const ns_signal supply = {.kind = NS_SIN, .u.sin = {.va = 10, .freq = 1e3}};
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-6, .method = NS_SPARSE, .whole = 1};
    assert_int_equal(ns_circuit_source(k.c, "v1", NS_VOLTAGE, 1, 0, &supply, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "r1", 1, 2, 0.1, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(k.c, "ad1", 2, 3, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c1", 3, 0, 1e-3, 0, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "r2", 3, 0, 10, NULL), NS_OK);
    make_by(&k, &o);
    start_at_rest(&k);
    return k;
}

static ns_engine_table often_failing;
static const ns_engine_table *dense_table;

/* From its start on it failed that often. */
static int start_failing(ns_engine *e, double t0, const double *w0, const unsigned char *closed) {
    ns_exact *exact = ((ns_dense_run *)(void *)e)->exact;
    const int status = dense_table->start(e, t0, w0, closed);
    exact->past.failures = exact->accepted.failures = 1000;
    return status;
}

/* The dense engine fails often, and would hand over to the sparse one: that is what was found wrong, so there
 * is nobody to hand over to. */
static void who_goes_again_hands_nothing_over(void **state) {
    (void)state;
    rig k = rectifier();
    ns_run *r = (ns_run *)(void *)k.m->engine;
    double t;
    assert_int_equal(ns_march_try(k.m, 0.1e-3, NS_TO_TIME, &t), NS_OK);
    assert_int_equal(ns_march_accept(k.m), NS_OK);
    assert_int_equal(ns_march_run_make(r, NS_RUN_DENSE, &r->aside), NS_OK);
    r->aside_kind = NS_RUN_DENSE;
    ns_march_dense_let_hand_over(r->aside, NS_HANDS_OVER_OFTEN);
    dense_table = r->aside->table;
    often_failing = *dense_table;
    often_failing.start = start_failing;
    r->aside->table = &often_failing;
    assert_int_equal(ns_march_run_again(r, 2e-3, NS_TO_TIME, &t), NS_OK);
    assert_true(t == 2e-3);
    assert_int_equal(r->kind, NS_RUN_DENSE);
    end(&k);
}

static ns_engine_table by_ladder;
static double ladder_steps; /* h */

/* As if the ladder had gone for so long, where no matrices could be built. */
static int try_by_ladder(ns_engine *e, double t, ns_until until, double *reached) {
    const int status = dense_table->try_to(e, t, until, reached);
    ((ns_dense_run *)(void *)e)->without_matrices = ladder_steps * 1e-6;
    return status;
}

static void plant_ladder(ns_engine *e) {
    dense_table = e->table;
    by_ladder = *dense_table;
    by_ladder.try_to = try_by_ladder;
    e->table = &by_ladder;
}

/* Nobody judges how errors of the ladder's steps add up: after more than 16 h another engine goes again. */
static void long_ways_of_the_ladder_are_gone_again(void **state) {
    (void)state;
    for (int is_long = 0; is_long < 2; is_long++) {
        rig k = rectifier();
        ns_run *r = (ns_run *)(void *)k.m->engine;
        double t;
        assert_int_equal(ns_march_run_leave_for(r, NS_RUN_DENSE, 0), NS_OK);
        plant_ladder(r->at_work);
        ladder_steps = is_long ? 17 : 15;
        assert_int_equal(ns_march_try(k.m, 0.1e-3, NS_TO_TIME, &t), NS_OK);
        assert_int_equal(r->kind, is_long ? NS_RUN_SPARSE : NS_RUN_DENSE);
        end(&k);
    }
}

/* Nor does it count when it goes again for another one: the scheme does. */
static void the_ladder_does_not_go_again(void **state) {
    (void)state;
    rig k = rectifier();
    ns_run *r = (ns_run *)(void *)k.m->engine;
    double t;
    assert_int_equal(ns_march_try(k.m, 0.1e-3, NS_TO_TIME, &t), NS_OK);
    assert_int_equal(ns_march_accept(k.m), NS_OK);
    assert_int_equal(ns_march_run_make(r, NS_RUN_DENSE, &r->aside), NS_OK);
    r->aside_kind = NS_RUN_DENSE;
    plant_ladder(r->aside);
    ladder_steps = 17;
    assert_int_equal(ns_march_run_again(r, 0.2e-3, NS_TO_TIME, &t), NS_OK);
    assert_int_equal(r->kind, NS_RUN_SCHEME);
    end(&k);
}

/* What is refused is named, the first pair and the first unknown too. */
static void what_is_refused_is_named(void **state) {
    (void)state;
    for (int k = -1; k < 2; k++) {
        ns_run r = {0};
        const ns_verify_finding f = {NS_VERIFY_FLOW, k, k, 3, 1};
        assert_int_equal(ns_march_run_refuse(&r, &f), NS_E_RESIDUAL);
        assert_true(r.refused && r.fault.t == 3 && r.fault.why);
        assert_int_equal(r.fault.npairs, k >= 0);
        assert_int_equal(r.fault.nunknowns, k >= 0);
        assert_true(k < 0 || (r.fault.pair[0] == k && r.fault.unknown[0] == k));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(who_goes_again_hands_nothing_over),
                                       cmocka_unit_test(long_ways_of_the_ladder_are_gone_again),
                                       cmocka_unit_test(the_ladder_does_not_go_again),
                                       cmocka_unit_test(what_is_refused_is_named)};
    allow_retries(ANY_RETRIES);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
