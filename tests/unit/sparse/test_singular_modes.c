/* tests/unit/sparse/test_singular_modes.c - (P2) solved below the engine: where laws leave it singular, where
 * a pair across a switch carries its current, and packed laws. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "dice.h"
#include "nonsmooth.h"
#include "sparse/factor_cache.h"
#include "sparse/packed_laws.h"
#include "sparse/regularise.h"
#include "sparse/sparse_internal.h"

static const ns_switch ideal = {0.5, 0, 0, INFINITY};
static const ns_diode diode = {0, 0, INFINITY, INFINITY, 0};
static const double g = 1e-6; /* length of steps, s */

typedef struct bench {
    ns_circuit *c;
    ns_system *s;
    ns_form *f;
    ns_mode_factors *q;
    double r[32], v[32];
} bench;

static bench open_bench(void) {
    const ns_signal zero = {.kind = NS_DC};
    bench b = {0};
    assert_int_equal(ns_circuit_create(&b.c), NS_OK);
    assert_int_equal(ns_circuit_source(b.c, "gate", NS_VOLTAGE, 9, 0, &zero, NULL), NS_OK);
    return b;
}

static void add_amperes(bench *b, int p, int n, double amperes) {
    const ns_signal dc = {.kind = NS_DC, .u.dc = amperes};
    assert_int_equal(ns_circuit_source(b->c, "i", NS_CURRENT, p, n, &dc, NULL), NS_OK);
}

static void form_bench(bench *b) {
    assert_int_equal(ns_circuit_system(b->c, &b->s), NS_OK);
    assert_int_equal(ns_sparse_form_create(b->s, 0, &b->f), NS_OK);
    assert_true(b->f->size <= 32);
    assert_int_equal(ns_sparse_factors_create(b->f, 1 << 20, &b->q), NS_OK);
}

static void close_bench(bench *b) {
    ns_sparse_factors_free(b->q);
    ns_sparse_form_free(b->f);
    ns_system_free(b->s);
    ns_circuit_free(b->c);
}

/* The right-hand side of (P2) with w = 0, its sources at 0, pairs at zero bounds. */
static void fill_right(bench *b, const ns_mode *mode) {
    double z[8] = {0};
    assert_true(b->s->nz <= 8);
    ns_system_inputs(b->s, 0, NS_RIGHT, z);
    memset(b->r, 0, sizeof b->r);
    for (int i = 0; i < b->f->n; i++)
        b->r[i] = ns_sparse_form_rate(b->f, g, i) * b->f->b[i];
    for (int k = 0; k < b->f->nz; k++)
        for (int p = b->f->E.start[k]; p < b->f->E.start[k + 1]; p++)
            b->r[b->f->E.row[p]] += ns_sparse_form_rate(b->f, g, b->f->E.row[p]) * b->f->E.value[p] * z[k];
    for (int j = 0; j < b->f->m; j++)
        /* NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): m modes are there */
        if (mode[j] == NS_INSIDE)
            b->r[b->f->n + j] = -b->f->e[j];
}

static int solve(bench *b, const ns_mode *mode, int *has_leaks) {
    const ns_cached_factors *k;
    fill_right(b, mode);
    assert_int_equal(ns_sparse_factors_factor(b->q, g, mode, 0, &k), NS_OK);
    *has_leaks = k->has_leaks;
    return ns_sparse_factors_solve(b->q, k, b->r, b->v);
}

/* The largest of what v leaves of r. */
static double largest_rest(const bench *b, const ns_mode *mode) {
    double left[32], largest = 0;
    memcpy(left, b->r, sizeof left);
    ns_sparse_form_subtract(b->f, g, mode, b->v, left);
    for (int i = 0; i < b->f->size; i++)
        largest = fmax(largest, fabs(left[i]));
    return largest;
}

static int add_switch(bench *b, const char *name, int p, int n) {
    int id;
    assert_int_equal(ns_circuit_switch(b->c, name, p, n, 9, 0, &ideal, &id), NS_OK);
    return id;
}

