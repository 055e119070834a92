/* tests/unit/linalg/test_row_split.c - rows combined: what counts as rounding. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "linalg/row_split.h"
#include "nonsmooth/status.h"
#include "wrap_alloc.h"

/* 0.1 - 0.3 + 0.2 is 2^-54 and counts as zero; so does nothing that is larger than rounding. */
static void what_cancels_is_zero(void **state) {
    const double T[9] = {1, 0, 0, 0, 1, 0, 1, 1, 1};
    const double from[6] = {0.1, -0.3, 0.2, 1, 1e-14, -1};
    double to[6];
    (void)state;
    ns_linalg_row_split_apply(3, 2, (const double[]){1, 0, 1, 0, 1, 1, 0, 0, 1}, from, to);
    assert_true(to[0] == 0.1 && to[1] == -0.3 && to[2] == 0);
    assert_true(to[3] == 1 && to[4] == 1e-14 && fabs(to[5] - 1e-14) < 1e-16);
    ns_linalg_row_split_apply(3, 1, T, from, to);
    assert_true(to[0] == 0.1 + 0.2 && to[1] == -0.3 + 0.2 && to[2] == 0.2);
}

/* A row that is summed from terms as large as `size` may be rounding; one that is not, is not. */
static void rank_counts_what_entries_were_summed_from(void **state) {
    const double M[4] = {1, 0, 0, 1e-14}, summed[4] = {1, 0, 0, 1};
    double T[4];
    int rank;
    (void)state;
    assert_int_equal(ns_linalg_row_split(2, M, T, &rank), NS_OK);
    assert_int_equal(rank, 2);
    assert_int_equal(ns_linalg_row_split_rows(2, M, summed, T, &rank), NS_OK);
    assert_int_equal(rank, 1);
    assert_int_equal(ns_linalg_row_split(0, NULL, NULL, &rank), NS_OK);
    assert_int_equal(rank, 0);
    assert_int_equal(ns_linalg_row_split(2, NULL, T, &rank), NS_E_NULL);
    for (long k = 1; k <= 4; k++) {
        fail_alloc_at(k);
        assert_int_equal(ns_linalg_row_split(2, M, T, &rank), NS_E_MEMORY);
        fail_alloc_off();
    }
}

/* Of three capacitors to node `middle`, much less flows in the rows of their other ends: these stay, whatever
 * the order of rows, and the middle's becomes the sum of all.  Where as much flows in all, any may; but a
 * pivot 100 times smaller is not taken because less flows there. */
static void little_flows_in_rows_that_stay(void **state) {
    static const double farads[4] = {1, 3, 0.5, 2};
    (void)state;
    for (int middle = 0; middle < 4; middle++) {
        double M[16] = {0}, T[16], flow[4] = {1e-5, 1e-5, 1e-5, 1e-5};
        int rank;
        flow[middle] = 1;
        for (int i = 0; i < 4; i++)
            if (i != middle) {
                M[i + 4 * i] = farads[i];
                M[middle + 4 * middle] += farads[i];
                M[i + 4 * middle] = M[middle + 4 * i] = -farads[i];
            }
        assert_int_equal(ns_linalg_row_split_quiet(4, M, flow, T, &rank), NS_OK);
        assert_int_equal(rank, 3);
        for (int i = 0; i < 4; i++)
            assert_true(T[3 + 4 * i] == 1);
        for (int k = 0; k < 3; k++)
            assert_true(T[k + 4 * middle] == 0);
    }
}

/* Less flows in a row, but its pivot is 100 times smaller, or it is that of several branches, in place of
 * one: as if nothing were known. */
static void pivots_and_single_branches_come_first(void **state) {
    const double small[9] = {100.01, -100, -0.01, -100, 100, 0, -0.01, 0, 0.01},
                 at_small[3] = {1e-5, 1e-5, 1},
                 chain[9] = {1e-7, 0, -1e-7, 0, 1e-4, -1e-4, -1e-7, -1e-4, 1.001e-4}, at_ends[3] = {2, 1, 0};
    double T[9], as_before[9];
    int rank;
    (void)state;
    for (int k = 0; k < 2; k++) {
        assert_int_equal(ns_linalg_row_split(3, k ? chain : small, as_before, &rank), NS_OK);
        assert_int_equal(ns_linalg_row_split_quiet(3, k ? chain : small, k ? at_ends : at_small, T, &rank),
                         NS_OK);
        assert_int_equal(rank, 2);
        for (int i = 0; i < 9; i++)
            assert_true(T[i] == as_before[i]);
    }
}

/* 40 mF and 20 nF, joined by 1.367 fF to 0.3 F: beside 0.3 F hardly a digit of the fF is left, and none of
 * the multipliers that pass it.  What floats is the sum of all rows all the same. */
static void sums_are_exact_beside_rounding(void **state) {
    static const struct {
        int p, n;
        double farads;
    } c[4] = {{1, 3, 0.04}, {4, 0, 0.3}, {2, 1, 2e-8}, {4, 3, 1.367e-15}};
    double M[25] = {0}, T[25];
    int rank;
    (void)state;
    for (int k = 0; k < 4; k++) {
        M[c[k].p + 5 * c[k].p] += c[k].farads;
        M[c[k].n + 5 * c[k].n] += c[k].farads;
        M[c[k].p + 5 * c[k].n] -= c[k].farads;
        M[c[k].n + 5 * c[k].p] -= c[k].farads;
    }
    assert_int_equal(ns_linalg_row_split(5, M, T, &rank), NS_OK);
    assert_int_equal(rank, 4);
    for (int j = 0; j < 5; j++)
        assert_true(T[4 + 5 * j] == 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_cancels_is_zero),
        cmocka_unit_test(little_flows_in_rows_that_stay),
        cmocka_unit_test(pivots_and_single_branches_come_first),
        cmocka_unit_test(sums_are_exact_beside_rounding),
        cmocka_unit_test(rank_counts_what_entries_were_summed_from),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
