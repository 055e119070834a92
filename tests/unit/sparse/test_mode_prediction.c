/* tests/unit/sparse/test_mode_prediction.c - events that go as they went the last time cost no search for a
 * mode. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "nonsmooth.h"

enum { CELLS = 40 };
static const double period = 100e-6;

static void add_sources(ns_circuit *c, int in, int gate) {
    const ns_signal volts = {.kind = NS_DC, .u.dc = 10};
    const ns_signal up_and_down = {
        .kind = NS_PULSE,
        .u.pulse = {.v1 = 1, .v2 = 0, .tr = period / 2, .tf = period / 2 - 1e-9, .pw = 1e-9, .per = period}};
    assert_int_equal(ns_circuit_source(c, "v", NS_VOLTAGE, in, 0, &volts, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(c, "g", NS_VOLTAGE, gate, 0, &up_and_down, NULL), NS_OK);
}

/* Cells of 100 ohm and 10 nF, behind a switch to ground 1 kohm; one triangle closes the switches one by one,
 * and opens them again. */
static ns_circuit *ladder(void) {
    const int in = 2 * CELLS + 1, gate = in + 1;
    ns_circuit *c;
    char name[24];
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    add_sources(c, in, gate);
    for (int k = 1; k <= CELLS; k++) {
        const ns_switch to_ground = {.vt = (k - 0.5) / CELLS, .roff = INFINITY};
        (void)snprintf(name, sizeof name, "r%d", k);
        assert_int_equal(ns_circuit_resistor(c, name, k == 1 ? in : k - 1, k, 100, NULL), NS_OK);
        (void)snprintf(name, sizeof name, "c%d", k);
        assert_int_equal(ns_circuit_capacitor(c, name, k, 0, 10e-9, NAN, NULL), NS_OK);
        (void)snprintf(name, sizeof name, "q%d", k);
        assert_int_equal(ns_circuit_resistor(c, name, k, CELLS + k, 1e3, NULL), NS_OK);
        (void)snprintf(name, sizeof name, "s%d", k);
        assert_int_equal(ns_circuit_switch(c, name, CELLS + k, 0, gate, 0, &to_ground, NULL), NS_OK);
    }
    return c;
}

/* Coils of 1 mH and 10 ohm, each behind a switch to 10 V with a diode to ground, which the same triangle
 * opens one by one, and closes. */
static ns_circuit *choppers(void) {
    const ns_diode ideal = {0, 0, INFINITY, INFINITY, 0};
    const int in = 2 * CELLS + 1, gate = in + 1, rail = in + 2;
    ns_circuit *c;
    char name[24];
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    add_sources(c, rail, gate);
    assert_int_equal(ns_circuit_resistor(c, "r", rail, in, 0.1, NULL), NS_OK);
    for (int k = 1; k <= CELLS; k++) {
        const ns_switch from_supply = {.vt = (k - 0.5) / CELLS, .roff = INFINITY};
        (void)snprintf(name, sizeof name, "s%d", k);
        assert_int_equal(ns_circuit_switch(c, name, in, k, gate, 0, &from_supply, NULL), NS_OK);
        (void)snprintf(name, sizeof name, "d%d", k);
        assert_int_equal(ns_circuit_diode(c, name, 0, k, &ideal, NULL), NS_OK);
        (void)snprintf(name, sizeof name, "l%d", k);
        assert_int_equal(ns_circuit_inductor(c, name, k, CELLS + k, 1e-3, NAN, NULL), NS_OK);
        (void)snprintf(name, sizeof name, "r%d", k);
        assert_int_equal(ns_circuit_resistor(c, name, CELLS + k, 0, 10, NULL), NS_OK);
    }
    return c;
}

/* What so many periods of it cost by steps of at most h. */
static ns_counts run(ns_circuit *c, double periods, double h) {
    const ns_march_options o = {.h = h, .method = NS_SPARSE, .reltol = 1e-3, .theta = 1, .gamma = 1};
    ns_system *s;
    ns_march *m;
    double reached;
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    double *w = calloc((size_t)s->n + 1, sizeof *w);
    assert_non_null(w);
    assert_int_equal(ns_circuit_rest(c, w), NS_OK);
    assert_int_equal(ns_march_start(m, 0, w), NS_OK);
    assert_int_equal(ns_march_try(m, periods * period, NS_TO_TIME, &reached), NS_OK);
    assert_int_equal(ns_march_accept(m), NS_OK);
    const ns_counts counts = *ns_march_counts(m);
    free(w);
    ns_march_free(m);
    ns_system_free(s);
    ns_circuit_free(c);
    return counts;
}

/* Nothing else changes with a switch, which is soon expected of those that were never seen, too: in the first
 * period most events are taken so, in the second nearly all. */
static void test_alone(void **state) {
    (void)state;
    const ns_counts counts = run(ladder(), 2, period / CELLS);
    assert_int_equal(counts.events, 4 * CELLS);
    assert_true(counts.problems < CELLS / 4);
}

/* A diode takes over from each switch that opens, each for the first time: nearly all are found by steps as
 * long as those of legs. */
static void test_sought(void **state) {
    (void)state;
    const ns_counts counts = run(choppers(), 0.5, period / CELLS);
    assert_int_equal(counts.events, CELLS);
    assert_true(counts.problems < CELLS / 4);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_alone), cmocka_unit_test(test_sought)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
