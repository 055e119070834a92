/* tests/unit/sparse/test_bridges.c - bridges and converters by the sparse marcher where rounding is all there
 * is: gates that change within an ulp of each other, balances at rest; and a leg that shorts its supply. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "signals.h"

enum { SUPPLY = 1, LEFT, RIGHT, LOAD, GATE, OTHER, SECONDARY, CLAMP, OUT, MOST_X = 32 };
static const double period = 10e-6;

typedef struct scene {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    ns_diode diode;
    ns_switch contact;
} scene;

static void ok(int status) {
    assert_int_equal(status, NS_OK);
}

static void near(double a, double b, double tol) {
    if (!(fabs(a - b) <= tol))
        fail_msg("%.12g, not %.12g", a, b);
}

static void source(scene *k, const char *name, int p, ns_signal s) {
    ok(ns_circuit_source(k->c, name, NS_VOLTAGE, p, 0, &s, NULL));
}

static void open_scene(scene *k, double vf, double ron, double roff, double leak) {
    *k = (scene){.diode = {.vf = vf, .ron = ron, .roff = roff, .vz = INFINITY, .rz = 0},
                 .contact = {.vt = 0.5, .vh = 0, .ron = ron, .roff = leak}};
    ok(ns_circuit_create(&k->c));
    source(k, "v", SUPPLY, dc(24));
}

/* A leg from the supply to ground, a diode across each of its switches. */
static void add_leg(scene *k, int middle, int upper, int lower) {
    ok(ns_circuit_switch(k->c, middle == LEFT ? "s1" : "s3", SUPPLY, middle, upper, 0, &k->contact, NULL));
    ok(ns_circuit_diode(k->c, middle == LEFT ? "d1" : "d3", middle, SUPPLY, &k->diode, NULL));
    ok(ns_circuit_switch(k->c, middle == LEFT ? "s2" : "s4", middle, 0, lower, 0, &k->contact, NULL));
    ok(ns_circuit_diode(k->c, middle == LEFT ? "d2" : "d4", 0, middle, &k->diode, NULL));
}

/* Two legs, an inductor and a resistor between them; edges: of the gates, s. */
static void add_bridge(scene *k, double henry, double ohm, double edges, double on) {
    source(k, "g1", GATE, pulse(0, 1, 0, edges, edges, on, period));
    source(k, "g2", OTHER, pulse(0, 1, period / 2, edges, edges, on, period));
    add_leg(k, LEFT, GATE, OTHER);
    add_leg(k, RIGHT, OTHER, GATE);
    ok(ns_circuit_inductor(k->c, "l", LEFT, LOAD, henry, NAN, NULL));
    ok(ns_circuit_resistor(k->c, "r", LOAD, RIGHT, ohm, NULL));
}

static void start(scene *k, ns_method method) {
    const ns_march_options o = {
        .theta = 1, .gamma = 1, .h = 1e-6, .method = method, .whole = 1, .reltol = 1e-9};
    double w[MOST_X] = {0};
    ok(ns_circuit_system(k->c, &k->s));
    assert_true(k->s->n <= MOST_X);
    ns_circuit_rest(k->c, w);
    ok(ns_march_create(k->s, &o, &k->m, NULL));
    ok(ns_march_start(k->m, 0, w));
}

static int go(scene *k, double t) {
    double reached = 0;
    while (reached < t) {
        const int status = ns_march_try(k->m, t, NS_TO_TIME, &reached);
        if (status != NS_OK)
            return status;
        ok(ns_march_accept(k->m));
    }
    return NS_OK;
}

static double voltage(const scene *k, int node) {
    double x[MOST_X];
    ok(ns_march_read(k->m, NULL, x, NULL, NULL));
    return x[ns_circuit_node_unknown(k->c, node)];
}

static void end(scene *k) {
    ns_march_free(k->m);
    ns_system_free(k->s);
    ns_circuit_free(k->c);
}

/* i of L di/dt + R i = +-V, V the first half of each period, from rest. */
static double bridge_current(double henry, double ohm, double t) {
    const int halves = (int)ceil(t / (period / 2));
    double i = 0;
    for (int half = 0; half < halves; half++) {
        const double end = (half % 2 ? -24 : 24) / ohm, left = t - half * period / 2;
        i = end + (i - end) * exp(-ohm / henry * fmin(left, period / 2));
    }
    return i;
}

