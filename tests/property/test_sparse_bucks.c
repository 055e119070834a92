/* tests/property/test_sparse_bucks.c - random buck converters by the sparse marcher against flight.
 *
 * The supply jumps, the freewheel diode has a drop, the gate is timed: at each closing of the switch supply,
 * switch and diode are a loop of sources that contradict each other until the diode opens.  Beside it, a
 * rectifier and a switched filter at the same supply, or not.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "dice.h"
#include "nonsmooth.h"
#include "signals.h"

enum { RUNS = 1000, INSTANTS = 10, MOST_X = 32, SUPPLY = 1, NODE, OUT, GATE, PEAK, CHOPPED, FILTERED };
static const double period = 16.8e-6, end = 200e-6;

typedef struct buck {
    double l, c, r, delay, on; /* H, F, ohm, s, s */
    int beside;                /* 0 .. 2 parts */
} buck;

static buck draw(unsigned long long seed) {
    dice d = dice_make(17, seed);
    buck b;
    b.l = dice_decades(&d, -5, -3);
    b.c = dice_decades(&d, -7, -4);
    b.r = dice_decades(&d, 0, 3);
    b.delay = 10e-6 * dice_uniform(&d);
    b.on = 10e-6 * (0.1 + 0.5 * dice_uniform(&d));
    b.beside = dice_below(&d, 3);
    return b;
}

static const ns_switch contact = {.vt = 0.5, .vh = 0, .ron = 0, .roff = INFINITY};

static void add_rectifier(ns_circuit *c) {
    const ns_diode ideal = {.vf = 0, .ron = 0, .roff = INFINITY, .vz = INFINITY};
    assert_int_equal(ns_circuit_diode(c, "d2", SUPPLY, PEAK, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c2", PEAK, 0, 650e-9, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r2", PEAK, 0, 813, NULL), NS_OK);
}

static void add_filter(ns_circuit *c) {
    assert_int_equal(ns_circuit_switch(c, "s3", SUPPLY, CHOPPED, GATE, 0, &contact, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r3", CHOPPED, FILTERED, 2.4, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c3", FILTERED, 0, 290e-9, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r4", FILTERED, 0, 26, NULL), NS_OK);
}

static ns_circuit *build(const buck *b) {
    const ns_diode drop = {.vf = 0.5, .ron = 0, .roff = INFINITY, .vz = INFINITY};
    const ns_signal supply = pulse(10, 20, 3.2e-6, 0, 0, 4e-6, 20e-6),
                    gate = pulse(0, 1, b->delay, 10e-9, 10e-9, b->on, period);
    ns_circuit *c;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v", NS_VOLTAGE, SUPPLY, 0, &supply, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(c, "g", NS_VOLTAGE, GATE, 0, &gate, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(c, "s", SUPPLY, NODE, GATE, 0, &contact, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d", 0, NODE, &drop, NULL), NS_OK);
    assert_int_equal(ns_circuit_inductor(c, "l", NODE, OUT, b->l, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c", OUT, 0, b->c, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r", OUT, 0, b->r, NULL), NS_OK);
    if (b->beside > 0)
        add_rectifier(c);
    if (b->beside > 1)
        add_filter(c);
    return c;
}

/* out (INSTANTS): the output, V. */
static void run(const buck *b, ns_method method, double *out) {
    const ns_march_options o = {
        .theta = 1, .gamma = 1, .h = 1e-6, .method = method, .whole = 1, .reltol = 1e-10};
    double w[MOST_X] = {0}, x[MOST_X], t = 0;
    ns_circuit *c = build(b);
    ns_system *s;
    ns_march *m;
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_true(s->n <= MOST_X);
    ns_circuit_rest(c, w);
    assert_int_equal(ns_march_create(s, &o, &m, NULL), NS_OK);
    assert_int_equal(ns_march_start(m, 0, w), NS_OK);
    for (int k = 0; k < INSTANTS; k++) {
        const double to = end * (k + 1) / INSTANTS;
        while (t < to) {
            assert_int_equal(ns_march_try(m, to, NS_TO_TIME, &t), NS_OK);
            assert_int_equal(ns_march_accept(m), NS_OK);
        }
        assert_int_equal(ns_march_read(m, NULL, x, NULL, NULL), NS_OK);
        out[k] = x[ns_circuit_node_unknown(c, OUT)];
    }
    ns_march_free(m);
    ns_system_free(s);
    ns_circuit_free(c);
}

static void bucks(void **state) {
    double worst = 0;
    (void)state;
    for (unsigned long long seed = 1; seed <= RUNS; seed++) {
        const buck b = draw(seed);
        double exact[INSTANTS], got[INSTANTS];
        run(&b, NS_FLIGHT, exact);
        run(&b, NS_SPARSE, got);
        for (int k = 0; k < INSTANTS; k++) {
            const double off = fabs(got[k] - exact[k]);
            if (!(off < 1e-6))
                fail_msg("buck %llu at %g s: %.9g V by sparse, %.9g V by flight", seed,
                         end * (k + 1) / INSTANTS, got[k], exact[k]);
            worst = fmax(worst, off);
        }
    }
    printf("%d bucks, at most %.1e V off\n", RUNS, worst);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(bucks)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