/* 1 A through two closed switches in parallel, each 0.5 A, and 1 ohm. */
static void parallel_switches_share(void **state) {
    bench b = open_bench();
    const ns_mode closed[2] = {NS_INSIDE, NS_INSIDE};
    int has_leaks;
    (void)state;
    add_amperes(&b, 0, 1, 1);
    (void)add_switch(&b, "s1", 1, 2);
    (void)add_switch(&b, "s2", 1, 2);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 2, 0, 1, NULL), NS_OK);
    form_bench(&b);
    assert_int_equal(solve(&b, closed, &has_leaks), NS_OK);
    assert_true(has_leaks && largest_rest(&b, closed) < 1e-14);
    for (int j = 0; j < 2; j++)
        assert_true(fabs(fabs(b.v[b.f->n + j]) - 0.5) < 1e-9);
    assert_true(fabs(b.v[ns_circuit_node_unknown(b.c, 2)] - 1) < 1e-12);
    assert_true(fabs(b.v[ns_circuit_node_unknown(b.c, 1)] - 1) < 1e-12);
    close_bench(&b);
}

/* Node 2, 10 ohm to node 3, floats behind two open switches, to 8 V and to ground: both are at 4 V, no
 * current. */
static void floating_parts_are_between(void **state) {
    bench b = open_bench();
    const ns_mode open[2] = {NS_LOWER, NS_LOWER};
    int has_leaks;
    (void)state;
    add_amperes(&b, 0, 1, 8);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 0, 1, NULL), NS_OK);
    (void)add_switch(&b, "s1", 1, 2);
    (void)add_switch(&b, "s2", 3, 0);
    assert_int_equal(ns_circuit_resistor(b.c, "r2", 2, 3, 10, NULL), NS_OK);
    form_bench(&b);
    assert_int_equal(solve(&b, open, &has_leaks), NS_OK);
    assert_true(has_leaks && largest_rest(&b, open) < 1e-14);
    const double v2 = b.v[ns_circuit_node_unknown(b.c, 2)], v3 = b.v[ns_circuit_node_unknown(b.c, 3)];
    assert_true(fabs(v2 - v3) < 1e-10 && v2 > 1 && v2 < 7);
    close_bench(&b);
}

/* A current of 1 A into a node behind an open switch has nowhere to go. */
static void contradictions_are_errors(void **state) {
    bench b = open_bench();
    const ns_mode open[1] = {NS_LOWER};
    int has_leaks;
    (void)state;
    add_amperes(&b, 0, 1, 1);
    (void)add_switch(&b, "s1", 1, 0);
    form_bench(&b);
    assert_int_equal(solve(&b, open, &has_leaks), NS_E_SINGULAR);
    assert_true(has_leaks && fabs(b.v[ns_circuit_node_unknown(b.c, 1)]) > 1e3);
    close_bench(&b);
}

/* A switch across a diode that conducts with a forward voltage: no current makes that right, whatever the
 * circuit around them is, and however short the step.  Rounding does not hide it. */
