/* tests/unit/sparse/test_low_rank_update.c - (P2) of modes solved with the factors of others. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "dice.h"
#include "nonsmooth.h"
#include "sparse/factor_cache.h"
#include "sparse/sparse_internal.h"

enum { CELLS = 24 };

/* A line of resistors and capacitors, from each node a diode to ground; `loose`: and one beyond a diode, held
 * by nothing else but a second one. */
static ns_system *line(int loose) {
    const ns_diode diode = {0, 0, INFINITY, INFINITY, 0};
    const ns_signal volts = {.kind = NS_DC, .u.dc = 10};
    ns_circuit *c;
    ns_system *s;
    char name[24];
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v", NS_VOLTAGE, 1, 0, &volts, NULL), NS_OK);
    for (int k = 0; k < CELLS; k++) {
        (void)snprintf(name, sizeof name, "r%d", k);
        assert_int_equal(ns_circuit_resistor(c, name, k + 1, k + 2, 10, NULL), NS_OK);
        (void)snprintf(name, sizeof name, "c%d", k);
        assert_int_equal(ns_circuit_capacitor(c, name, k + 2, 0, 1e-6, NAN, NULL), NS_OK);
        (void)snprintf(name, sizeof name, "d%d", k);
        assert_int_equal(ns_circuit_diode(c, name, 0, k + 2, &diode, NULL), NS_OK);
    }
    if (loose) {
        assert_int_equal(ns_circuit_diode(c, "e", 2, CELLS + 2, &diode, NULL), NS_OK);
        assert_int_equal(ns_circuit_diode(c, "f", CELLS + 2, 0, &diode, NULL), NS_OK);
    }
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    ns_circuit_free(c);
    return s;
}

/* What v leaves of r, relative to the largest of r: equations of voltages and of charges, both about one. */
static double rest(const ns_form *f, double g, const ns_mode *mode, const double *r, const double *v) {
    double *left = calloc((size_t)f->size, sizeof *left), worst = 0;
    assert_non_null(left);
    memcpy(left, r, sizeof *left * (size_t)f->size);
    ns_sparse_form_subtract(f, g, mode, v, left);
    for (int i = 0; i < f->size; i++)
        worst = fmax(worst, fabs(left[i]));
    free(left);
    return worst;
}

/* A walk through modes, one to three pairs a step: the equations of each hold, and factors are made for few:
 * when more than NS_UPDATE_MOST pairs differ, so at most for every third mode or so, here. */
static void test_walk(void **state) {
    (void)state;
    enum { STEPS = 400 };
    const double g = 1e-6;
    dice d = dice_make(7, 0);
    ns_system *s = line(0);
    ns_form *f;
    ns_mode_factors *q;
    const ns_cached_factors *k;
    assert_int_equal(ns_sparse_form_create(s, 0, &f), NS_OK);
    assert_int_equal(ns_sparse_factors_create(f, 1 << 26, &q), NS_OK);
    double *r = calloc(2 * (size_t)f->size, sizeof *r), *v = r + f->size;
    ns_mode *mode = calloc((size_t)f->m, 1);
    for (int j = 0; j < f->m; j++)
        mode[j] = NS_LOWER;
    for (int step = 0; step < STEPS; step++) {
        for (int flips = 1 + step % 3; flips > 0; flips--) {
            const int j = dice_below(&d, f->m);
            mode[j] = mode[j] == NS_INSIDE ? NS_LOWER : NS_INSIDE;
        }
        for (int round = 0; round < 3; round++) {
            for (int i = 0; i < f->size; i++)
                r[i] = dice_either(&d) * (i >= f->n || f->algebraic[i] ? 1 : 1e-6);
            assert_int_equal(ns_sparse_factors_factor(q, g, mode, 0, &k), NS_OK);
            assert_int_equal(ns_sparse_factors_solve(q, k, r, v), NS_OK);
            assert_true(rest(f, g, mode, r, v) < 1e-12);
        }
    }
    assert_true(q->updated > STEPS / 2);
    assert_true(q->made < STEPS / 2);
    free(r);
    free(mode);
    ns_sparse_factors_free(q);
    ns_sparse_form_free(f);
    ns_system_free(s);
}

/* With both of its diodes open nothing holds the last node: no update leads there, the factors with leaks do,
 * and from there back. */
static void test_loose(void **state) {
    (void)state;
    const double g = 1e-6;
    ns_system *s = line(1);
    ns_form *f;
    ns_mode_factors *q;
    const ns_cached_factors *k;
    assert_int_equal(ns_sparse_form_create(s, 0, &f), NS_OK);
    assert_int_equal(ns_sparse_factors_create(f, 1 << 26, &q), NS_OK);
    double *r = calloc(2 * (size_t)f->size, sizeof *r), *v = r + f->size;
    ns_mode *mode = calloc((size_t)f->m, 1);
    for (int j = 0; j < f->m; j++)
        mode[j] = NS_LOWER;
    for (int round = 0; round < 32; round++) {
        const int loose = round % 2, e = f->m - 2;
        mode[e] = loose ? NS_LOWER : NS_INSIDE;
        mode[round % CELLS] = NS_INSIDE;
        memset(r, 0, sizeof *r * (size_t)f->size);
        for (int i = 0; i < f->n; i++)
            r[i] = f->algebraic[i] ? f->b[i] : 1e-6 * i;
        assert_int_equal(ns_sparse_factors_factor(q, g, mode, 0, &k), NS_OK);
        assert_int_equal(ns_sparse_factors_solve(q, k, r, v), NS_OK);
        assert_int_equal(k->has_leaks, loose);
        assert_true(rest(f, g, mode, r, v) < 1e-11);
    }
    free(r);
    free(mode);
    ns_sparse_factors_free(q);
    ns_sparse_form_free(f);
    ns_system_free(s);
}

