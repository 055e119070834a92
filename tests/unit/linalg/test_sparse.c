/* tests/unit/linalg/test_sparse.c - sparse matrices and their factors. */
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
#include "wrap_alloc.h"

/* Row by row: 4 0 1 / 0 3 0 / 2 0 5, entered out of order and in parts. */
static void enter(ns_entries *e) {
    ns_linalg_entries_add(e, 2, 2, 5);
    ns_linalg_entries_add(e, 0, 0, 1);
    ns_linalg_entries_add(e, 2, 0, 2);
    ns_linalg_entries_add(e, 0, 2, 1);
    ns_linalg_entries_add(e, 0, 0, 3);
    ns_linalg_entries_add(e, 1, 1, 3);
}

static void test_entries(void **state) {
    (void)state;
    static const int start[] = {0, 2, 3, 5}, row[] = {0, 2, 1, 0, 2};
    static const double value[] = {4, 2, 3, 1, 5}, x[] = {1, 2, 3};
    ns_entries e = {0};
    ns_csc a, t;
    enter(&e);
    assert_int_equal(ns_linalg_csc_of_entries(3, 3, &e, &a), NS_OK);
    assert_memory_equal(a.start, start, sizeof start);
    assert_memory_equal(a.row, row, sizeof row);
    assert_memory_equal(a.value, value, sizeof value);
    double y[3] = {0};
    ns_linalg_csc_times_add(&a, x, y); /* 4+3, 6, 2+15 */
    assert_true(y[0] == 7 && y[1] == 6 && y[2] == 17);
    assert_true(ns_linalg_csc_dot(&a, 0, x) == 10 && ns_linalg_csc_dot(&a, 1, x) == 6 &&
                ns_linalg_csc_dot(&a, 2, x) == 16);
    assert_int_equal(ns_linalg_csc_transpose(&a, &t), NS_OK);
    assert_true(ns_linalg_csc_dot(&t, 0, x) == 7);
    ns_linalg_csc_free(&a);
    ns_linalg_csc_free(&t);
    ns_linalg_entries_free(&e);
}

/* 0.1 - 0.3 + 0.2 is 2^-54, and rounding of its terms; 1e-14 beside 1 is not. */
static void test_terms(void **state) {
    ns_entries e = {0};
    ns_csc a;
    (void)state;
    ns_linalg_entries_add(&e, 1, 0, 0.1);
    ns_linalg_entries_add(&e, 0, 0, 1);
    ns_linalg_entries_add(&e, 1, 0, -0.3);
    ns_linalg_entries_add(&e, 0, 1, 1 + 1e-14);
    ns_linalg_entries_add(&e, 1, 0, 0.2);
    ns_linalg_entries_add(&e, 0, 1, -1);
    assert_int_equal(ns_linalg_csc_of_terms(2, 2, &e, &a), NS_OK);
    assert_int_equal(a.start[1], 1);
    assert_int_equal(a.start[2], 2);
    assert_true(a.row[0] == 0 && a.value[0] == 1);
    assert_true(a.row[1] == 0 && fabs(a.value[1] - 1e-14) < 1e-16);
    ns_linalg_csc_free(&a);
    ns_linalg_entries_free(&e);
}

static void test_dense(void **state) {
    (void)state;
    static const double a[] = {0, 1, 2, 0, 0, 3}; /* 2*3 */
    ns_csc s;
    assert_int_equal(ns_linalg_csc_of_dense(2, 3, a, &s), NS_OK);
    assert_int_equal(s.start[3], 3);
    assert_true(s.row[0] == 1 && s.value[0] == 1 && s.row[1] == 0 && s.value[1] == 2 && s.value[2] == 3);
    ns_linalg_csc_free(&s);
    assert_int_equal(ns_linalg_csc_of_dense(0, 3, NULL, &s), NS_OK);
    assert_int_equal(s.start[3], 0);
    ns_linalg_csc_free(&s);
}

/* A chain of n unknowns: 2 on the diagonal, -1 beside it; the inverse of that is (i+1)(n-j)/(n+1), i <= j. */
static void chain(int n, ns_csc *a) {
    ns_entries e = {0};
    for (int i = 0; i < n; i++) {
        ns_linalg_entries_add(&e, i, i, 2);
        if (i > 0) {
            ns_linalg_entries_add(&e, i, i - 1, -1);
            ns_linalg_entries_add(&e, i - 1, i, -1);
        }
    }
    assert_int_equal(ns_linalg_csc_of_entries(n, n, &e, a), NS_OK);
    ns_linalg_entries_free(&e);
}

