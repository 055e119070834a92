/* tests/unit/sparse/test_shared_currents.c - two closed switches in parallel carry half of their current
 * each, in any mode of a network in which other devices leak little: leaks in series with them are alike, and
 * rounds with leaks, which gain little there, leave the current around the two open. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "dice.h"
#include "nonsmooth.h"
#include "sparse/factor_cache.h"
#include "sparse/sparse_internal.h"

enum { NETWORKS = 4000, NODES = 9, GATE = NODES, PARTS = 16, MOST = 64 };

typedef struct network {
    ns_circuit *c;
    ns_system *s;
    ns_form *f;
    ns_mode_factors *q;
    ns_mode mode[PARTS + 2];
    double w[MOST], r[MOST], v[MOST];
} network;

/* A coil, a capacitor, a resistor or a switch that leaks between nodes p and n. */
static void add_part(network *k, dice *d, int part, int p, int n) {
    const ns_switch leaky = {0.5, 0, 0, dice_decades(d, 6, 16)};
    char name[16];
    int status;
    snprintf(name, sizeof name, "e%d", part);
    switch (dice_below(d, 5)) {
    case 0:
        status = ns_circuit_resistor(k->c, name, p, n, dice_decades(d, -3, 4), NULL);
        break;
    case 1:
        status = ns_circuit_inductor(k->c, name, p, n, dice_decades(d, -7, -1), 0, NULL);
        break;
    case 2:
        status = ns_circuit_capacitor(k->c, name, p, n, dice_decades(d, -10, 0), 0, NULL);
        break;
    default:
        status = ns_circuit_switch(k->c, name, p, n, GATE, 0, &leaky, NULL);
    }
    assert_int_equal(status, NS_OK);
}

/* The two switches are pairs 0 and 1. */
static void make(network *k, dice *d) {
    const ns_signal zero = {.kind = NS_DC};
    const ns_switch ideal = {0.5, 0, 0, INFINITY};
    *k = (network){0};
    assert_int_equal(ns_circuit_create(&k->c), NS_OK);
    assert_int_equal(ns_circuit_source(k->c, "gate", NS_VOLTAGE, GATE, 0, &zero, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(k->c, "sa", 1, 2, GATE, 0, &ideal, NULL), NS_OK);
    assert_int_equal(ns_circuit_switch(k->c, "sb", 1, 2, GATE, 0, &ideal, NULL), NS_OK);
    for (int i = 0; i < PARTS; i++) {
        const int p = dice_below(d, NODES), n = dice_below(d, NODES);
        if (p != n)
            add_part(k, d, i, p, n);
    }
    assert_int_equal(ns_circuit_system(k->c, &k->s), NS_OK);
    assert_int_equal(ns_sparse_form_create(k->s, 0, &k->f), NS_OK);
    assert_true(k->f->size <= MOST);
    assert_int_equal(ns_sparse_factors_create(k->f, 1 << 20, &k->q), NS_OK);
    for (int j = 0; j < k->f->m; j++)
        k->mode[j] = j < 2 || dice_chance(d, 0.4) ? NS_INSIDE : NS_LOWER;
}

static void drop(network *k) {
    ns_sparse_factors_free(k->q);
    ns_sparse_form_free(k->f);
    ns_system_free(k->s);
    ns_circuit_free(k->c);
}

/* The right-hand side of (P2) for charges and fluxes of some volts and amperes. */
static void fill_right(network *k, dice *d) {
    for (int i = 0; i < k->f->n; i++)
        k->v[i] = dice_either(d);
    memset(k->r, 0, sizeof k->r);
    for (int i = 0; i < k->f->n; i++)
        if (!k->f->algebraic[i])
            k->r[i] = ns_linalg_csc_dot(&k->f->Mt, i, k->v);
}

/* The next step begins with the charges and fluxes that this one came to. */
static void step_on(network *k) {
    memset(k->r, 0, sizeof k->r);
    for (int i = 0; i < k->f->n; i++)
        if (!k->f->algebraic[i])
            k->r[i] = ns_linalg_csc_dot(&k->f->Mt, i, k->v);
}

/* 1 if the two carry the same, to 1e-3 of what they carry together or another pair does. */
static int is_shared(const network *k) {
    const double a = k->v[k->f->n], b = k->v[k->f->n + 1];
    double most = fabs(a + b);
    for (int j = 2; j < k->f->m; j++)
        most = fmax(most, fabs(k->v[k->f->n + j]));
    return fabs(a - b) <= 1e-3 * most;
}

/* Two steps; 1 if they have a solution. (Of 40,000 networks two have no factors with leaks: the pivots are
 * but rounding.) */
static int solve(network *k, dice *d, double g) {
    const ns_cached_factors *factors;
    fill_right(k, d);
    if (ns_sparse_factors_factor(k->q, g, k->mode, 0, &factors) != NS_OK)
        return 0;
    assert_true(factors->has_leaks);
    if (ns_sparse_factors_solve(k->q, factors, k->r, k->v) != NS_OK)
        return 0;
    step_on(k);
    return ns_sparse_factors_solve(k->q, factors, k->r, k->v) == NS_OK;
}

/* 346 of 4000 were not shared, by up to 1e8 A, where a residual that is small beside a current around the two
 * ended the search; 112, where leaks of other pairs saw the rounding of what is open. 74 are not now, by some
 * amperes: something else is open there but for 1e-8 of the largest entries. */
static void two_switches_share(void **state) {
    int solved = 0, shared = 0;
    (void)state;
    for (int run = 0; run < NETWORKS; run++) {
        dice d = dice_make(1, (unsigned long long)run);
        const double g = dice_decades(&d, -12, -5);
        network k;
        make(&k, &d);
        if (solve(&k, &d, g)) {
            solved++;
            shared += is_shared(&k);
        }
        drop(&k);
    }
    assert_true(solved > NETWORKS - 50);
    if (solved - shared > 90)
        fail_msg("%d of %d are not shared", solved - shared, solved);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(two_switches_share)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