/* Two modes, too far apart for updates, by two lengths in turn: the first mode of each, asked for often, is
 * kept, but for the bound on memory, which leaves no more than the last. */
static void test_evicted(void **state) {
    (void)state;
    ns_system *s = line(0);
    ns_form *f;
    ns_mode_factors *q;
    const ns_cached_factors *k;
    assert_int_equal(ns_sparse_form_create(s, 0, &f), NS_OK);
    assert_int_equal(ns_sparse_factors_create(f, 1, &q), NS_OK);
    assert_true(f->m > NS_UPDATE_MOST);
    double *r = calloc(2 * (size_t)f->size, sizeof *r), *v = r + f->size;
    ns_mode *mode = calloc((size_t)f->m, 1);
    for (int round = 0; round < 32; round++) {
        const double g = round / 2 % 2 ? 1e-6 : 2e-6;
        for (int j = 0; j < f->m; j++)
            mode[j] = round % 2 ? NS_LOWER : NS_INSIDE;
        for (int i = 0; i < f->n; i++)
            r[i] = f->algebraic[i] ? f->b[i] : 1e-6;
        assert_int_equal(ns_sparse_factors_factor(q, g, mode, 0, &k), NS_OK);
        assert_int_equal(ns_sparse_factors_solve(q, k, r, v), NS_OK);
        assert_true(rest(f, g, mode, r, v) < 1e-12);
    }
    assert_true(q->evicted > 0);
    free(r);
    free(mode);
    ns_sparse_factors_free(q);
    ns_sparse_form_free(f);
    ns_system_free(s);
}

/* A line of resistors and capacitors, from each node a switch to ground, one after the other from either
 * side, with a diode across it. */
static ns_system *line_of_switches(void) {
    const ns_diode diode = {0, 0, INFINITY, INFINITY, 0};
    const ns_switch to_ground = {.vt = 0.5, .roff = INFINITY};
    const ns_signal volts = {.kind = NS_DC, .u.dc = 10};
    ns_circuit *c;
    ns_system *s;
    char name[24];
    assert_int_equal(ns_circuit_create(&c), NS_OK);
    assert_int_equal(ns_circuit_source(c, "v", NS_VOLTAGE, 1, 0, &volts, NULL), NS_OK);
    for (int k = 0; k < CELLS; k++) {
        const int at = k + 2, p = k % 2 ? 0 : at, n = k % 2 ? at : 0;
        (void)snprintf(name, sizeof name, "r%d", k);
        assert_int_equal(ns_circuit_resistor(c, name, k + 1, at, 10, NULL), NS_OK);
        (void)snprintf(name, sizeof name, "c%d", k);
        assert_int_equal(ns_circuit_capacitor(c, name, at, 0, 1e-6, NAN, NULL), NS_OK);
        (void)snprintf(name, sizeof name, "s%d", k);
        assert_int_equal(ns_circuit_switch(c, name, p, n, 1, 0, &to_ground, NULL), NS_OK);
        (void)snprintf(name, sizeof name, "d%d", k);
        assert_int_equal(ns_circuit_diode(c, name, 0, at, &diode, NULL), NS_OK);
    }
    assert_int_equal(ns_circuit_system(c, &s), NS_OK);
    ns_circuit_free(c);
    return s;
}

/* Which of a switch and the diode across it carries the current is new to no factors: those of the switches
 * serve, and the equations of each mode hold. */
static void test_stand_in(void **state) {
    (void)state;
    enum { STEPS = 40 };
    const double g = 1e-6;
    dice d = dice_make(11, 0);
    ns_system *s = line_of_switches();
    ns_form *f;
    ns_mode_factors *q;
    ns_shared_branch *twin;
    int twins;
    const ns_cached_factors *k;
    assert_int_equal(ns_sparse_form_create(s, 0, &f), NS_OK);
    assert_int_equal(ns_sparse_factors_create(f, 1 << 26, &q), NS_OK);
    assert_int_equal(ns_modes_shared_find(s, &twin, &twins), NS_OK);
    assert_int_equal(ns_sparse_factors_shared(q, twin, twins), NS_OK);
    assert_int_equal(twins, CELLS);
    double *r = calloc(2 * (size_t)f->size, sizeof *r), *v = r + f->size;
    ns_mode *mode = calloc((size_t)f->m, 1);
    for (int step = 0; step < STEPS; step++) {
        for (int i = 0; i < twins; i++) { /* two of three conduct */
            const int by_diode = dice_below(&d, 2);
            mode[twin[i].of] = i % 3 && !by_diode ? NS_INSIDE : NS_LOWER;
            mode[twin[i].pair] = i % 3 && by_diode ? NS_INSIDE : NS_LOWER;
        }
        for (int i = 0; i < f->size; i++)
            r[i] = dice_either(&d) * (i >= f->n || f->algebraic[i] ? 1 : 1e-6);
        assert_int_equal(ns_sparse_factors_factor(q, g, mode, 0, &k), NS_OK);
        assert_int_equal(ns_sparse_factors_solve(q, k, r, v), NS_OK);
        assert_true(rest(f, g, mode, r, v) < 1e-12);
    }
    assert_int_equal(q->made, 1);
    assert_int_equal(q->updated, 0);
    free(r);
    free(mode);
    free(twin);
    ns_sparse_factors_free(q);
    ns_sparse_form_free(f);
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_walk), cmocka_unit_test(test_loose),
                                       cmocka_unit_test(test_evicted), cmocka_unit_test(test_stand_in)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
