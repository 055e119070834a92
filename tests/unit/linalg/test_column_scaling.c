/* tests/unit/linalg/test_column_scaling.c - units of columns, and values that rows share. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "dice.h"
#include "linalg/column_scaling.h"

enum { MOST = 40 };
static double W[MOST * MOST], unit[MOST], other[MOST], work[NS_UNITS_WORK * MOST];

/* W_ij = 2^(row_i + column_j) where |i - j| <= width, negative every third. */
static void make(dice *d, int m, int width, int *column) {
    int row[MOST];
    for (int i = 0; i < m; i++) {
        row[i] = dice_below(d, 61) - 30;
        column[i] = dice_below(d, 61) - 30;
    }
    for (int j = 0; j < m; j++)
        for (int i = 0; i < m; i++)
            W[i + j * m] =
                i - j > width || j - i > width ? 0 : ldexp((i + j) % 3 ? 1 : -1, row[i] + column[j]);
}

/* Where one unit a column makes all entries of every row equal, that is what is found, but for a common
 * factor: sparse, and with more entries than the list of them holds. */
static void units_make_entries_alike(void **state) {
    static const int sizes[][2] = {{1, 0}, {5, 1}, {5, 4}, {MOST, 1}, {MOST, 7}, {MOST, 8}, {MOST, MOST}};
    (void)state;
    for (unsigned k = 0; k < sizeof sizes / sizeof *sizes; k++)
        for (unsigned n = 0; n < 20; n++) {
            const int m = sizes[k][0];
            int column[MOST];
            dice d = dice_make(91, 100 * k + n);
            make(&d, m, sizes[k][1], column);
            ns_linalg_column_scaling(m, W, unit, work);
            for (int j = 0; j < m; j++)
                assert_true(unit[j] * ldexp(1, column[j]) == unit[0] * ldexp(1, column[0]));
        }
}

/* Of any entries: a column in another unit gets the inverse factor, rows change nothing; to a power of two.
 */
static void units_follow_the_columns(void **state) {
    (void)state;
    for (unsigned n = 0; n < 50; n++) {
        const int m = n % 2 ? 12 : MOST;
        int shift[MOST];
        dice d = dice_make(92, n);
        for (int k = 0; k < m * m; k++)
            W[k] = dice_chance(&d, 0.8) ? dice_either(&d) : 0;
        ns_linalg_column_scaling(m, W, unit, work);
        for (int j = 0; j < m; j++)
            shift[j] = dice_below(&d, 41) - 20;
        for (int j = 0; j < m; j++)
            for (int i = 0; i < m; i++)
                W[i + j * m] = ldexp(W[i + j * m], shift[j] + 2 * shift[m - 1 - i]);
        ns_linalg_column_scaling(m, W, other, work);
        for (int j = 0; j < m; j++) {
            const double factor = ldexp(other[j], shift[j]) / unit[j] / (ldexp(other[0], shift[0]) / unit[0]);
            assert_true(factor >= 0.25 && factor <= 4);
        }
    }
}

/* 1 on the diagonal, 1e-20 elsewhere: the mean of a column would make its own entry 1e19 units. */
static void no_entry_is_far_above_the_others(void **state) {
    const int m = 8;
    (void)state;
    for (int j = 0; j < m; j++)
        for (int i = 0; i < m; i++)
            W[i + j * m] = i == j ? 1 : 1e-20;
    W[0] = 1024;
    ns_linalg_column_scaling(m, W, unit, work);
    for (int j = 1; j < m; j++)
        assert_true(unit[j] <= 2 * unit[1] && unit[j] >= unit[1] / 2);
    assert_true(unit[0] < unit[1]);
}

/* Rows 0, 1 and 3 are joined by columns 1 and 3, row 2 by none. */
static void joined_rows_share_the_largest(void **state) {
    const double joined[16] = {1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 1};
    double value[] = {3, 1, 2, 7}, parent[4];
    (void)state;
    ns_linalg_spread(4, joined, value, parent);
    assert_true(value[0] == 7 && value[1] == 7 && value[2] == 2 && value[3] == 7);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(units_make_entries_alike), cmocka_unit_test(units_follow_the_columns),
        cmocka_unit_test(no_entry_is_far_above_the_others), cmocka_unit_test(joined_rows_share_the_largest)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
