/* tests/property/test_energy.c - energy and charge of every element, by the library's own integration.
 *
 * What all elements take in adds up to zero (Tellegen), capacitors and inductors take what they store
 * (ns_circuit_stored()), and charges obey Kirchhoff's law at a node: over 1000 periods of a buck converter, a
 * charge pump whose charges jump, a rectifier, an LC ring, by each engine.  The quadrature is right to 1e-12
 * of a part; the engines keep currents and voltages to their own errors (exact: rounding; sparse: reltol =
 * 1e-11 a step).
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <time.h>

#include <cmocka.h>

#include "nonsmooth.h"
#include "runs.h"
#include "signals.h"

enum { MOST = 40, PERIODS = FEWER_IF_SANITIZED(1000) };

static const double closes = 1e-9; /* of all that was taken in or given out */

typedef struct bench {
    ns_circuit *c;
    ns_system *s;
    ns_march *m;
    ns_energy *e;
} bench;

static bench open_bench(void) {
    bench b = {0};
    assert_int_equal(ns_circuit_create(&b.c), NS_OK);
    return b;
}

static void close_bench(bench *b) {
    ns_energy_free(b->e);
    ns_march_free(b->m);
    ns_system_free(b->s);
    ns_circuit_free(b->c);
}

static int source(bench *b, const char *name, int p, ns_signal s) {
    int id;
    assert_int_equal(ns_circuit_source(b->c, name, NS_VOLTAGE, p, 0, &s, &id), NS_OK);
    return id;
}

static int resistor(bench *b, const char *name, int p, int n, double r) {
    int id;
    assert_int_equal(ns_circuit_resistor(b->c, name, p, n, r, &id), NS_OK);
    return id;
}

static int capacitor(bench *b, const char *name, int p, int n, double c, double v) {
    int id;
    assert_int_equal(ns_circuit_capacitor(b->c, name, p, n, c, v, &id), NS_OK);
    return id;
}

static int inductor(bench *b, const char *name, int p, int n, double l, double i) {
    int id;
    assert_int_equal(ns_circuit_inductor(b->c, name, p, n, l, i, &id), NS_OK);
    return id;
}

static int diode(bench *b, const char *name, int p, int n, double vf, double ron) {
    const ns_diode d = {vf, ron, INFINITY, INFINITY, 0};
    int id;
    assert_int_equal(ns_circuit_diode(b->c, name, p, n, &d, &id), NS_OK);
    return id;
}

static ns_signal sine(double v, double hz) {
    ns_signal s = {.kind = NS_SIN};
    s.u.sin.va = v;
    s.u.sin.freq = hz;
    return s;
}

static void start(bench *b, ns_method method, double h) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = h, .method = method, .reltol = 1e-11};
    double w0[MOST];
    assert_int_equal(ns_circuit_system(b->c, &b->s), NS_OK);
    assert_true(b->s->n <= MOST);
    assert_int_equal(ns_circuit_rest(b->c, w0), NS_OK);
    assert_int_equal(ns_march_create(b->s, &o, &b->m, NULL), NS_OK);
    assert_int_equal(ns_energy_create(b->c, 0, NULL, &b->e), NS_OK);
    assert_int_equal(ns_march_start(b->m, 0, w0), NS_OK);
    assert_int_equal(ns_energy_start(b->e, b->m), NS_OK);
}

static double joule_of(const bench *b, int id) {
    double joule;
    assert_int_equal(ns_energy_read(b->e, id, NULL, NULL, &joule), NS_OK);
    return joule;
}

static double charge_of(const bench *b, int id) {
    double q;
    assert_int_equal(ns_energy_read(b->e, id, NULL, &q, NULL), NS_OK);
    return q;
}

static double stored(const bench *b) {
    double x[MOST], all;
    assert_int_equal(ns_march_read(b->m, NULL, x, NULL, NULL), NS_OK);
    assert_int_equal(ns_circuit_stored(b->c, x, NULL, &all), NS_OK);
    return all;
}

