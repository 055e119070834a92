/* tests/unit/linalg/test_cut_sets.c - which charges of a network of capacitors are summed. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "linalg/cut_sets.h"
#include "linalg/row_split.h"
#include "nonsmooth/status.h"
#include "wrap_alloc.h"

enum { N = 4 };

typedef struct network {
    double M[N * N], T[N * N], TM[N * N];
    int rank;
} network;

/* p, n: nodes, -1: ground. */
static void capacitor(network *w, int p, int n, double farads) {
    if (p >= 0)
        w->M[p + p * N] += farads;
    if (n >= 0)
        w->M[n + n * N] += farads;
    if (p >= 0 && n >= 0) {
        w->M[p + n * N] -= farads;
        w->M[n + p * N] -= farads;
    }
}

static void split(network *w) {
    assert_int_equal(ns_linalg_row_split(N, w->M, w->T, &w->rank), NS_OK);
    ns_linalg_row_split_apply(N, N, w->T, w->M, w->TM);
    assert_int_equal(ns_linalg_cut_sets(N, w->M, w->rank, w->T, w->TM), NS_OK);
}

/* The largest entry of row i of T M. */
static double largest(const network *w, int i) {
    double most = 0;
    for (int j = 0; j < N; j++)
        most = fmax(most, fabs(w->TM[i + j * N]));
    return most;
}

/* Every row is a sum of rows of M: T M as it is defined, but for what 1 mF leaves of its own rounding. */
static void is_product(const network *w) {
    for (int i = 0; i < w->rank; i++)
        for (int j = 0; j < N; j++) {
            double sum = 0;
            for (int k = 0; k < N; k++)
                sum += w->T[i + k * N] * w->M[k + j * N];
            assert_true(fabs(sum - w->TM[i + j * N]) < 1e-18);
        }
}

static int rows_below(const network *w, double farads) {
    int count = 0;
    for (int i = 0; i < w->rank; i++)
        count += largest(w, i) < farads;
    return count;
}

/* 0 - 1 mF - 1 - 1 pF - 2 - 1 mF - 3 and nothing to ground: two charges are those of 1 mF, one is that of 1
 * pF, and that exactly, in whatever order nodes are given. */
static void one_charge_a_capacitor(void **state) {
    (void)state;
    for (int turn = 0; turn < N; turn++) {
        network w = {.rank = 0};
        capacitor(&w, turn, (turn + 1) % N, 1e-3);
        capacitor(&w, (turn + 1) % N, (turn + 2) % N, 1e-12);
        capacitor(&w, (turn + 2) % N, (turn + 3) % N, 1e-3);
        split(&w);
        assert_int_equal(w.rank, 3);
        assert_int_equal(rows_below(&w, 1e-6), 1);
        is_product(&w);
        for (int i = 0; i < w.rank; i++)
            if (largest(&w, i) < 1e-6)
                assert_true(largest(&w, i) == 1e-12);
    }
}

/* The same with 2 pF from one end to ground. */
static void ground_is_outside(void **state) {
    network w = {.rank = 0};
    (void)state;
    capacitor(&w, 0, 1, 1e-3);
    capacitor(&w, 1, 2, 1e-12);
    capacitor(&w, 2, 3, 1e-3);
    capacitor(&w, 3, -1, 2e-12);
    split(&w);
    assert_int_equal(w.rank, 4);
    assert_int_equal(rows_below(&w, 1e-6), 2);
    is_product(&w);
}

/* Capacitors of one size, and coupled inductors: rows of M as they are. */
static void others_stay(void **state) {
    network w = {.M = {2e-6, -1e-6, 0, 0, -1e-6, 1e-6, 0, 0, 0, 0, 1e-3, 9.99e-4, 0, 0, 9.99e-4, 1e-3}};
    double T[N * N] = {0};
    (void)state;
    split(&w);
    for (int i = 0; i < N; i++)
        T[i + i * N] = 1;
    assert_memory_equal(w.T, T, sizeof T);
    assert_memory_equal(w.TM, w.M, sizeof T);
}

static void memory_may_run_out(void **state) {
    network w = {.rank = 0};
    (void)state;
    capacitor(&w, 0, 1, 1);
    for (long k = 1; k <= 2; k++) {
        fail_alloc_at(k);
        assert_int_equal(ns_linalg_cut_sets(N, w.M, 0, w.T, w.TM), NS_E_MEMORY);
        fail_alloc_off();
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_charge_a_capacitor),
        cmocka_unit_test(ground_is_outside),
        cmocka_unit_test(others_stay),
        cmocka_unit_test(memory_may_run_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
