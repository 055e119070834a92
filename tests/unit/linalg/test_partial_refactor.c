/* tests/unit/linalg/test_partial_refactor.c - pivots chosen once for many matrices: rows that change, and
 * where they fail. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "dice.h"
#include "linalg/sparse.h"
#include "linalg/sparse_lu.h"
#include "nonsmooth/status.h"
#include "wrap_alloc.h"

enum { N = 60 };

/* Blocks of up to five unknowns that later ones enter, in rows and columns at random. */
static void make_blocks(dice *d, ns_csc *a) {
    ns_entries e = {0};
    int row[N], column[N];
    for (int i = 0; i < N; i++) {
        const int j = dice_below(d, i + 1), k = dice_below(d, i + 1);
        row[i] = row[j];
        row[j] = i;
        column[i] = column[k];
        column[k] = i;
    }
    for (int first = 0, last; first < N; first = last) {
        last = first + 1 + dice_below(d, 5);
        last = last < N ? last : N;
        for (int j = first; j < last; j++)
            for (int i = 0; i < last; i++)
                if (i >= first || dice_below(d, 8) == 0)
                    ns_linalg_entries_add(&e, row[i], column[j], dice_either(d) + 6 * (i == j));
    }
    assert_int_equal(ns_linalg_csc_of_entries(N, N, &e, a), NS_OK);
    ns_linalg_entries_free(&e);
}

/* Other values in a row, about those of base. */
static void redraw(dice *d, const double *base, ns_csc *a, int row) {
    for (int p = 0; p < a->start[N]; p++)
        if (a->row[p] == row)
            a->value[p] = base[p] * (1 + 0.2 * dice_either(d));
}

static double rest(const ns_csc *a, const double *b, const double *x) {
    double r[N], worst = 0;
    for (int i = 0; i < a->rows; i++)
        r[i] = -b[i];
    ns_linalg_csc_times_add(a, x, r);
    for (int i = 0; i < a->rows; i++)
        worst = fmax(worst, fabs(r[i]));
    return worst;
}

/* What changes row by row is what the whole would be, to the last bit. */
static void test_rows(void **state) {
    (void)state;
    dice d = dice_make(12, 0);
    ns_csc a;
    ns_klu *k;
    ns_factors *f = NULL;
    make_blocks(&d, &a);
    assert_int_equal(ns_linalg_klu_create(N, a.start, a.row, &k), NS_OK);
    assert_false(ns_linalg_klu_is_partial(k));
    assert_int_equal(ns_linalg_klu_partial(k, a.value), NS_OK);
    assert_true(ns_linalg_klu_is_partial(k));
    assert_int_equal(ns_linalg_klu_factor(k, a.value, &f), NS_OK);
    double *base = malloc(sizeof *base * (size_t)a.start[N]);
    int served = 0;
    memcpy(base, a.value, sizeof *base * (size_t)a.start[N]);
    for (int round = 0; round < 300; round++) {
        ns_factors *whole = NULL;
        double b[N], x[N], y[N];
        int row[3], rows = 1 + dice_below(&d, 3);
        for (int i = 0; i < rows; i++)
            redraw(&d, base, &a, row[i] = dice_below(&d, N));
        const int good = ns_linalg_klu_change(k, f, a.value, rows, row);
        if (!good)
            assert_int_equal(ns_linalg_klu_factor(k, a.value, &f), NS_OK);
        served += good;
        assert_int_equal(ns_linalg_klu_factor(k, a.value, &whole), NS_OK);
        for (int i = 0; i < N; i++)
            b[i] = x[i] = y[i] = dice_either(&d);
        ns_linalg_klu_solve(k, f, x);
        ns_linalg_klu_solve(k, whole, y);
        assert_true(rest(&a, b, x) < 1e-11);
        for (int i = 0; i < N && good; i++) /* else KLU chose what is better for each */
            assert_true(x[i] == y[i]);
        ns_linalg_factors_free(k, whole);
    }
    assert_true(served > 290 && ns_linalg_klu_is_partial(k));
    free(base);
    assert_true(ns_linalg_factors_bytes(k, f) > N * sizeof(double));
    ns_linalg_factors_free(k, f);
    ns_linalg_klu_free(k);
    ns_linalg_csc_free(&a);
}

/* A chain of cells, x_i and a current lambda_i into it, whose law is x_i = b or lambda_i = b: which, changes
 * all the time.  Pivots are those of a chain where all hold x. */