static double seconds(void) {
    struct timespec t;
    timespec_get(&t, TIME_UTC);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Goes to t; what all elements took in, and less what was stored at the start and now, of all that passed. */
static void run(bench *b, const char *name, double t, double stored0, double allowed) {
    double sum = 0, kept = 0, passed = 0;
    const double begin = seconds();
    assert_int_equal(ns_energy_march(b->e, b->m, t), NS_OK);
    const double took = seconds() - begin;
    for (int k = 0; k < ns_energy_count(b->e); k++) {
        const double joule = joule_of(b, k);
        sum += joule;
        passed += fabs(joule) / 2;
    }
    for (int k = 0; k < ns_energy_count(b->e); k++) {
        double each[MOST], x[MOST];
        assert_int_equal(ns_march_read(b->m, NULL, x, NULL, NULL), NS_OK);
        assert_int_equal(ns_circuit_stored(b->c, x, each, NULL), NS_OK);
        kept += each[k] != 0 ? joule_of(b, k) : 0;
    }
    const double off = fabs(kept - (stored(b) - stored0));
    print_message(
        "%-22s %.3g J passed, sum %.1e, stored %.1e of it; %ld nodes, %.0f ns each with the march\n", name,
        passed, fabs(sum) / passed, off / passed, ns_energy_nodes(b->e),
        1e9 * took / (double)ns_energy_nodes(b->e));
    assert_true(fabs(sum) <= allowed * passed);
    assert_true(off <= allowed * passed);
}

static const ns_method method[] = {NS_EXACT, NS_SPARSE, NS_AUTO};
static const char *const method_name[] = {"exact", "sparse", "auto"};
enum { METHODS = 3 };

static const char *title(const char *circuit, int k) {
    static char line[64];
    snprintf(line, sizeof line, "%s, %s:", circuit, method_name[k]);
    return line;
}

/* 12 V, 100 kHz, D = 0.4, 100 uH, 10 uF, 5 ohm; ideal (loss) 0, 1: with drops. */
static void a_buck_converter(void **state) {
    (void)state;
    for (int k = 0; k < 2 * METHODS; k++) {
        const int loss = k / METHODS;
        const ns_switch sw = {0.5, 0, loss ? 0.1 : 0, loss ? 1e6 : INFINITY};
        bench b = open_bench();
        const int v = source(&b, "v", 1, dc(12));
        source(&b, "vg", 4, pulse(0, 1, 0, 10e-9, 10e-9, 4e-6, 10e-6));
        assert_int_equal(ns_circuit_switch(b.c, "s", 1, 2, 4, 0, &sw, NULL), NS_OK);
        const int d = diode(&b, "d", 0, 2, loss ? 0.7 : 0, loss ? 0.05 : 0);
        const int l = inductor(&b, "l", 2, 3, 100e-6, NAN), c = capacitor(&b, "c", 3, 0, 10e-6, NAN);
        const int r = resistor(&b, "r", 3, 0, 5);
        start(&b, method[k % METHODS], 1e-6);
        run(&b, title(loss ? "lossy buck" : "ideal buck", k % METHODS), PERIODS * 10e-6, 0, closes);
        const double q = charge_of(&b, l);
        assert_true(fabs(charge_of(&b, c) + charge_of(&b, r) - q) <= closes * q);
        assert_true(joule_of(&b, v) < 0 && joule_of(&b, r) > 0);
        if (!loss) /* an ideal diode takes nothing */
            assert_true(fabs(joule_of(&b, d)) <= closes * joule_of(&b, r));
        else
            assert_true(joule_of(&b, d) > 0.7 * charge_of(&b, d));
        close_bench(&b);
    }
}

/* Dickson's: three ideal diodes, three capacitors of 1 uF, two of them on opposite clocks of 5 V that jump.
 */
static void a_charge_pump(void **state) {
    (void)state;
    for (int k = 0; k < METHODS; k++) {
        bench b = open_bench();
        source(&b, "v", 1, dc(5));
        source(&b, "clk1", 2, pulse(0, 5, 0, 0, 0, 5e-6, 10e-6));
        source(&b, "clk2", 3, pulse(5, 0, 0, 0, 0, 5e-6, 10e-6));
        const int d1 = diode(&b, "d1", 1, 4, 0, 0);
        capacitor(&b, "c1", 4, 2, 1e-6, NAN);
        const int d2 = diode(&b, "d2", 4, 5, 0, 0);
        capacitor(&b, "c2", 5, 3, 1e-6, NAN);
        const int d3 = diode(&b, "d3", 5, 6, 0, 0);
        const int c3 = capacitor(&b, "c3", 6, 0, 1e-6, NAN);
        const int r = resistor(&b, "r", 6, 0, 1e3);
        start(&b, method[k], 1e-6);
        run(&b, title("charge pump", k), PERIODS * 10e-6, 0, closes);
        assert_true(ns_march_counts(b.m)->events >= 2 * PERIODS - 2);
        /* the same charge through all diodes, but for what capacitors keep; each takes energy */
        const double q = charge_of(&b, r);
        assert_true(fabs(charge_of(&b, d3) - charge_of(&b, c3) - q) <= closes * q);
        assert_true(joule_of(&b, d1) > 0 && joule_of(&b, d2) > 0 && joule_of(&b, d3) > 0);
        close_bench(&b);
    }
}

/* 50 Hz behind 1 ohm and 1 mH, four diodes of 0.7 V, 1 mF, 100 ohm. */
static void a_rectifier(void **state) {
    (void)state;
    for (int k = 0; k < METHODS; k++) {
        bench b = open_bench();
        source(&b, "v", 1, sine(20, 50));
        resistor(&b, "rs", 1, 2, 1);
        inductor(&b, "ls", 2, 3, 1e-3, NAN);
        diode(&b, "d1", 3, 4, 0.7, 1e-3);
        diode(&b, "d2", 0, 4, 0.7, 1e-3);
        diode(&b, "d3", 5, 3, 0.7, 1e-3);
        diode(&b, "d4", 5, 0, 0.7, 1e-3);
        capacitor(&b, "c", 4, 5, 1e-3, NAN);
        resistor(&b, "r", 4, 5, 100);
        start(&b, method[k], 1e-4);
        run(&b, title("rectifier", k), PERIODS * 20e-3, 0, closes);
        close_bench(&b);
    }
}

/* 1 nF at 10 V with 1 uH: 5 MHz, and 100 kohm across it, which takes 1 - exp(-t/RC) of 50 nJ in all. The
 * sparse engine errs by reltol in each of its 43,000 steps. */
static void a_ring(void **state) {
    (void)state;
    for (int k = 0; k < METHODS; k++) {
        bench b = open_bench();
        const double C = 1e-9, R = 100e3, t = PERIODS * 2e-7;
        capacitor(&b, "c", 1, 0, C, 10);
        inductor(&b, "l", 1, 0, 1e-6, NAN);
        const int r = resistor(&b, "r", 1, 0, R);
        start(&b, method[k], 1e-7);
        run(&b, title("ring", k), t, C / 2 * 100, method[k] == NS_SPARSE ? 43000 * 1e-11 : closes);
        assert_true(fabs(joule_of(&b, r) / (C / 2 * 100 * (1 - exp(-t / R / C))) - 1) < 1e-3);
        close_bench(&b);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_buck_converter),
        cmocka_unit_test(a_charge_pump),
        cmocka_unit_test(a_rectifier),
        cmocka_unit_test(a_ring),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
