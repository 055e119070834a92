/* tests/unit/linalg/test_leakage.c - which fluxes of coupled coils are less those of others. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "linalg/leakage.h"
#include "linalg/row_split.h"
#include "nonsmooth/status.h"
#include "wrap_alloc.h"

enum { N = 4 };

typedef struct coils {
    double M[N * N], T[N * N], TM[N * N];
    int rank;
} coils;

/* Coil i of an inductance, coupled to those before by k. */
static void coil(coils *w, int i, double henry, double k) {
    w->M[i + i * N] = henry;
    for (int j = 0; j < i; j++)
        w->M[i + j * N] = w->M[j + i * N] = k * sqrt(henry * w->M[j + j * N]);
}

static void split(coils *w) {
    assert_int_equal(ns_linalg_row_split(N, w->M, w->T, &w->rank), NS_OK);
    ns_linalg_row_split_apply(N, N, w->T, w->M, w->TM);
    assert_int_equal(ns_linalg_leakage(N, w->M, w->rank, w->T, w->TM), NS_OK);
}

static double largest(const coils *w, int i) {
    double most = 0;
    for (int j = 0; j < N; j++)
        most = fmax(most, fabs(w->TM[i + j * N]));
    return most;
}

/* T M as it is defined, to the rounding of M. */
static void is_product(const coils *w) {
    for (int i = 0; i < w->rank; i++)
        for (int j = 0; j < N; j++) {
            double sum = 0;
            for (int k = 0; k < N; k++)
                sum += w->T[i + k * N] * w->M[k + j * N];
            assert_true(fabs(sum - w->TM[i + j * N]) <= 1e-15 * w->M[j + j * N]);
        }
}

/* k = 0.9999 among four coils of 1 H, on either end of each: one flux is that of 1 H, the others are at most
 * the leakage 1 - k^2 = 2e-4 H. */
static void all_but_one_are_leakage(void **state) {
    (void)state;
    for (int turned = 0; turned <= N; turned++) {
        coils w = {.rank = 0};
        int large = 0;
        for (int i = 0; i < N; i++)
            coil(&w, i, 1, 0.9999);
        for (int j = 0; j < N && turned < N; j++) {
            w.M[turned + j * N] = -w.M[turned + j * N];
            w.M[j + turned * N] = -w.M[j + turned * N];
        }
        split(&w);
        assert_int_equal(w.rank, N);
        is_product(&w);
        for (int i = 0; i < N; i++)
            large += largest(&w, i) > 2.0001e-4;
        assert_int_equal(large, 1);
    }
}

/* k = 1: the rank is 1, and nothing is left to subtract; k = 0.5: three quarters of each inductance are left.
 */
static void others_stay(void **state) {
    const double k[] = {1, 0.5};
    (void)state;
    for (int of = 0; of < 2; of++) {
        coils w = {.rank = 0}, before;
        for (int i = 0; i < 2; i++)
            coil(&w, i, 1e-3, k[of]);
        assert_int_equal(ns_linalg_row_split(N, w.M, w.T, &w.rank), NS_OK);
        ns_linalg_row_split_apply(N, N, w.T, w.M, w.TM);
        assert_int_equal(w.rank, of + 1);
        before = w;
        assert_int_equal(ns_linalg_leakage(N, w.M, w.rank, w.T, w.TM), NS_OK);
        assert_memory_equal(&w, &before, sizeof w);
    }
}

/* 1 mF between two nodes with 1 pF to ground: rows of capacitors are sums of rows, in cut_sets.c. */
static void capacitors_stay(void **state) {
    coils w = {.M = {1e-3, -1e-3, 0, 0, -1e-3, 1e-3 + 1e-12, 0, 0}}, before;
    (void)state;
    assert_int_equal(ns_linalg_row_split(N, w.M, w.T, &w.rank), NS_OK);
    ns_linalg_row_split_apply(N, N, w.T, w.M, w.TM);
    before = w;
    assert_int_equal(ns_linalg_leakage(N, w.M, w.rank, w.T, w.TM), NS_OK);
    assert_memory_equal(&w, &before, sizeof w);
}

static void memory_may_run_out(void **state) {
    coils w = {.rank = 0};
    (void)state;
    for (int i = 0; i < N; i++)
        coil(&w, i, 1, 0.99);
    split(&w);
    for (long k = 1; k <= 2; k++) {
        fail_alloc_at(k);
        assert_int_equal(ns_linalg_leakage(N, w.M, 0, w.T, w.TM), k == 1 ? NS_E_MEMORY : NS_OK);
        fail_alloc_off();
    }
    ns_linalg_row_split(N, w.M, w.T, &w.rank);
    fail_alloc_at(2);
    assert_int_equal(ns_linalg_leakage(N, w.M, w.rank, w.T, w.TM), NS_E_MEMORY);
    fail_alloc_off();
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_but_one_are_leakage),
        cmocka_unit_test(others_stay),
        cmocka_unit_test(capacitors_stay),
        cmocka_unit_test(memory_may_run_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