static void test_laws(void **state) {
    (void)state;
    enum { CELLS = N / 2 };
    dice d = dice_make(12, 2);
    ns_entries e = {0};
    ns_csc a;
    ns_klu *k;
    ns_factors *f = NULL;
    int is_open[CELLS] = {0}, places[2][CELLS];
    for (int i = 0; i < CELLS; i++) {
        ns_linalg_entries_add(&e, i, i, 3);
        ns_linalg_entries_add(&e, i, CELLS + i, -1);
        ns_linalg_entries_add(&e, CELLS + i, i, 1);
        ns_linalg_entries_add(&e, CELLS + i, CELLS + i, 1e-9);
        if (i > 0) {
            ns_linalg_entries_add(&e, i, i - 1, -1);
            ns_linalg_entries_add(&e, i - 1, i, -1);
        }
    }
    assert_int_equal(ns_linalg_csc_of_entries(N, N, &e, &a), NS_OK);
    ns_linalg_entries_free(&e);
    assert_int_equal(ns_linalg_klu_create(N, a.start, a.row, &k), NS_OK);
    assert_int_equal(ns_linalg_klu_partial(k, a.value), NS_OK);
    for (int j = 0; j < N; j++)
        for (int p = a.start[j]; p < a.start[j + 1]; p++)
            if (a.row[p] >= CELLS)
                places[j >= CELLS][a.row[p] - CELLS] = p;
    for (int i = 0; i < CELLS; i++)
        a.value[places[1][i]] = 0;
    assert_int_equal(ns_linalg_klu_factor(k, a.value, &f), NS_OK);
    for (int round = 0; round < 200; round++) {
        double b[N], x[N];
        int row[4];
        for (int c = 0; c < 4; c++) {
            const int i = dice_below(&d, CELLS), open = is_open[i] = !is_open[i];
            row[c] = CELLS + i;
            a.value[places[0][i]] = !open;
            a.value[places[1][i]] = open;
        }
        assert_int_equal(ns_linalg_klu_change(k, f, a.value, 4, row), 1);
        for (int i = 0; i < N; i++)
            b[i] = x[i] = dice_either(&d);
        ns_linalg_klu_solve(k, f, x);
        assert_true(rest(&a, b, x) < 1e-13);
    }
    assert_int_equal(ns_linalg_klu_fresh(k), 0);
    ns_linalg_factors_free(k, f);
    ns_linalg_klu_free(k);
    ns_linalg_csc_free(&a);
}

/* [1 0; 0 1], and then, with these pivots, [0 1; 1 0], [1e-12 1; 1 1e-12]: KLU's own have to do, until pivots
 * for all are no longer tried. */
static void test_refused(void **state) {
    (void)state;
    static const int both[] = {0, 1};
    int start[] = {0, 2, 4}, row[] = {0, 1, 0, 1};
    double one[] = {1, 0, 0, 1}, cross[] = {0, 1, 1, 0}, tiny[] = {1e-12, 1, 1, 1e-12}, no[] = {1, NAN, 0, 1};
    ns_klu *k;
    assert_int_equal(ns_linalg_klu_create(2, start, row, &k), NS_OK);
    assert_int_equal(ns_linalg_klu_partial(k, one), NS_OK);
    for (int round = 0; round < 30; round++) {
        ns_factors *f = NULL;
        double b[] = {3, 5}, c[] = {1, 2};
        assert_int_equal(ns_linalg_klu_factor(k, one, &f), NS_OK);
        assert_int_equal(ns_linalg_klu_change(k, f, cross, 2, both), 0);
        assert_int_equal(ns_linalg_klu_factor(k, cross, &f), NS_OK);
        ns_linalg_klu_solve(k, f, b);
        assert_true(b[0] == 5 && b[1] == 3);
        assert_int_equal(ns_linalg_klu_change(k, f, one, 2, both), 0); /* these are KLU's */
        assert_int_equal(ns_linalg_klu_factor(k, tiny, &f), NS_OK);
        ns_linalg_klu_solve(k, f, c);
        assert_true(fabs(c[0] - 2) < 1e-11 && fabs(c[1] - 1) < 1e-11);
        assert_int_equal(ns_linalg_klu_factor(k, no, &f), NS_E_NUMBER);
        assert_null(f);
    }
    assert_false(ns_linalg_klu_is_partial(k));
    ns_linalg_klu_free(k);
}

/* Of a matrix without an inverse there are no pivots to choose. */
static void test_singular(void **state) {
    (void)state;
    int start[] = {0, 2, 4}, row[] = {0, 1, 0, 1};
    double value[] = {1, 1, 1, 1};
    ns_klu *k;
    assert_int_equal(ns_linalg_klu_create(2, start, row, &k), NS_OK);
    assert_int_equal(ns_linalg_klu_partial(k, value), NS_OK);
    assert_false(ns_linalg_klu_is_partial(k));
    ns_linalg_klu_free(k);
    assert_int_equal(ns_linalg_klu_create(0, start, row, &k), NS_OK);
    assert_int_equal(ns_linalg_klu_partial(k, value), NS_OK);
    assert_false(ns_linalg_klu_is_partial(k));
    ns_linalg_klu_free(k);
}

/* Without memory it says so, and can be asked again. */
static void test_memory(void **state) {
    (void)state;
    dice d = dice_make(12, 1);
    ns_csc a;
    long at = 1;
    make_blocks(&d, &a);
    for (int failed = 1; failed; at++) {
        ns_klu *k;
        ns_factors *f = NULL;
        double b[N], x[N];
        assert_int_equal(ns_linalg_klu_create(N, a.start, a.row, &k), NS_OK);
        fail_alloc_at(at);
        int status = ns_linalg_klu_partial(k, a.value);
        if (status == NS_OK)
            status = ns_linalg_klu_factor(k, a.value, &f);
        fail_alloc_off();
        failed = status == NS_E_MEMORY;
        assert_true(failed || status == NS_OK);
        if (failed) {
            assert_null(f);
            assert_int_equal(ns_linalg_klu_partial(k, a.value), NS_OK);
            assert_int_equal(ns_linalg_klu_factor(k, a.value, &f), NS_OK);
        }
        assert_true(ns_linalg_klu_is_partial(k));
        for (int i = 0; i < N; i++)
            b[i] = x[i] = dice_either(&d);
        ns_linalg_klu_solve(k, f, x);
        assert_true(rest(&a, b, x) < 1e-11);
        ns_linalg_factors_free(k, f);
        ns_linalg_klu_free(k);
    }
    assert_true(at > 6);
    ns_linalg_csc_free(&a);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_rows), cmocka_unit_test(test_laws),
                                       cmocka_unit_test(test_refused), cmocka_unit_test(test_singular),
                                       cmocka_unit_test(test_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
