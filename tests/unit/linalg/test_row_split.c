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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_cancels_is_zero),
        cmocka_unit_test(rank_counts_what_entries_were_summed_from),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
