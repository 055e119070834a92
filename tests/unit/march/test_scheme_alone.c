/* tests/unit/march/test_scheme_alone.c - a trial that both kernels have wrong: the theta scheme is believed
 * if steps a quarter as long come to the same; else shorter ones are tried.
 */
#include "retries.h"
#include "rig.h"

#include "march/dense_internal.h"
#include "march/run_internal.h"
#include "signals.h"

/* --- an engine that does not start --- */

static void free_idle(ns_engine *e) {
    free(e);
}

static int start_nothing(ns_engine *e, double t, const double *w, const unsigned char *closed) {
    (void)e, (void)t, (void)w, (void)closed;
    return NS_E_LIMIT;
}

static const ns_counts *count_nothing(ns_engine *e) {
    static const ns_counts none = {0};
    (void)e;
    return &none;
}

static const ns_fault *fault_of_nothing(const ns_engine *e) {
    static const ns_fault none;
    (void)e;
    return &none;
}

static const ns_engine_table idle = {
    .free = free_idle, .start = start_nothing, .counts = count_nothing, .fault = fault_of_nothing};

/* 1 V through 1 ohm into 1 F, at rest, from 1 s to 2 s: the sparse engine was wrong, the dense ones do not
 * start.  Returns the voltage then. */
static double go_again(double h, int *by_scheme) {
    const ns_signal one = dc(1);
    rig k = begin();
    double reached = 0;
    assert_int_equal(ns_circuit_source(k.c, "v", NS_VOLTAGE, 1, 0, &one, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(k.c, "r", 1, 2, 1, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(k.c, "c", 2, 0, 1, 0, NULL), NS_OK);
    make_by(&k, &(ns_march_options){.h = h, .method = NS_SPARSE, .reltol = 1e-9, .whole = 1});
    start_at_rest(&k);
    go(&k, 1);
    ns_run *r = (ns_run *)(void *)k.m->engine;
    ns_dense_run *beside = calloc(1, sizeof *beside); /* march sets fields of a dense run in it */
    assert_non_null(beside);
    r->aside = &beside->engine;
    r->aside->table = &idle;
    r->aside_kind = NS_RUN_DENSE;
    assert_int_equal(ns_march_run_again(r, 2, NS_TO_TIME, &reached), NS_OK);
    assert_true(reached == 2);
    *by_scheme = r->kind == NS_RUN_SCHEME;
    assert_int_equal(ns_engine_read(r->at_work, NULL, k.x, NULL, NULL), NS_OK);
    const double v = k.x[ns_circuit_node_unknown(k.c, 2)];
    end(&k);
    return v;
}

/* Of 1 V, 1/e is missing at 1 s and 1/e^2 at 2 s.  Steps of implicit Euler of length d = h/16 leave
 * (1 + d)^(-1/d)/e, to first order d/(2 e^2) more (a few steps after the start are shorter: 1 % of it), steps
 * of d/4 a quarter of that.  They differ by 3/4 d/(2 e^2), which is 6.4e-2 d to 8.0e-2 d of the largest
 * charge so far, 0.63 C and up to a quarter more.  Up to 7e-4 they are believed; else steps a quarter as
 * long are tried, at least a 64th of the trial; then the engine at work is asked once more. */
static void shorter_steps_come_to_the_same(void **state) {
    static const double h[] = {1.0 / 16, 1.0 / 4}; /* believed; d too long by 4, or a little less */
    const double too_long = 32, d = 1.0 / 256, right = 1 - exp(-2);
    int by_scheme;
    (void)state;
    for (int k = 0; k < 2; k++) {
        const double error = right - go_again(h[k], &by_scheme), expected = exp(-2) * d / 2;
        assert_true(fabs(error - expected) < 0.01 * expected);
        assert_true(by_scheme);
    }
    assert_true(fabs(go_again(too_long, &by_scheme) - right) < 1e-8);
    assert_false(by_scheme);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shorter_steps_come_to_the_same),
    };
    allow_retries(3);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