static void no_current_closes_a_loop_of_voltages(void **state) {
    const ns_diode drops = {.vf = 0.864, .ron = 0, .roff = INFINITY, .vz = INFINITY};
    const ns_mode mode[4] = {NS_INSIDE, NS_INSIDE, NS_LOWER, NS_LOWER};
    (void)state;
    for (unsigned trial = 0; trial < 300; trial++) {
        dice d = dice_make(7100, trial);
        const double length = dice_decades(&d, -15, -6);
        const ns_cached_factors *k;
        bench b = open_bench();
        (void)add_switch(&b, "s1", 1, 2);
        assert_int_equal(ns_circuit_diode(b.c, "d1", 2, 1, &drops, NULL), NS_OK);
        (void)add_switch(&b, "s2", 2, 3);
        assert_int_equal(ns_circuit_diode(b.c, "d2", 3, 2, &drops, NULL), NS_OK);
        assert_int_equal(ns_circuit_capacitor(b.c, "c1", 1, 3, dice_decades(&d, -9, -3), 0, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(b.c, "r1", 3, 0, dice_decades(&d, -1, 5), NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(b.c, "r2", 2, 4, dice_decades(&d, -1, 4), NULL), NS_OK);
        assert_int_equal(ns_circuit_capacitor(b.c, "c2", 4, 3, dice_decades(&d, -12, -8), 0, NULL), NS_OK);
        assert_int_equal(ns_circuit_inductor(b.c, "l1", 2, 5, dice_decades(&d, -6, -2), 0, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(b.c, "r3", 5, 3, dice_decades(&d, -1, 3), NULL), NS_OK);
        form_bench(&b);
        for (int i = 0; i < b.f->n; i++)
            b.r[i] = b.f->algebraic[i] ? 0 : dice_either(&d) * dice_decades(&d, -9, -4);
        for (int j = 0; j < b.f->m; j++)
            b.r[b.f->n + j] = mode[j] == NS_INSIDE ? -b.f->e[j] : 0;
        assert_int_equal(ns_sparse_factors_factor(b.q, length, mode, 0, &k), NS_OK);
        if (ns_sparse_factors_solve(b.q, k, b.r, b.v) != NS_E_SINGULAR)
            fail_msg("trial %u, step of %g s", trial, length);
        close_bench(&b);
    }
}

/* Half bridges at 100 V, the low switches closed, and across each a diode in series with 0 V, which conducts:
 * a drop of 10 nV in such a loop is 1e-10 of the other voltages, and no current closes it either.  1e24 A
 * did, beside which nothing of the drop showed. */
static void a_small_drop_counts(void **state) {
    static const double drop[] = {1e-8, 1e-6, 1e-2, 0.7};
    const ns_signal volts = {.kind = NS_DC, .u.dc = 100}, none = {.kind = NS_DC};
    const ns_mode mode[4] = {NS_INSIDE, NS_INSIDE, NS_INSIDE, NS_INSIDE};
    (void)state;
    for (unsigned trial = 0; trial < 400; trial++) {
        const ns_diode drops = {.vf = drop[trial % 4], .ron = 0, .roff = INFINITY, .vz = INFINITY};
        dice d = dice_make(7200, trial);
        const double length = dice_decades(&d, -15, -6);
        const ns_cached_factors *k;
        bench b = open_bench();
        assert_int_equal(ns_circuit_source(b.c, "v", NS_VOLTAGE, 1, 0, &volts, NULL), NS_OK);
        for (int leg = 0; leg < 2; leg++) {
            const int x = 10 + 10 * leg;
            assert_int_equal(ns_circuit_resistor(b.c, leg ? "r2" : "r1", 1, x, dice_decades(&d, -1, 3), NULL),
                             NS_OK);
            (void)add_switch(&b, leg ? "s2" : "s1", x, 0);
            assert_int_equal(ns_circuit_source(b.c, leg ? "v2" : "v1", NS_VOLTAGE, x, x + 1, &none, NULL),
                             NS_OK);
            assert_int_equal(ns_circuit_diode(b.c, leg ? "d2" : "d1", 0, x + 1, &drops, NULL), NS_OK);
            assert_int_equal(
                ns_circuit_inductor(b.c, leg ? "i2" : "i1", x, x + 2, dice_decades(&d, -6, -3), 0, NULL),
                NS_OK);
            assert_int_equal(
                ns_circuit_resistor(b.c, leg ? "o2" : "o1", x + 2, 3, dice_decades(&d, -1, 2), NULL), NS_OK);
        }
        assert_int_equal(ns_circuit_capacitor(b.c, "c", 3, 0, dice_decades(&d, -9, -4), 0, NULL), NS_OK);
        form_bench(&b);
        fill_right(&b, mode);
        for (int i = 0; i < b.f->n; i++)
            b.r[i] = b.f->algebraic[i] ? b.r[i] : dice_decades(&d, -9, -4);
        assert_int_equal(ns_sparse_factors_factor(b.q, length, mode, 0, &k), NS_OK);
        if (ns_sparse_factors_solve(b.q, k, b.r, b.v) != NS_E_SINGULAR)
            fail_msg("trial %u, step of %g s", trial, length);
        close_bench(&b);
    }
}

/* Solutions in rounds and Krylov cycles count, with what their vectors cost: where all of a bridge floats
 * they are most of what sparse does.  Its engine counted 6e8 instructions of 1.4e9 (six-pulse-thyristor
 * 77000002 of the stress set), and was asked about too late.  A chain takes a cycle. */
static void solutions_with_leaks_count(void **state) {
    static const double an_unknown = 300; /* instructions, beside those of a solution */
    const ns_sparse_options o = {.h = 1e-5, .bytes = 1 << 20};
    const double w0[32] = {0};
    bench b = open_bench();
    ns_engine *e;
    (void)state;
    add_amperes(&b, 0, 1, 1);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 0, 5, NULL), NS_OK);
    (void)add_switch(&b, "s1", 1, 2);
    assert_int_equal(ns_circuit_resistor(b.c, "r1", 2, 3, 100, NULL), NS_OK);
    (void)add_switch(&b, "s2", 3, 4);
    assert_int_equal(ns_circuit_resistor(b.c, "r2", 4, 5, 100, NULL), NS_OK);
    (void)add_switch(&b, "s3", 5, 0);
    form_bench(&b);
    assert_int_equal(ns_sparse_create(b.s, &o, &e, NULL), NS_OK);
    assert_int_equal(e->table->start(e, 0, w0, NULL), NS_OK);
    ns_mode_factors *q = ns_sparse_of(e)->q;
    const long leaky = q->leaky_solves;
    assert_true(leaky > 3 && leaky <= ns_linalg_klu_solves(q->klu));
    const double all = ns_engine_work(e).all;
    q->leaky_solves = 0;
    const double expected = an_unknown * (double)ns_sparse_of(e)->f->size * (double)leaky;
    assert_true(fabs(all - ns_engine_work(e).all - expected) < 1e-6 * expected);
    e->table->free(e);
    close_bench(&b);
}

/* A chain of islands, 100 ohm within each, behind open switches: the leaks between them settle it, rounds
 * alone would gain little.  Each island is at one voltage, and none of them carries a current. */
static void chains_of_islands_float(void **state) {
    enum { ISLANDS = 3 };
    bench b = open_bench();
    ns_mode open[ISLANDS + 1] = {NS_LOWER, NS_LOWER, NS_LOWER, NS_LOWER};
    const char *const switches[] = {"s1", "s2", "s3", "s4"}, *const resistors[] = {"r1", "r2", "r3"};
    int has_leaks;
    (void)state;
    add_amperes(&b, 0, 1, 1);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 0, 5, NULL), NS_OK);
    for (int k = 0; k <= ISLANDS; k++)
        (void)add_switch(&b, switches[k], 2 * k + 1, k < ISLANDS ? 2 * k + 2 : 0);
    for (int k = 0; k < ISLANDS; k++)
        assert_int_equal(ns_circuit_resistor(b.c, resistors[k], 2 * k + 2, 2 * k + 3, 100, NULL), NS_OK);
    form_bench(&b);
    assert_int_equal(solve(&b, open, &has_leaks), NS_OK);
    assert_true(has_leaks && largest_rest(&b, open) < 1e-13);
    double last = 5;
    for (int k = 0; k < ISLANDS; k++) {
        const double v = b.v[ns_circuit_node_unknown(b.c, 2 * k + 2)];
        assert_true(fabs(v - b.v[ns_circuit_node_unknown(b.c, 2 * k + 3)]) < 1e-8);
        assert_true(v > 0 && v < last);
        last = v;
    }
    close_bench(&b);
}