static void test_factors(void **state) {
    (void)state;
    enum { N = 50 };
    ns_csc a;
    ns_klu *k;
    ns_factors *f = NULL;
    double b[2 * N] = {0};
    chain(N, &a);
    assert_int_equal(ns_linalg_klu_create(N, a.start, a.row, &k), NS_OK);
    assert_int_equal(ns_linalg_klu_factor(k, a.value, &f), NS_OK);
    b[20] = 1;
    b[N + 0] = 1;
    ns_linalg_klu_solve(k, f, b);
    ns_linalg_klu_solve(k, f, b + N);
    for (int i = 0; i < N; i++) {
        const double lo = i < 20 ? i : 20, hi = i < 20 ? 20 : i;
        assert_true(fabs(b[i] - (lo + 1) * (N - hi) / (N + 1)) < 1e-13 * N);
        assert_true(fabs(b[N + i] - (double)(N - i) / (N + 1)) < 1e-13 * N);
    }
    for (int i = 0; i < a.start[N]; i++)
        a.value[i] *= -2;
    assert_int_equal(ns_linalg_klu_factor(k, a.value, &f), NS_OK); /* with the pivots of before */
    assert_int_equal(ns_linalg_klu_refactor(k), 1);
    memset(b, 0, sizeof b);
    b[0] = 1;
    ns_linalg_klu_solve(k, f, b);
    assert_true(fabs(b[0] + 0.5 * N / (N + 1)) < 1e-13 * N);
    assert_true(ns_linalg_factors_bytes(k, f) > N * sizeof(double));
    ns_linalg_factors_free(k, f);
    ns_linalg_klu_free(k);
    ns_linalg_csc_free(&a);
}

/* [1 0; 0 1] and then [0 1; 1 0] at the same places: old pivots are zero. */
static void test_pivots_anew(void **state) {
    (void)state;
    int start[] = {0, 2, 4}, row[] = {0, 1, 0, 1};
    double b[] = {3, 5};
    ns_klu *k;
    ns_factors *f = NULL;
    assert_int_equal(ns_linalg_klu_create(2, start, row, &k), NS_OK);
    assert_int_equal(ns_linalg_klu_factor(k, (double[]){1, 0, 0, 1}, &f), NS_OK);
    assert_int_equal(ns_linalg_klu_factor(k, (double[]){0, 1, 1, 0}, &f), NS_OK);
    assert_int_equal(ns_linalg_klu_fresh(k), 2);
    ns_linalg_klu_solve(k, f, b);
    assert_true(b[0] == 5 && b[1] == 3);
    /* nearly so: pivots of 1e-12 would cost digits */
    assert_int_equal(ns_linalg_klu_factor(k, (double[]){1, 1e-12, 1e-12, 1}, &f), NS_OK);
    assert_int_equal(ns_linalg_klu_factor(k, (double[]){1e-12, 1, 1, 1e-12}, &f), NS_OK);
    assert_int_equal(ns_linalg_klu_factor(k, (double[]){1, 1, 1, 1}, &f), NS_E_SINGULAR);
    assert_null(f);
    assert_int_equal(ns_linalg_klu_factor(k, (double[]){1, NAN, 1, 1}, &f), NS_E_NUMBER);
    assert_null(f);
    ns_linalg_factors_free(k, NULL);
    ns_linalg_klu_free(k);
    ns_linalg_klu_free(NULL);
}

/* A x - b of a matrix with all n*n places. */
static double rest_of_full(int n, const double *a, const double *b, const double *x) {
    double worst = 0;
    for (int i = 0; i < n; i++) {
        double sum = -b[i];
        for (int j = 0; j < n; j++)
            sum += a[i + j * n] * x[j];
        worst = fmax(worst, fabs(sum));
    }
    return worst;
}

/* The largest error of a row in the solution, relative to the terms that the row is summed from. */
static double off_by(int n, const double *a, const double *b, const double *x) {
    double worst = 0;
    for (int i = 0; i < n; i++) {
        double sum = -b[i], terms = fabs(b[i]);
        for (int j = 0; j < n; j++) {
            sum += a[i + j * n] * x[j];
            terms += fabs(a[i + j * n] * x[j]);
        }
        worst = fmax(worst, fabs(sum) / terms);
    }
    return worst;
}

