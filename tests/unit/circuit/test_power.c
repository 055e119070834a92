/* tests/unit/circuit/test_power.c - voltage, current and power of each kind of element; energy stored.
 *
 * Tellegen: where Kirchhoff's laws hold, the powers taken in by all elements add up to zero, whatever the
 * elements are.  Node voltages obey the law of voltages.  For any x and lambda the law of currents, the rows
 * of (S1) of the nodes, is made to hold by rates of the node voltages: every node has a capacitor to ground.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>
#include <lapacke.h>

#include "dice.h"
#include "nonsmooth.h"

enum { NODES = 5, MOST = 64, NETWORKS = 300, ADDED = 24 };

static ns_circuit *begin(void) {
    ns_circuit *c;
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    return c;
}

static void expect(const ns_circuit *c, int id, const ns_solution *at, double v, double i) {
    double got_v, got_i, p;
    assert_int_equal(ns_circuit_power(c, id, at, &got_v, &got_i, &p), NS_OK);
    assert_true(got_v == v && got_i == i && p == v * i);
    assert_int_equal(ns_circuit_power(c, id, at, NULL, NULL, NULL), NS_OK);
}

/* --- by hand: node 1 at 6 V, node 2 at 2 V, all numbers exact --- */

static void each_kind(void **state) {
    (void)state;
    ns_circuit *c = begin();
    ns_system *s;
    ns_signal two = {.kind = NS_DC, .u.dc = 2}, step = {.kind = NS_PULSE};
    const ns_diode d = {0.5, 0, 8, 100, 1};
    const ns_switch sw = {0.5, 0, 0, INFINITY};
    const ns_term terms[] = {{0, 1, 0.25}, {0, 0, 7}, {1, 3, -0.5}};
    int r, cap, l, iv, is, vs, e, f, g, h, b, dio, swi, k, l2;
    step.u.pulse.v1 = 3;
    step.u.pulse.v2 = 5;
    step.u.pulse.td = 1;
    step.u.pulse.per = INFINITY;
    step.u.pulse.pw = 1;
    assert_int_equal(ns_circuit_resistor(c, "r", 1, 2, 2, &r), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c", 2, 1, 0.5, NAN, &cap), NS_OK);
    assert_int_equal(ns_circuit_inductor(c, "l", 1, 0, 4, NAN, &l), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v", NS_VOLTAGE, 1, 2, &two, &vs), NS_OK);
    assert_int_equal(ns_circuit_source(c, "i", NS_CURRENT, 2, 0, &step, &is), NS_OK);
    assert_int_equal(ns_circuit_source(c, "j", NS_CURRENT, 0, 1, &two, &iv), NS_OK);
    assert_int_equal(ns_circuit_vcontrolled(c, "e", NS_VOLTAGE, 2, 0, 1, 0, 3, &e), NS_OK);
    assert_int_equal(ns_circuit_vcontrolled(c, "g", NS_CURRENT, 2, 1, 1, 2, 3, &g), NS_OK);
    assert_int_equal(ns_circuit_icontrolled(c, "f", NS_CURRENT, 1, 0, l, -2, &f), NS_OK);
    assert_int_equal(ns_circuit_icontrolled(c, "h", NS_VOLTAGE, 1, 0, l, -2, &h), NS_OK);
    assert_int_equal(ns_circuit_linear(c, "b", NS_CURRENT, 1, 2, 1.5, 3, terms, &b), NS_OK);
    assert_int_equal(ns_circuit_diode(c, "d", 2, 1, &d, &dio), NS_OK);
    assert_int_equal(ns_circuit_switch(c, "s", 1, 0, 2, 0, &sw, &swi), NS_OK);
    assert_int_equal(ns_circuit_inductor(c, "l2", 2, 0, 1, NAN, &l2), NS_OK);
    assert_int_equal(ns_circuit_coupling(c, "k", l, l2, 0.5, &k), NS_OK);
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_int_equal(s->n, 2 + 5);
    assert_int_equal(s->m, 3);
    const double x[] = {6, 2, /* l, v, e, h, l2 */ -3, 0.75, 9, 11, 2}, rates[] = {1, 9, 0, 0, 0, 0, 0};
    const double lambda[] = {0.25, 7, 13};
    ns_solution at = {1, NS_LEFT, x, lambda, rates};
    expect(c, r, &at, 4, 2);
    expect(c, cap, &at, -4, 0.5 * (9 - 1));
    expect(c, l, &at, 6, -3);
    expect(c, vs, &at, 4, 0.75);
    expect(c, is, &at, 2, 3);
    expect(c, iv, &at, -6, 2);
    expect(c, e, &at, 2, 9);
    expect(c, g, &at, -4, 3 * (6 - 2));
    expect(c, f, &at, 6, 6);
    expect(c, h, &at, 6, 11);
    expect(c, b, &at, 4, 1.5 + 0.25 * 6 - 0.5 * 0.75);
    expect(c, dio, &at, -4, 0.25 - 7 - 4 / 8.0);
    expect(c, swi, &at, 6, 13);
    expect(c, k, &at, 0, 0);
    at.side = NS_RIGHT;
    expect(c, is, &at, 2, 5);
    at.rates = NULL;
    double i = 0;
    assert_int_equal(ns_circuit_power(c, cap, &at, NULL, &i, NULL), NS_OK);
    assert_true(isnan(i));
    /* C v^2/2 = 4, L i^2/2 = 18 and 2, M i i' = 0.5 sqrt(4) (-3) 2 = -6, half in either */
    double each[32], all;
    assert_int_equal(ns_circuit_stored(c, x, each, &all), NS_OK);
    assert_true(all == 4 + 18 + 2 - 6);
    assert_true(each[cap] == 4 && each[l] == 15 && each[l2] == -1 && each[r] == 0 && each[k] == 0);
    assert_int_equal(ns_circuit_stored(c, x, NULL, NULL), NS_OK);
    ns_system_free(s);
    ns_circuit_free(c);
}

/* 6 V and 2 V: 2 F to ground either way round, 3 F from node 1 to node 2 and 5 F from node 2 to ground: 36,
 * 36, 24 and 10 J. */
static void energy_of_capacitors(void **state) {
    ns_circuit *c = begin();
    ns_system *s;
    const double x[] = {6, 2}, want[] = {36, 36, 24, 10};
    double each[4] = {7, 7, 7, 7}, all;
    (void)state;
    assert_int_equal(ns_circuit_capacitor(c, "c1", 1, 0, 2, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c2", 0, 1, 2, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c3", 1, 2, 3, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_capacitor(c, "c4", 2, 0, 5, NAN, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_int_equal(ns_circuit_stored(c, x, each, &all), NS_OK);
    for (int k = 0; k < 4; k++)
        assert_true(each[k] == want[k]);
    assert_true(all == 106);
    ns_system_free(s);
    ns_circuit_free(c);
}

/* A source that depends on nothing: 1.5 A. */
static void a_linear_source_of_no_terms(void **state) {
    ns_circuit *c = begin();
    const double x = 4;
    const ns_solution at = {0, NS_RIGHT, &x, NULL, NULL};
    int id;
    (void)state;
    assert_int_equal(ns_circuit_resistor(c, "r", 1, 0, 2, NULL), NS_OK);
    assert_int_equal(ns_circuit_linear(c, "b", NS_CURRENT, 1, 0, 1.5, 0, NULL, &id), NS_OK);
    assert_int_equal(ns_circuit_linear(c, "b2", NS_CURRENT, 1, 0, 1.5, 1, NULL, NULL), NS_E_NULL);
    ns_system *s;
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    expect(c, id, &at, 4, 1.5);
    ns_system_free(s);
    ns_circuit_free(c);
}

static void refusals(void **state) {
    (void)state;
    ns_circuit *c = begin();
    ns_system *s;
    const ns_diode d = {0, 0, INFINITY, INFINITY, 0};
    const double x[] = {1}, lambda[] = {1};
    const ns_solution at = {0, NS_RIGHT, x, lambda, NULL}, none = {0, NS_RIGHT, NULL, lambda, NULL};
    double v;
    assert_int_equal(ns_circuit_diode(c, "d", 1, 0, &d, NULL), NS_OK);
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_int_equal(ns_circuit_power(NULL, 0, &at, &v, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_circuit_power(c, 0, NULL, &v, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_circuit_power(c, 0, &none, &v, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_circuit_power(c, 0, &(ns_solution){.x = x}, &v, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_circuit_power(c, 1, &at, &v, NULL, NULL), NS_E_SIZE);
    assert_int_equal(ns_circuit_power(c, -1, &at, &v, NULL, NULL), NS_E_SIZE);
    assert_int_equal(ns_circuit_stored(NULL, x, NULL, &v), NS_E_NULL);
    assert_int_equal(ns_circuit_stored(c, NULL, NULL, &v), NS_E_NULL);
    ns_system_free(s);
    ns_circuit_free(c);
}

/* --- Tellegen --- */

static ns_signal random_signal(dice *d) {
    ns_signal s = {.kind = NS_DC, .u.dc = dice_either(d)};
    if (dice_chance(d, 0.5)) {
        s = (ns_signal){.kind = NS_SIN};
        s.u.sin.va = 1 + dice_uniform(d);
        s.u.sin.freq = 1 + dice_uniform(d);
    }
    return s;
}

/* One element of any kind but coupling, between any two nodes; l: the inductors so far. */
static void add_random(ns_circuit *c, dice *d, int k, int *l, int *inductors) {
    const int p = dice_below(d, NODES + 1), n = dice_below(d, NODES + 1);
    const int cp = dice_below(d, NODES + 1), cn = dice_below(d, NODES + 1), l0 = l[dice_below(d, *inductors)];
    const ns_output output = dice_chance(d, 0.5) ? NS_VOLTAGE : NS_CURRENT;
    const double size = dice_decades(d, -3, 3);
    const ns_signal s = random_signal(d);
    const int leaks = dice_below(d, 2), breaks = dice_below(d, 2);
    const ns_diode diode = {0.5, 1e-3, leaks ? 1e3 : INFINITY, breaks ? 5 : INFINITY, 1e-3};
    const ns_switch contact = {0.5, 0, 1e-3, leaks ? 1e3 : INFINITY};
    const ns_term terms[] = {{0, cp, size}, {1, l0, -size}, {0, cn, 2}};
    char name[16];
    snprintf(name, sizeof name, "e%d", k);
    int status = NS_OK;
    switch (dice_below(d, 10)) {
    case 0:
        status = ns_circuit_resistor(c, name, p, n, dice_chance(d, 0.2) ? 0 : size * 1e-3, NULL);
        break;
    case 1:
        status = ns_circuit_capacitor(c, name, p, n, size, NAN, NULL);
        break;
    case 2:
        status = ns_circuit_inductor(c, name, p, n, size, NAN, &l[*inductors]);
        ++*inductors;
        break;
    case 3:
    case 4:
        status = ns_circuit_source(c, name, output, p, n, &s, NULL);
        break;
    case 5:
        status = ns_circuit_vcontrolled(c, name, output, p, n, cp, cn, size, NULL);
        break;
    case 6:
        status = ns_circuit_icontrolled(c, name, output, p, n, l0, size, NULL);
        break;
    case 7:
        status = ns_circuit_linear(c, name, output, p, n, size, 3, terms, NULL);
        break;
    case 8:
        status = ns_circuit_diode(c, name, p, n, &diode, NULL);
        break;
    default:
        status = ns_circuit_switch(c, name, p, n, cp, cn, &contact, NULL);
    }
    assert_int_equal(status, NS_OK);
}

/* Returns the number of elements. */
static int random_circuit(ns_circuit *c, dice *d) {
    char name[16];
    int l[ADDED + 2], inductors = 1;
    for (int node = 1; node <= NODES; node++) {
        snprintf(name, sizeof name, "c%d", node);
        assert_int_equal(ns_circuit_capacitor(c, name, node, 0, dice_decades(d, -2, 2), NAN, NULL), NS_OK);
    }
    assert_int_equal(ns_circuit_inductor(c, "l0", 1, 0, 1, NAN, &l[0]), NS_OK);
    for (int k = 0; k < ADDED; k++)
        add_random(c, d, k, l, &inductors);
    if (inductors > 1)
        assert_int_equal(ns_circuit_coupling(c, "k", l[0], l[1], 0.7, NULL), NS_OK);
    return NODES + 1 + ADDED + (inductors > 1);
}

/* rates: those of the node voltages, by the rows of the nodes. */
static void rates_of(const ns_system *s, double t, const double *x, const double *lambda, double *rates) {
    double z[MOST], M[NODES * NODES];
    int pivot[NODES];
    const int n = s->n;
    memset(rates, 0, sizeof(double) * MOST);
    ns_system_inputs(s, t, NS_RIGHT, z);
    for (int i = 0; i < NODES; i++) {
        rates[i] = s->b[i];
        for (int j = 0; j < n; j++)
            rates[i] += s->A[i + j * n] * x[j];
        for (int j = 0; j < s->nz; j++)
            rates[i] += s->E[i + j * n] * z[j];
        for (int j = 0; j < s->m; j++)
            rates[i] += s->B[i + j * n] * lambda[j];
        for (int j = 0; j < NODES; j++)
            M[i + j * NODES] = s->M[i + j * n];
    }
    assert_int_equal(LAPACKE_dgesv(LAPACK_COL_MAJOR, NODES, 1, M, NODES, pivot, rates, NODES), 0);
}

/* The sum of all powers, of the sum of their sizes. */
static double imbalance(unsigned number) {
    dice d = dice_make(77, number);
    ns_circuit *c = begin();
    ns_system *s;
    const int elements = random_circuit(c, &d);
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    assert_true(s->n <= MOST && s->m <= MOST && s->nz <= MOST);
    double x[MOST], lambda[MOST], rates[MOST], sum = 0, sizes = 0;
    for (int i = 0; i < s->n; i++)
        x[i] = 10 * dice_either(&d);
    for (int j = 0; j < s->m; j++)
        lambda[j] = 10 * dice_either(&d);
    const ns_solution at = {dice_uniform(&d), NS_RIGHT, x, lambda, rates};
    rates_of(s, at.t, x, lambda, rates);
    for (int k = 0; k < elements; k++) {
        double v, i, p;
        assert_int_equal(ns_circuit_power(c, k, &at, &v, &i, &p), NS_OK);
        sum += p;
        sizes += fabs(p);
    }
    ns_system_free(s);
    ns_circuit_free(c);
    return fabs(sum) / sizes;
}

static void powers_add_up_to_zero(void **state) {
    (void)state;
    double worst = 0;
    for (unsigned k = 0; k < NETWORKS; k++)
        worst = fmax(worst, imbalance(k));
    print_message("%d networks: sum of powers %.1e of their sizes at most\n", NETWORKS, worst);
    /* sums of some 30 terms, and the condition of the capacitors' matrix (1e-2 to 1e3 F) */
    assert_true(worst < 1e-12);
}

/* --- where nodes are found --- */

static double across(const ns_circuit *c, int id, const double *x) {
    static const double lambda[] = {0};
    static const ns_mode mode[] = {NS_LOWER};
    double v;
    assert_int_equal(ns_circuit_device(c, id, x, lambda, mode, NULL, &v, NULL), NS_OK);
    return v;
}

/* A node that is added before those of a device moves their places; one that nobody named has none. */
static void devices_are_found_after_others_came(void **state) {
    (void)state;
    ns_circuit *c = begin();
    ns_system *s;
    const ns_diode d = {.roff = INFINITY, .vz = INFINITY};
    int id;
    assert_int_equal(ns_circuit_diode(c, "d", 5, 7, &d, &id), NS_OK);
    assert_true(across(c, id, (const double[]){6, 2}) == 4); /* no system was made yet */
    for (int k = 0; k < 2; k++) {
        assert_int_equal(ns_circuit_system(c, &s), NS_OK);
        ns_system_free(s);
        if (k == 0)
            assert_true(across(c, id, (const double[]){6, 2}) == 4);
        else
            assert_true(across(c, id, (const double[]){10, 20, 6, 2}) == 4);
        assert_int_equal(ns_circuit_resistor(c, k ? "r2" : "r1", 3 + k, 0, 1, NULL), NS_OK);
        if (k == 0)
            assert_int_equal(ns_circuit_resistor(c, "r0", 1, 0, 1, NULL), NS_OK);
    }
    assert_true(across(c, id, (const double[]){10, 20, 30, 6, 2}) == 4);
    ns_circuit_free(c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(devices_are_found_after_others_came),
        cmocka_unit_test(each_kind),
        cmocka_unit_test(a_linear_source_of_no_terms),
        cmocka_unit_test(energy_of_capacitors),
        cmocka_unit_test(refusals),
        cmocka_unit_test(powers_add_up_to_zero),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