/* 1 A into a switch with a diode across it, drawn both ways.  The mode in which the diode conducts is solved
 * by the factors of the closed switch: the equations of that mode hold all the same, and the diode carries
 * the current. */
static void a_diode_carries_what_its_switch_did(void **state) {
    (void)state;
    for (int up = 0; up < 2; up++) {
        bench b = open_bench();
        ns_shared_branch *shared;
        int count, has_leaks;
        add_amperes(&b, 0, 1, up ? -1 : 1);
        (void)add_switch(&b, "s1", 1, 0);
        assert_int_equal(ns_circuit_diode(b.c, "d1", up ? 0 : 1, up ? 1 : 0, &diode, NULL), NS_OK);
        assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 0, 2, NULL), NS_OK);
        form_bench(&b);
        assert_int_equal(ns_modes_shared_find(b.s, &shared, &count), NS_OK);
        assert_true(count == 1 && shared->pair == 1 && shared->of == 0 && shared->idle == NS_LOWER);
        assert_int_equal(ns_sparse_factors_shared(b.q, shared, count), NS_OK);
        const ns_mode conducts[2] = {NS_LOWER, NS_INSIDE}, idle[2] = {NS_INSIDE, NS_LOWER};
        const ns_mode *const of = ns_sparse_equivalent_mode(&b.q->equivalents, conducts);
        assert_memory_equal(of, idle, 2);
        assert_ptr_equal(ns_sparse_equivalent_mode(&b.q->equivalents, idle), idle);
        for (int round = 0; round < 2; round++) {
            const ns_mode *const mode = round ? idle : conducts;
            assert_int_equal(solve(&b, mode, &has_leaks), NS_OK);
            assert_true(!has_leaks && largest_rest(&b, mode) < 1e-15);
            assert_true(fabs(fabs(b.v[b.f->n + (round ? 0 : 1)]) - 1) < 1e-15);
            assert_true(b.v[b.f->n + (round ? 1 : 0)] == 0);
        }
        assert_true(b.q->made == 1); /* one factorisation served both */
        free(shared);
        close_bench(&b);
    }
}

