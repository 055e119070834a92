/* tests/unit/energy/test_energy.c - charge and energy by hand, jumps in closed form, refusals. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "energy/energy_internal.h"
#include "nonsmooth.h"
#include "signals.h"
#include "wrap_alloc.h"

enum { MOST = 16 };

static const ns_diode diode = {0, 0, INFINITY, INFINITY, 0};
static const ns_switch contact = {0.5, 0, 0, INFINITY};

static void expect(const ns_energy *e, int k, double q, double joule, double off) {
    double got_q, got_joule;
    assert_int_equal(ns_energy_read(e, k, NULL, &got_q, &got_joule), NS_OK);
    if (!(fabs(got_q - q) <= off * fabs(q) && fabs(got_joule - joule) <= off * fabs(joule)))
        fail_msg("element %d: %.17g C, %.17g J in place of %.17g, %.17g", k, got_q, got_joule, q, joule);
}

/* 2 ohm and 3 F, and a current source that jumps from 1 A to 5 A at 1 s, from node 1 to ground.  Nodes of
 * 0.25 s at 4 V and 0.5 s at 6 V: all numbers exact. */
static void nodes_by_hand(void **state) {
    (void)state;
    ns_circuit *c;
    ns_system *s;
    ns_energy *e;
    ns_signal i = pulse(1, 5, 1, 0, 0, 9, INFINITY);
    const int ids[] = {0, 2, 1};
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_resistor(c, "r", 1, 0, 2, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c", 1, 0, 3, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_source(c, "i", NS_CURRENT, 1, 0, &i, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_int_equal(ns_energy_create(c, 3, ids, &e), NS_OK);
    assert_int_equal(ns_energy_count(e), 3);
    double v = 4, rate = 0.5, p;
    ns_solution at = {0, NS_RIGHT, &v, NULL, &rate};
    for (int again = 0; again < 2; again++) { /* begins at zero again */
        v = 4;
        at.t = 0;
        assert_int_equal(ns_energy_begin(e, &at), NS_OK);
        assert_int_equal(ns_energy_add(e, 0.25, &at), NS_OK);
        v = 6;
        at.t = 1;
        assert_int_equal(ns_energy_add(e, 0.5, &at), NS_OK);
        assert_int_equal(ns_energy_point(e, &at), NS_OK);
    }
    expect(e, 0, 0.25 * 2 + 0.5 * 3, 0.25 * 8 + 0.5 * 18, 0);
    expect(e, 1, 0.25 * 1 + 0.5 * 5, 0.25 * 4 + 0.5 * 30, 0);
    expect(e, 2, 3 * 2, 3.0 / 2 * (36 - 16), 0);
    assert_int_equal(ns_energy_read(e, 0, &p, NULL, NULL), NS_OK);
    assert_true(p == 18);
    assert_int_equal(ns_energy_read(e, 2, &p, NULL, NULL), NS_OK);
    assert_true(p == 3 * 0.5 * 6);
    at.rates = NULL;
    assert_int_equal(ns_energy_point(e, &at), NS_OK);
    assert_int_equal(ns_energy_read(e, 2, &p, NULL, NULL), NS_OK);
    assert_true(isnan(p));
    assert_int_equal(ns_energy_nodes(e), 4);
    ns_energy_free(e);
    ns_system_free(s);
    ns_circuit_free(c);
}

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

static void run(bench *b, ns_method method) {
    const ns_march_options o = {.theta = 1, .gamma = 1, .h = 1e-7, .method = method};
    double w0[MOST];
    assert_int_equal(ns_circuit_system(b->c, &b->s), NS_OK);
    assert_true(b->s->n <= MOST);
    assert_int_equal(ns_circuit_rest(b->c, w0), NS_OK);
    assert_int_equal(ns_march_create(b->s, &o, &b->m, NULL), NS_OK);
    assert_int_equal(ns_energy_create(b->c, 0, NULL, &b->e), NS_OK);
    assert_int_equal(ns_energy_march(b->e, b->m, 1e-6), NS_E_STATE);
    assert_int_equal(ns_march_start(b->m, 0, w0), NS_OK);
    assert_int_equal(ns_energy_start(b->e, b->m), NS_OK);
    assert_int_equal(ns_energy_march(b->e, b->m, 2e-6), NS_OK);
}

static void close_bench(bench *b) {
    ns_energy_free(b->e);
    ns_march_free(b->m);
    ns_system_free(b->s);
    ns_circuit_free(b->c);
}

static int gate(bench *b, double v1, double v2) {
    const ns_signal s = pulse(v1, v2, 1e-6, 0, 0, 1, INFINITY);
    int id;
    assert_int_equal(ns_circuit_source(b->c, "vg", NS_VOLTAGE, 9, 0, &s, &id), NS_OK);
    return id;
}

static const ns_method method[] = {NS_EXACT, NS_SPARSE, NS_THETA};
enum { METHODS = 3 };

/* 1 uF at 10 V onto 3 uF at 2 V: 6 uC, and 4 V mean of that, in the device: at a start, by a diode; later, by
 * a switch. */
static void two_capacitors(void **state) {
    (void)state;
    for (int k = 0; k < 2 * METHODS; k++) {
        bench b = open_bench();
        assert_int_equal(ns_circuit_capacitor(b.c, "c1", 1, 0, 1e-6, 10, NULL), NS_OK);
        assert_int_equal(ns_circuit_capacitor(b.c, "c2", 2, 0, 3e-6, 2, NULL), NS_OK);
        if (k < METHODS)
            assert_int_equal(ns_circuit_diode(b.c, "d", 1, 2, &diode, NULL), NS_OK);
        else
            assert_int_equal(ns_circuit_switch(b.c, "s", 1, 2, 9, 0, &contact, NULL), NS_OK);
        gate(&b, 0, 1);
        run(&b, method[k % METHODS]);
        expect(b.e, 0, -6e-6, 1e-6 / 2 * (16 - 100), 1e-12);
        expect(b.e, 1, 6e-6, 3e-6 / 2 * (16 - 4), 1e-12);
        expect(b.e, 2, 6e-6, 24e-6, 1e-11);
        close_bench(&b);
    }
}

/* 8 V jump behind 1 uF, which pushes 6 uC through a diode into 3 uF: at 8 V the source gives 48 uJ; the
 * capacitors keep 18 uJ (1 uF at -6 V) and 6 uJ (3 uF at 2 V); the diode, at 8 V when it begins, takes 24 uJ.
 * Another 1 uF right across the source follows it without loss: then sources are as before the jump, all at
 * half the voltage. */
static void a_source_that_jumps(void **state) {
    (void)state;
    for (int k = 0; k < METHODS; k++) {
        bench b = open_bench();
        const int v = gate(&b, 0, 8);
        assert_int_equal(ns_circuit_capacitor(b.c, "c1", 2, 9, 1e-6, 0, NULL), NS_OK);
        assert_int_equal(ns_circuit_diode(b.c, "d", 2, 3, &diode, NULL), NS_OK);
        assert_int_equal(ns_circuit_capacitor(b.c, "c2", 3, 0, 3e-6, 0, NULL), NS_OK);
        run(&b, method[k]);
        expect(b.e, v, -6e-6, -48e-6, 1e-11);
        expect(b.e, 1, -6e-6, 18e-6, 1e-11);
        expect(b.e, 2, 6e-6, 24e-6, 1e-11);
        expect(b.e, 3, 6e-6, 6e-6, 1e-11);
        close_bench(&b);
    }
    for (int k = 0; k < METHODS; k++) {
        bench b = open_bench();
        const int v = gate(&b, 0, 8);
        assert_int_equal(ns_circuit_capacitor(b.c, "c1", 9, 0, 1e-6, 0, NULL), NS_OK);
        run(&b, method[k]);
        expect(b.e, v, -8e-6, -32e-6, 1e-11);
        expect(b.e, 1, 8e-6, 32e-6, 1e-11);
        close_bench(&b);
    }
}

/* 1 mH with 2 A is cut by a switch, and a diode leads into 3 mH: 0.5 A, flux 1.5 mWb across the switch, which
 * takes 1 A of that: 1.5 mJ. */
static void a_cut_inductor(void **state) {
    (void)state;
    for (int k = 0; k < METHODS; k++) {
        bench b = open_bench();
        double joule, left = 1e-3 / 2 * 4;
        gate(&b, 1, 0);
        assert_int_equal(ns_circuit_inductor(b.c, "l1", 0, 1, 1e-3, 2, NULL), NS_OK);
        assert_int_equal(ns_circuit_switch(b.c, "s", 1, 0, 9, 0, &contact, NULL), NS_OK);
        assert_int_equal(ns_circuit_diode(b.c, "d", 1, 2, &diode, NULL), NS_OK);
        assert_int_equal(ns_circuit_inductor(b.c, "l2", 2, 0, 3e-3, 0, NULL), NS_OK);
        run(&b, method[k]);
        const double want[] = {0, 1e-3 / 2 * (0.25 - 4), 1.5e-3, 0, 3e-3 / 2 * 0.25};
        for (int i = 0; i < 5; i++) {
            assert_int_equal(ns_energy_read(b.e, i, NULL, NULL, &joule), NS_OK);
            assert_true(fabs(joule - want[i]) <= 1e-11 * left);
        }
        close_bench(&b);
    }
}

/* 1 uF at 10 V and 3 uF at 2 V, as another marcher had them, joined by a diode: as two_capacitors(), though
 * the initial conditions say 0 V. */
static void where_another_was(void **state) {
    (void)state;
    for (int k = 0; k < METHODS; k++) {
        bench b = open_bench();
        assert_int_equal(ns_circuit_capacitor(b.c, "c1", 1, 0, 1e-6, 0, NULL), NS_OK);
        assert_int_equal(ns_circuit_capacitor(b.c, "c2", 2, 0, 3e-6, 0, NULL), NS_OK);
        assert_int_equal(ns_circuit_diode(b.c, "d", 1, 2, &diode, NULL), NS_OK);
        run(&b, method[k]);
        double x[MOST] = {0}, w[MOST];
        const double lambda[MOST] = {0};
        x[ns_circuit_node_unknown(b.c, 1)] = 10;
        x[ns_circuit_node_unknown(b.c, 2)] = 2;
        ns_system_charges(b.s, x, w);
        assert_int_equal(ns_march_start(b.m, 1, w), NS_OK);
        assert_int_equal(ns_energy_start_from(b.e, b.m, NULL, lambda), NS_E_NULL);
        assert_int_equal(ns_energy_start_from(b.e, b.m, x, k ? lambda : NULL), NS_OK);
        assert_int_equal(ns_energy_march(b.e, b.m, 1 + 1e-6), NS_OK);
        expect(b.e, 0, -6e-6, 1e-6 / 2 * (16 - 100), 1e-12);
        expect(b.e, 1, 6e-6, 3e-6 / 2 * (16 - 4), 1e-12);
        expect(b.e, 2, 6e-6, 24e-6, 1e-11);
        close_bench(&b);
    }
}

/* 1 mF at 10 V and 1 ohm, at last short-circuited by a switch, taken in in seven parts of each way: as all at
 * once. */
static void a_way_in_parts(void **state) {
    (void)state;
    for (int k = 0; k < METHODS; k++) {
        bench b = open_bench();
        assert_int_equal(ns_circuit_capacitor(b.c, "c", 1, 0, 1e-3, 10, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 0, 1, NULL), NS_OK);
        assert_int_equal(ns_circuit_switch(b.c, "s", 1, 0, 9, 0, &contact, NULL), NS_OK);
        gate(&b, 0, 1);
        run(&b, method[k]);
        double q, joule, through, lost, from = 0;
        assert_int_equal(ns_energy_read(b.e, 1, NULL, &q, &joule), NS_OK);
        assert_int_equal(ns_energy_read(b.e, 2, NULL, &through, &lost), NS_OK);
        assert_true(q > 9.9e-6 && joule > 99e-6);
        const double w0[MOST] = {1e-3 * 10};
        assert_int_equal(ns_circuit_node_unknown(b.c, 1), 0);
        assert_int_equal(ns_march_start(b.m, 0, w0), NS_OK);
        assert_int_equal(ns_energy_start(b.e, b.m), NS_OK);
        for (int trial = 0; from < 2e-6 && trial < 1000; trial++) {
            double to;
            assert_int_equal(ns_march_try(b.m, 2e-6, NS_TO_STEP, &to), NS_OK);
            for (int part = to > from ? 1 : 7; part <= 7; part++)
                assert_int_equal(ns_energy_take(b.e, b.m, part < 7 ? from + (to - from) * part / 7 : to),
                                 NS_OK);
            assert_int_equal(ns_march_accept(b.m), NS_OK);
            from = to;
        }
        expect(b.e, 1, q, joule, 1e-12);
        expect(b.e, 2, through, lost, 1e-12);
        close_bench(&b);
    }
}

/* 1 uF from node 1, said to be at 10 V, to node 2, at 4 V, discharges through a diode: 6 uC, at 3 V in the
 * mean.
 */
static void voltages_of_nodes_at_a_start(void **state) {
    (void)state;
    for (int k = 0; k < METHODS; k++) {
        bench b = open_bench();
        assert_int_equal(ns_circuit_capacitor(b.c, "c", 1, 2, 1e-6, NAN, NULL), NS_OK);
        assert_int_equal(ns_circuit_diode(b.c, "d", 1, 2, &diode, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(b.c, "r", 2, 0, 1, NULL), NS_OK);
        assert_int_equal(ns_circuit_node_ic(b.c, 1, 10), NS_OK);
        assert_int_equal(ns_circuit_node_ic(b.c, 2, 4), NS_OK);
        run(&b, method[k]);
        expect(b.e, 0, -6e-6, -18e-6, 1e-11);
        expect(b.e, 1, 6e-6, 18e-6, 1e-11);
        close_bench(&b);
    }
}

/* A source that jumps to 8 unit V right across 1 uF: half of the voltage times the charge, however small. */
static void a_source_that_jumps_by_little(void **state) {
    (void)state;
    for (int k = 0; k < METHODS; k++) {
        const double unit = 1e-10;
        bench b = open_bench();
        const int v = gate(&b, 0, 8 * unit);
        assert_int_equal(ns_circuit_capacitor(b.c, "c1", 9, 0, 1e-6, 0, NULL), NS_OK);
        run(&b, method[k]);
        expect(b.e, v, -8e-6 * unit, -32e-6 * unit * unit, 1e-11);
        expect(b.e, 1, 8e-6 * unit, 32e-6 * unit * unit, 1e-11);
        close_bench(&b);
    }
}

/* 1 and 1000 times 1e-17, less 1, either way round: 1e-14. */
static void sums_lose_nothing(void **state) {
    (void)state;
    for (int way = 0; way < 2; way++) {
        ns_sum s = {0, 0};
        ns_energy_sum(&s, way ? 1e-17 : 1);
        for (int k = 1; k < 1000; k++)
            ns_energy_sum(&s, k == 500 && way ? 1 : 1e-17);
        ns_energy_sum(&s, 1e-17);
        ns_energy_sum(&s, -1);
        assert_true(fabs(s.sum + s.lost - 1e-14) < 1e-26);
    }
}

/* 1 uF at 10 V over 1 ohm: after 2 us 10 exp(-2) V, and so much power. */
static void power_at_the_end(void **state) {
    (void)state;
    for (int k = 0; k < METHODS; k++) {
        const double watts = 100 * exp(-4);
        bench b = open_bench();
        double p;
        assert_int_equal(ns_circuit_capacitor(b.c, "c", 1, 0, 1e-6, 10, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 0, 1, NULL), NS_OK);
        run(&b, method[k]);
        assert_int_equal(ns_energy_read(b.e, 1, &p, NULL, NULL), NS_OK);
        assert_true(fabs(p - watts) < (method[k] == NS_THETA ? 0.3 : 1e-4) * watts); /* steps of 0.1 us */
        close_bench(&b);
    }
}

/* The same to 10 ms in one way: 50 uJ and 10 uC, all at its begin.  (The scheme's steps are 0.1 us.) */
static void a_transient_on_a_long_way(void **state) {
    (void)state;
    for (int k = 0; method[k] != NS_THETA; k++) {
        bench b = open_bench();
        assert_int_equal(ns_circuit_capacitor(b.c, "c", 1, 0, 1e-6, 10, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 0, 1, NULL), NS_OK);
        run(&b, method[k]);
        assert_int_equal(ns_energy_march(b.e, b.m, 10e-3), NS_OK);
        expect(b.e, 1, 10e-6, 50e-6, 1e-6);
        close_bench(&b);
    }
}

static void refusals(void **state) {
    (void)state;
    bench b = open_bench();
    ns_energy *e = (ns_energy *)&b;
    const int none = 1;
    double p, x[MOST] = {0};
    const ns_solution at = {0, NS_RIGHT, x, x, NULL};
    assert_int_equal(ns_circuit_diode(b.c, "d", 1, 0, &diode, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(b.c, &b.s), NS_OK);
    assert_int_equal(ns_energy_create(b.c, 1, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_energy_create(NULL, 1, NULL, &e), NS_E_NULL);
    assert_null(e);
    assert_int_equal(ns_energy_create(b.c, 1, &none, &e), NS_E_SIZE);
    assert_int_equal(ns_energy_create(b.c, -1, &none, &e), NS_E_SIZE);
    assert_int_equal(ns_energy_create(b.c, 0, NULL, &e), NS_OK);
    assert_int_equal(ns_energy_read(e, 1, &p, NULL, NULL), NS_E_SIZE);
    assert_int_equal(ns_energy_read(e, -1, &p, NULL, NULL), NS_E_SIZE);
    assert_int_equal(ns_energy_read(NULL, 0, &p, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_energy_begin(NULL, &at), NS_E_NULL);
    assert_int_equal(ns_energy_begin(e, NULL), NS_E_NULL);
    assert_int_equal(ns_energy_add(e, 1, NULL), NS_E_NULL);
    assert_int_equal(ns_energy_point(NULL, &at), NS_E_NULL);
    assert_int_equal(ns_energy_jump(e, &at, NULL, x, x), NS_E_NULL);
    assert_int_equal(ns_energy_start(e, NULL), NS_E_NULL);
    assert_int_equal(ns_energy_march(e, NULL, 1), NS_E_NULL);
    assert_int_equal(ns_energy_count(NULL), 0);
    assert_int_equal(ns_energy_nodes(NULL), 0);
    ns_energy_free(e);
    ns_energy_free(NULL);
    ns_system_free(b.s);
    ns_circuit_free(b.c);
}

static void no_memory(void **state) {
    (void)state;
    bench b = open_bench();
    gate(&b, 0, 1);
    assert_int_equal(ns_circuit_capacitor(b.c, "c", 9, 0, 1e-6, 10, NULL), NS_OK);
    run(&b, NS_EXACT);
    for (long k = 1;; k++) {
        ns_energy *e;
        fail_alloc_at(k);
        int status = ns_energy_create(b.c, 0, NULL, &e);
        if (status == NS_OK)
            status = ns_energy_start(e, b.m);
        const long made = allocs_made();
        fail_alloc_off();
        ns_energy_free(e);
        if (made < k)
            break;
        assert_int_equal(status, NS_E_MEMORY);
    }
    close_bench(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nodes_by_hand),
        cmocka_unit_test(two_capacitors),
        cmocka_unit_test(a_source_that_jumps),
        cmocka_unit_test(a_cut_inductor),
        cmocka_unit_test(sums_lose_nothing),
        cmocka_unit_test(power_at_the_end),
        cmocka_unit_test(a_transient_on_a_long_way),
        cmocka_unit_test(voltages_of_nodes_at_a_start),
        cmocka_unit_test(a_source_that_jumps_by_little),
        cmocka_unit_test(where_another_was),
        cmocka_unit_test(a_way_in_parts),
        cmocka_unit_test(refusals),
        cmocka_unit_test(no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