/* 13 periods in, 5 us + 13 * 10 us + 5 us is not 14 * 10 us: one leg was shorted for an ulp. */
static void gates_an_ulp_apart(void **state) {
    scene k;
    (void)state;
    open_scene(&k, 0, 0, 1e6, INFINITY);
    add_bridge(&k, 110e-6, 144, 0, period / 2);
    start(&k, NS_SPARSE);
    for (int step = 0; step < 57; step++) {
        const double t = 3e-6 + 7e-6 * step;
        ok(go(&k, t));
        near((voltage(&k, LOAD) - voltage(&k, RIGHT)) / 144, bridge_current(110e-6, 144, t), 1e-7);
    }
    end(&k);
}

/* Leaks hold both middles at half the supply: what is left across the load is rounding, at the start and
 * until the gate has risen to its middle. */
static void bridge_at_rest(void **state) {
    scene k;
    (void)state;
    for (int turn = 0; turn < 2; turn++) {
        open_scene(&k, turn ? 0.7 : 0, turn ? 0 : 0.01, turn ? INFINITY : 1e6, 1e6);
        add_bridge(&k, turn ? 44.6547264e-6 : 93.4950972e-6, turn ? 3.32898526 : 477.424193, 10e-9, 4.8e-6);
        start(&k, NS_SPARSE);
        ok(go(&k, 4e-9));
        near(voltage(&k, LEFT), 12, 1e-6);
        near(voltage(&k, LOAD) - voltage(&k, RIGHT), 0, 1e-9);
        ok(go(&k, 30e-6));
        end(&k);
    }
}

/* A flyback whose switch closes after 8.6 us: until then nothing flows. */
static void flyback_at_rest(void **state) {
    scene k;
    int first, second;
    (void)state;
    open_scene(&k, 0.5, 0.01, 1e6, INFINITY);
    source(&k, "g", GATE, pulse(0, 1, 8.6e-6, 10e-9, 10e-9, 1.26e-6, period));
    ok(ns_circuit_inductor(k.c, "l1", SUPPLY, LEFT, 120e-6, NAN, &first));
    ok(ns_circuit_inductor(k.c, "l2", 0, SECONDARY, 312e-6, NAN, &second));
    ok(ns_circuit_coupling(k.c, "k", first, second, 0.95, NULL));
    ok(ns_circuit_switch(k.c, "s", LEFT, 0, GATE, 0, &k.contact, NULL));
    ok(ns_circuit_diode(k.c, "d1", LEFT, CLAMP, &k.diode, NULL));
    ok(ns_circuit_capacitor(k.c, "c1", CLAMP, SUPPLY, 10e-9, NAN, NULL));
    ok(ns_circuit_resistor(k.c, "r1", CLAMP, SUPPLY, 1e3, NULL));
    ok(ns_circuit_diode(k.c, "d2", SECONDARY, OUT, &k.diode, NULL));
    ok(ns_circuit_capacitor(k.c, "c2", OUT, 0, 882e-9, NAN, NULL));
    ok(ns_circuit_resistor(k.c, "r2", OUT, 0, 56, NULL));
    start(&k, NS_SPARSE);
    ok(go(&k, 8e-6));
    near(voltage(&k, LEFT), 24, 1e-9);
    near(voltage(&k, OUT), 0, 1e-9);
    assert_true(ns_march_counts(k.m)->steps < 100);
    end(&k);
}

/* Gates that overlap by their edges: no currents there are; the switches and diodes of a loop are named, and
 * not a diode that conducts 23.5 mA beside it, pair 0. */
static void shorted_supply(void **state) {
    scene k;
    (void)state;
    open_scene(&k, 0.5, 0, INFINITY, 1e6);
    ok(ns_circuit_resistor(k.c, "rq", SUPPLY, CLAMP, 1e3, NULL));
    ok(ns_circuit_diode(k.c, "dq", CLAMP, 0, &k.diode, NULL));
    add_bridge(&k, 180e-6, 1.5, 10e-9, period / 2);
    start(&k, NS_SPARSE);
    assert_int_equal(go(&k, 8e-6), NS_E_INFEASIBLE);
    const ns_fault *f = ns_march_fault(k.m);
    near(f->t, 5.005e-6, 1e-9);
    assert_true(f->npairs >= 2);
    for (int i = 0; i < f->npairs; i++)
        assert_true(f->pair[i] > 0 && f->pair[i] < k.s->m);
    end(&k);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(gates_an_ulp_apart), cmocka_unit_test(bridge_at_rest),
                                       cmocka_unit_test(flyback_at_rest), cmocka_unit_test(shorted_supply)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