/* Of a diode behind 1 ohm with 0.5 V, open: y >= 0; inside: lambda >= 0; a sliding pair and one bounded on
 * both sides are left to others.  Held against the laws themselves at random points. */
static void packed_laws_are_the_laws(void **state) {
    bench b = open_bench();
    const ns_diode knee = {0.5, 0, INFINITY, INFINITY, 0};
    ns_packed_laws k;
    (void)state;
    add_amperes(&b, 0, 1, 1);
    assert_int_equal(ns_circuit_diode(b.c, "d1", 1, 2, &knee, NULL), NS_OK);
    assert_int_equal(ns_circuit_diode(b.c, "d2", 2, 0, &knee, NULL), NS_OK);
    assert_int_equal(ns_circuit_resistor(b.c, "r", 1, 0, 2, NULL), NS_OK);
    form_bench(&b);
    assert_int_equal(b.f->m, 2);
    assert_int_equal(ns_sparse_laws_create(2, &k), NS_OK);
    const double l[2] = {0, 0}, u[2] = {INFINITY, INFINITY}, two[2] = {1, 1};
    unsigned long long random = 1;
    int held = 0, broken = 0;
    for (int trial = 0; trial < 400; trial++) {
        double v[32] = {0};
        for (int i = 0; i < b.f->size; i++) {
            random = random * 6364136223846793005U + 1442695040888963407U;
            v[i] = (double)(random >> 40) / (1 << 23) - 1;
        }
        const ns_mode mode[2] = {trial % 2 ? NS_INSIDE : NS_LOWER, trial % 3 ? NS_INSIDE : NS_LOWER};
        int holds = 1;
        for (int j = 0; j < 2; j++)
            holds &= mode[j] == NS_INSIDE ? v[b.f->n + j] >= 0 : ns_sparse_form_y(b.f, j, v, NULL, 1) >= 0;
        ns_sparse_laws_set(&k, b.f, mode, l, u);
        assert_int_equal(k.others, 0);
        assert_int_equal(ns_sparse_laws_hold(&k, v), holds);
        held += holds;
        broken += !holds;
    }
    assert_true(held > 20 && broken > 20);
    ns_sparse_laws_set(&k, b.f, (ns_mode[]){NS_INSIDE, NS_SLIDES_UP}, l, two);
    assert_true(k.others == 2 && k.other[0] == 0 && k.other[1] == 1);
    ns_sparse_laws_set(&k, b.f, (ns_mode[]){NS_INSIDE, NS_LOWER}, (double[]){-INFINITY, 0}, two);
    double v[32] = {0};
    v[b.f->n] = 0.5; /* its upper bound is 1 */
    v[ns_circuit_node_unknown(b.c, 2)] = -1;
    assert_true(k.others == 0 && ns_sparse_laws_hold(&k, v));
    v[b.f->n] = 1.5;
    assert_false(ns_sparse_laws_hold(&k, v));
    v[b.f->n] = 0.5;
    v[1] = NAN;
    v[0] = NAN;
    assert_false(ns_sparse_laws_hold(&k, v));
    ns_sparse_laws_free(&k);
    close_bench(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parallel_switches_share),   cmocka_unit_test(floating_parts_are_between),
        cmocka_unit_test(contradictions_are_errors), cmocka_unit_test(no_current_closes_a_loop_of_voltages),
        cmocka_unit_test(a_small_drop_counts),       cmocka_unit_test(solutions_with_leaks_count),
        cmocka_unit_test(chains_of_islands_float),   cmocka_unit_test(a_diode_carries_what_its_switch_did),
        cmocka_unit_test(packed_laws_are_the_laws),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
