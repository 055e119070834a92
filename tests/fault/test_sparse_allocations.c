/* tests/fault/test_sparse_allocations.c - the sparse engine with each of its allocations failing once, KLU's
 * among them: a call that failed says so, and made again it gives what it gives when nothing fails. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "retry.h"
#include "sparse/sparse_internal.h"
#include "wrap_alloc.h"

enum { TIMES_MAX = 4000, READINGS = 4 };

/* A gated switch and a diode onto an inductor, a capacitor taken down by a switch of its own voltage. */
static ns_circuit *circuit(void) {
    const ns_diode diode = {0, 0, INFINITY, INFINITY, 0};
    const ns_switch gated = {0.5, 0, 0, INFINITY}, own = {3, 1, 0, INFINITY};
    const ns_signal volts = {.kind = NS_DC, .u.dc = 10};
    ns_signal gate = {.kind = NS_PULSE}, sine = {.kind = NS_SIN};
    ns_circuit *c;
    gate.u.pulse.v2 = 1;
    gate.u.pulse.pw = 3e-6;
    gate.u.pulse.per = 1e-5;
    sine.u.sin.va = 1;
    sine.u.sin.freq = 1e5;
    TRY(ns_circuit_create(&c));
    TRY(ns_circuit_source(c, "vin", NS_VOLTAGE, 1, 0, &volts, NULL));
    TRY(ns_circuit_source(c, "vg", NS_VOLTAGE, 2, 0, &gate, NULL));
    TRY(ns_circuit_switch(c, "s1", 1, 3, 2, 0, &gated, NULL));
    TRY(ns_circuit_diode(c, "d", 0, 3, &diode, NULL));
    TRY(ns_circuit_inductor(c, "l", 3, 4, 1e-4, 0, NULL));
    TRY(ns_circuit_capacitor(c, "c", 4, 0, 1e-7, 0, NULL));
    TRY(ns_circuit_source(c, "i", NS_CURRENT, 4, 0, &sine, NULL));
    TRY(ns_circuit_resistor(c, "r", 4, 5, 10, NULL));
    TRY(ns_circuit_switch(c, "s2", 5, 0, 4, 0, &own, NULL));
    return c;
}

/* theta: of the steps of one length, 0: those of high order. */
static void scenario(double theta, double *out) {
    ns_circuit *c = circuit();
    ns_system *s;
    ns_engine *m;
    double x[8], w0[8], reached;
    /* hardly any memory for factors: they come and go */
    const ns_sparse_options o = {.h = theta > 0 ? 1e-6 : 1e-5, .reltol = 1e-9, .bytes = 1, .theta = theta};
    TRY(ns_circuit_system(c, &s));
    assert_true(s->n <= 8);
    TRY(ns_sparse_create(s, &o, &m, NULL));
    TRY(ns_circuit_rest(c, w0));
    TRY(m->table->start_dc(m, 0, 0, NULL, NULL, NULL));
    TRY(m->table->start(m, 0, w0, NULL));
    for (int i = 0; i < READINGS; i++) {
        TRY(m->table->try_to(m, 1.2e-5 * (i + 1), NS_TO_TIME, &reached));
        TRY(ns_engine_accept(m));
        TRY(ns_engine_read(m, NULL, x, NULL, NULL));
        out[i] = x[ns_circuit_node_unknown(c, 4)];
    }
    m->table->free(m);
    ns_system_free(s);
    ns_circuit_free(c);
}

/* Pivots may be those of another matrix than before: rounding differs. */
static void test_each(void **state) {
    const double theta = *(double *)*state;
    double whole[READINGS], now[READINGS];
    fail_alloc_in_suitesparse(1);
    fails = 0;
    scenario(theta, whole);
    assert_int_equal(fails, 0);
    for (long k = 1;; k++) {
        fails = 0;
        fail_alloc_at(k);
        scenario(theta, now);
        fail_alloc_off();
        if (fails == 0) {
            assert_true(k > 100);
            break;
        }
        assert_int_equal(fails, 1);
        for (int i = 0; i < READINGS; i++)
            assert_true(fabs(now[i] - whole[i]) <= 1e-7 * 10);
        assert_true(k < TIMES_MAX);
    }
    fail_alloc_in_suitesparse(0);
}

int main(void) {
    static double none, half = 0.5;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_prestate(test_each, &none),
        cmocka_unit_test_prestate(test_each, &half),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