/* d on the diagonal, 1 below it and in the last column: with the diagonal as pivots the last column grows 1/d
 * times a row. */
static void growing(int n, double d, double *a) {
    for (int j = 0; j < n; j++)
        for (int i = 0; i < n; i++)
            a[i + j * n] = j == n - 1 || i > j ? 1 : i == j ? d : 0;
}

/* With d = 1.5e-3 the diagonal has what KLU takes for pivots, a thousandth of their columns.  With d = 2.7e-4
 * entries grow a thousand times more, which was allowed, and a row of the solution was off by 2e-3 of its
 * terms (measured): pivots are chosen anew. */
static void test_pivots_of_others(void **state) {
    enum { N = 5 };
    int start[N + 1], row[N * N];
    double a[N * N], b[N] = {1, -1, 1, -1, 1}, x[N] = {1, -1, 1, -1, 1};
    ns_klu *k;
    ns_factors *f = NULL;
    (void)state;
    for (int j = 0; j <= N; j++)
        start[j] = j * N;
    for (int p = 0; p < N * N; p++)
        row[p] = p % N;
    assert_int_equal(ns_linalg_klu_create(N, start, row, &k), NS_OK);
    growing(N, 1.5e-3, a);
    assert_int_equal(ns_linalg_klu_factor(k, a, &f), NS_OK);
    growing(N, 2.7e-4, a);
    assert_int_equal(ns_linalg_klu_factor(k, a, &f), NS_OK);
    ns_linalg_klu_solve(k, f, x);
    assert_int_equal(ns_linalg_klu_fresh(k), 2);
    assert_true(off_by(N, a, b, x) < 1e-12);
    ns_linalg_factors_free(k, f);
    ns_linalg_klu_free(k);
}

/* All places, few of them used: factors of the shared pattern fill up, which the first one shows.  After it
 * each matrix has its own pattern: the second is fresh, one of the same places or fewer is not, one of others
 * is, and one without a column is told to be singular. */
static void test_own_patterns(void **state) {
    (void)state;
    enum { N = 20 };
    int start[N + 1], row[N * N];
    double a[N * N] = {0}, b[N], x[N];
    long fresh[] = {1, 2, 2, 2, 3}, again[] = {0, 0, 1, 2, 2};
    ns_klu *k;
    ns_factors *f = NULL;
    for (int j = 0; j <= N; j++)
        start[j] = N * j;
    for (int p = 0; p < N * N; p++)
        row[p] = p % N;
    for (int i = 0; i < N; i++) {
        a[i + i * N] = 2;
        a[(i + 1) % N + i * N] = a[i + (i + 1) % N * N] = i + 1 < N ? -1 : 0;
        b[i] = i;
    }
    assert_int_equal(ns_linalg_klu_create(N, start, row, &k), NS_OK);
    for (int round = 0; round < 5; round++) {
        if (round == 2)
            a[0] = 3;
        if (round == 3)
            a[N] = 0; /* row 0, column 1 */
        if (round == 4)
            a[N - 1] = 1; /* the last row, column 0 */
        assert_int_equal(ns_linalg_klu_factor(k, a, &f), NS_OK);
        assert_int_equal(ns_linalg_klu_fresh(k), fresh[round]);
        assert_int_equal(ns_linalg_klu_refactor(k), again[round]);
        for (int times = 0; times < 4; times++) {
            memcpy(x, b, sizeof x);
            ns_linalg_klu_solve(k, f, x);
            assert_true(rest_of_full(N, a, b, x) < 1e-12);
        }
    }
    assert_true(ns_linalg_factors_bytes(k, f) > N * sizeof(double));
    memset(a, 0, N * sizeof *a); /* column 0 */
    assert_int_equal(ns_linalg_klu_factor(k, a, &f), NS_E_SINGULAR);
    assert_null(f);
    ns_linalg_klu_free(k);
}

/* Blocks of 1 to 5 unknowns, each with something of those before it, rows and columns shuffled and in units
 * of their own.  However often, KLU's own way first and packed later, and whether rows that are often zero
 * are or not: A x = b holds to rounding. */
