/* tests/unit/exact/test_scale_before.c - the left side of an event where one time scale of a mode ends.
 *
 * Between a diode that blocks and an open switch a node floats: leaks share the voltage, and they are not
 * alike in steps of all lengths.  10 V, the diode, the switch, 1 H and 60 ohm are in series.  The point where
 * a scale begins, seen from the left, is that of the scale before it.  Up to issue 20 it was that of the
 * new one, in which the diode (a thyristor at rest) may have several volts forward and block.
 */
#include "engine/dense_point.h"
#include "exact/exact.h"
#include "exact/exact_internal.h"
#include "rig.h"
#include "signals.h"

enum { IN = 1, MIDDLE, P, GATE, RC };
static const double h = 1e-6;

typedef struct bench {
    ns_circuit *c;
    ns_system *s;
    ns_theta *step;
    ns_dense_point point;
    ns_exact *exact;
    double X[64], x[64];
} bench;

static void ok(int status) {
    assert_int_equal(status, NS_OK);
}

static void open_bench(bench *b) {
    const ns_signal supply = dc(10), open = dc(0);
    const ns_switch contact = {.vt = 0.5, .vh = 0, .ron = 0, .roff = INFINITY};
    const ns_diode diode = {.vf = 0.5, .ron = 0, .roff = INFINITY, .vz = INFINITY};
    const ns_theta_options o = {1, 1, 0};
    *b = (bench){0};
    ok(ns_circuit_create(&b->c));
    ok(ns_circuit_source(b->c, "v", NS_VOLTAGE, IN, 0, &supply, NULL));
    ok(ns_circuit_source(b->c, "g", NS_VOLTAGE, GATE, 0, &open, NULL));
    ok(ns_circuit_diode(b->c, "d", IN, MIDDLE, &diode, NULL));
    ok(ns_circuit_switch(b->c, "s", MIDDLE, P, GATE, 0, &contact, NULL));
    ok(ns_circuit_inductor(b->c, "l", P, P + 8, 1, 0, NULL));
    ok(ns_circuit_resistor(b->c, "r", P + 8, 0, 60, NULL));
    ok(ns_circuit_resistor(b->c, "r2", IN, RC, 100, NULL));
    ok(ns_circuit_capacitor(b->c, "c", RC, 0, 1e-12, 0, NULL));
    ok(ns_circuit_system(b->c, &b->s));
    ok(ns_theta_create(b->s, &o, &b->step, NULL));
    b->point.flip = calloc((size_t)b->s->nc + 1, 1);
    ok(ns_exact_create(b->step, &b->point, h, &b->exact));
}

static void close_bench(bench *b) {
    ns_exact_free(b->exact);
    ns_theta_free(b->step);
    free(b->point.flip);
    ns_system_free(b->s);
    ns_circuit_free(b->c);
}

/* At rest, the diode blocks, the switch is open. */
static void place(bench *b) {
    double w[64] = {0};
    ns_mode mode[8];
    for (int j = 0; j < b->s->m; j++)
        mode[j] = NS_LOWER;
    ok(ns_theta_start(b->step, w, b->point.flip));
    ns_theta_set_mode(b->step, mode);
    ok(ns_exact_place(b->exact));
    memcpy(b->X, b->exact->X, sizeof(double) * (size_t)b->exact->state.mode->scale[0].kernel->q);
}

/* Volts across the diode so long (s) after the discontinuity. */
static double volts(bench *b, double since, ns_side side) {
    b->exact->state.now.t = since;
    ok(ns_exact_output_at(b->exact, since, side, b->X, b->x));
    return b->x[ns_circuit_node_unknown(b->c, IN)] - b->x[ns_circuit_node_unknown(b->c, MIDDLE)];
}

static void the_scale_that_led_there(void **state) {
    bench b;
    (void)state;
    open_bench(&b);
    place(&b);
    const ns_exact_mode *mode = b.exact->state.mode;
    assert_true(mode->scales > 1);
    int differ = 0;
    for (int i = 1; i < mode->scales; i++) {
        const double from = mode->scale[i].from, before = volts(&b, 0.9 * from, NS_RIGHT);
        assert_true(fabs(volts(&b, from, NS_LEFT) - before) <= 1e-9 * fabs(before));
        differ += fabs(volts(&b, from, NS_RIGHT) - before) > 0.1 * fabs(before);
    }
    assert_true(differ > 0); /* else this test shows nothing */
    close_bench(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_scale_that_led_there)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
