/* tests/unit/linalg/test_summed_parts.c - which parts of a network of resistors are summed into one row. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "linalg/row_split.h"
#include "linalg/summed_parts.h"
#include "nonsmooth/status.h"
#include "wrap_alloc.h"

enum { N = 5 };

typedef struct network {
    double A[N * N], M[N * N], T[N * N], TA[N * N];
    int rank;
} network;

static void branch(double *a, int p, int n, double value) {
    if (p >= 0)
        a[p + p * N] += value;
    if (n >= 0)
        a[n + n * N] += value;
    if (p >= 0 && n >= 0) {
        a[p + n * N] -= value;
        a[n + p * N] -= value;
    }
}

/* 10, 10 and 11.43 ohm from node 0 to 1, 2, 3; a coil's current, unknown 4, leaves node 1. */
static void make_star(network *w) {
    memset(w, 0, sizeof *w);
    branch(w->A, 0, 1, -1 / 10.0);
    branch(w->A, 0, 2, -1 / 11.43);
    branch(w->A, 0, 3, -1 / 10.0);
    w->A[1 + 4 * N] = -1;
    w->A[4 + 1 * N] = 1;
    w->M[4 + 4 * N] = 1e-3;
}

/* How many rows of T are sums of several, which must be of the `size` first ones. */
static int sums(network *w, int size) {
    int count = 0;
    assert_int_equal(ns_linalg_row_split(N, w->M, w->T, &w->rank), NS_OK);
    double before[N * N];
    memcpy(before, w->T, sizeof before);
    assert_int_equal(ns_linalg_summed_parts(N, w->A, w->M, w->rank, w->T), NS_OK);
    ns_linalg_row_split_apply(N, N, w->T, w->A, w->TA);
    for (int i = 0; i < N; i++) {
        int changed = 0;
        for (int j = 0; j < N; j++)
            changed |= w->T[i + j * N] != before[i + j * N];
        for (int j = 0; j < N && changed; j++)
            assert_true(w->T[i + j * N] == (j < size));
        count += changed;
    }
    return count;
}

/* The sum has nothing but the coil's current. */
static void a_star_is_summed(void **state) {
    network w;
    int found = 0;
    (void)state;
    make_star(&w);
    assert_int_equal(sums(&w, 4), 1);
    for (int i = 0; i < N; i++) {
        int alone = w.TA[i + 4 * N] == -1;
        for (int j = 0; j < 4; j++)
            alone &= w.TA[i + j * N] == 0;
        found += alone;
    }
    assert_int_equal(found, 1);
}

/* With 1 Tohm or 1 pF from one end to ground it does not float. */
static void ground_ends_a_part(void **state) {
    network w;
    (void)state;
    make_star(&w);
    branch(w.A, 3, -1, -1e-12);
    assert_int_equal(sums(&w, 4), 0);
    make_star(&w);
    branch(w.M, 3, -1, 1e-12);
    assert_int_equal(sums(&w, 4), 0);
}

/* Within the part a capacitor cancels as resistors do. */
static void a_capacitor_inside(void **state) {
    network w;
    (void)state;
    make_star(&w);
    branch(w.M, 2, 3, 1e-6);
    assert_int_equal(sums(&w, 4), 1);
}

/* A capacitor in place of a resistor: what it joins is summed as well. */
static void a_capacitor_joins(void **state) {
    network w;
    (void)state;
    make_star(&w);
    branch(w.A, 0, 3, 1 / 10.0);
    branch(w.M, 2, 3, 1e-6);
    assert_int_equal(sums(&w, 4), 1);
}

/* A resistor and a capacitor in series: one branch in A, one in M, each of which cancels exactly. */
static void a_chain_of_two_kinds_stays(void **state) {
    network w;
    (void)state;
    memset(&w, 0, sizeof w);
    branch(w.A, 0, 1, -1 / 3.0);
    branch(w.M, 1, 2, 1e-6);
    assert_int_equal(sums(&w, 3), 0);
}

/* One resistor: g and -g cancel as they are. */
static void two_nodes_stay(void **state) {
    network w;
    (void)state;
    memset(&w, 0, sizeof w);
    branch(w.A, 0, 1, -1 / 3.0);
    branch(w.A, 2, -1, -1 / 3.0);
    assert_int_equal(sums(&w, 2), 0);
}

static void memory_may_run_out(void **state) {
    network w;
    (void)state;
    make_star(&w);
    fail_alloc_at(1);
    assert_int_equal(ns_linalg_summed_parts(N, w.A, w.M, 0, w.T), NS_E_MEMORY);
    fail_alloc_off();
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_star_is_summed),           cmocka_unit_test(ground_ends_a_part),
        cmocka_unit_test(a_capacitor_inside),         cmocka_unit_test(a_capacitor_joins),
        cmocka_unit_test(a_chain_of_two_kinds_stays), cmocka_unit_test(two_nodes_stay),
        cmocka_unit_test(memory_may_run_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