static void test_often(void **state) {
    (void)state;
    enum { N = 60 };
    dice d = dice_make(11, 0);
    ns_entries e = {0};
    int row[N], column[N];
    for (int i = 0; i < N; i++) {
        const int j = dice_below(&d, i + 1), k = dice_below(&d, i + 1);
        row[i] = row[j];
        row[j] = i;
        column[i] = column[k];
        column[k] = i;
    }
    for (int first = 0, last; first < N; first = last) {
        last = first + 1 + dice_below(&d, 5);
        last = last < N ? last : N;
        for (int j = first; j < last; j++)
            for (int i = 0; i < last; i++)
                if (i >= first || dice_below(&d, 8) == 0)
                    ns_linalg_entries_add(&e, row[i], column[j],
                                          ldexp(dice_either(&d) + 4 * (i == j), row[i] % 7));
    }
    ns_csc a;
    ns_klu *k;
    ns_factors *f = NULL;
    assert_int_equal(ns_linalg_csc_of_entries(N, N, &e, &a), NS_OK);
    assert_int_equal(ns_linalg_klu_create(N, a.start, a.row, &k), NS_OK);
    ns_linalg_klu_often_zero(k, N / 2);
    assert_int_equal(ns_linalg_klu_factor(k, a.value, &f), NS_OK);
    for (int times = 0; times < 12; times++) {
        double b[N], x[N], rest[N];
        for (int i = 0; i < N; i++)
            x[i] = rest[i] = b[i] = times < 6 && i >= N / 2 ? 0 : dice_either(&d);
        ns_linalg_klu_solve(k, f, x);
        for (int j = 0; j < N; j++)
            for (int p = a.start[j]; p < a.start[j + 1]; p++)
                rest[a.row[p]] -= a.value[p] * x[j];
        for (int i = 0; i < N; i++)
            assert_true(fabs(rest[i]) < 1e-12);
    }
    ns_linalg_factors_free(k, f);
    ns_linalg_klu_free(k);
    ns_linalg_csc_free(&a);
    ns_linalg_entries_free(&e);
}

/* An empty column: no values help. */
static void test_structure(void **state) {
    (void)state;
    int start[] = {0, 2, 2}, row[] = {0, 1};
    ns_klu *k;
    ns_factors *f = NULL;
    assert_int_equal(ns_linalg_klu_create(2, start, row, &k), NS_E_SINGULAR);
    assert_null(k);
    assert_int_equal(ns_linalg_klu_create(0, start, row, &k), NS_OK);
    assert_int_equal(ns_linalg_klu_factor(k, NULL, &f), NS_OK);
    ns_linalg_klu_solve(k, f, NULL);
    ns_linalg_factors_free(k, f);
    ns_linalg_klu_free(k);
}

/* All that takes memory, KLU included. */
static int all_of_it(void) {
    ns_entries e = {0};
    ns_csc a = {0};
    ns_klu *k = NULL;
    ns_factors *f = NULL;
    enter(&e);
    int status = ns_linalg_csc_of_entries(3, 3, &e, &a);
    if (status == NS_OK)
        status = ns_linalg_klu_create(3, a.start, a.row, &k);
    if (status == NS_OK)
        status = ns_linalg_klu_factor(k, a.value, &f);
    if (k)
        ns_linalg_factors_free(k, f);
    ns_linalg_klu_free(k);
    ns_linalg_csc_free(&a);
    ns_linalg_entries_free(&e);
    return status;
}

static void test_memory(void **state) {
    (void)state;
    fail_alloc_in_suitesparse(1);
    for (long k = 1;; k++) {
        fail_alloc_at(k);
        const int status = all_of_it();
        const long made = allocs_made();
        fail_alloc_off();
        if (made < k) {
            assert_int_equal(status, NS_OK);
            assert_true(k > 10);
            break;
        }
        assert_int_equal(status, NS_E_MEMORY);
    }
    fail_alloc_in_suitesparse(0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_entries),      cmocka_unit_test(test_terms),
        cmocka_unit_test(test_dense),        cmocka_unit_test(test_factors),
        cmocka_unit_test(test_pivots_anew),  cmocka_unit_test(test_pivots_of_others),
        cmocka_unit_test(test_own_patterns), cmocka_unit_test(test_often),
        cmocka_unit_test(test_structure),    cmocka_unit_test(test_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
