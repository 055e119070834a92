/* tests/unit/linalg/test_equilibrate.c - powers of two that bring the entries of a matrix close to 1. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "dice.h"
#include "linalg/equilibrate.h"

enum { MOST = 9, LD = 11 };

static double a[MOST * LD];
static int r[MOST], c[MOST];
static short work[MOST * MOST];

static double scaled(int i, int j) {
    return ldexp(a[i + j * LD], r[i] + c[j]);
}

/* Entries of 1 to 2, but for units of rows and columns over 80 decades: all come out between 1/8 and 1, but
 * for the halves that middles of exponents round to. */
static void units_come_off(void **state) {
    (void)state;
    for (int run = 0; run < 200; run++) {
        dice d = dice_make(41, (unsigned)run);
        int row[MOST], column[MOST];
        const int n = 2 + dice_below(&d, MOST - 1);
        for (int i = 0; i < n; i++) {
            row[i] = dice_below(&d, 281) - 140;
            column[i] = dice_below(&d, 281) - 140;
        }
        for (int j = 0; j < n; j++)
            for (int i = 0; i < n; i++)
                a[i + j * LD] = ldexp(1 + dice_uniform(&d), row[i] + column[j]);
        ns_linalg_equilibrate(n, a, LD, r, c, work);
        for (int j = 0; j < n; j++)
            for (int i = 0; i < n; i++)
                assert_true(scaled(i, j) >= 1.0 / 8 && scaled(i, j) <= 1);
    }
}

/* Any pattern and any entries: none is above 1, and no row and no column that is not zero is below 1/2; of
 * entries within 12 binary digits, below 2^-13. */
static void each_line_has_a_largest_of_one(void **state) {
    (void)state;
    for (int run = 0; run < 500; run++) {
        dice d = dice_make(42, (unsigned)run);
        const int n = 1 + dice_below(&d, MOST), dense = 1 + dice_below(&d, 4);
        double rows[MOST] = {0}, columns[MOST] = {0};
        double least = INFINITY, most = 0;
        for (int j = 0; j < n; j++)
            for (int i = 0; i < n; i++) {
                a[i + j * LD] = dice_below(&d, dense) ? 0 : ldexp(dice_either(&d), dice_below(&d, 161) - 80);
                most = fmax(most, fabs(a[i + j * LD]));
                least = a[i + j * LD] != 0 ? fmin(least, fabs(a[i + j * LD])) : least;
            }
        ns_linalg_equilibrate(n, a, LD, r, c, work);
        for (int j = 0; j < n; j++)
            for (int i = 0; i < n; i++) {
                rows[i] = fmax(rows[i], fabs(scaled(i, j)));
                columns[j] = fmax(columns[j], fabs(scaled(i, j)));
                assert_true(fabs(scaled(i, j)) <= 1);
            }
        const double enough = most <= ldexp(least, 13) ? ldexp(1, -13) : 0.5;
        for (int j = 0; j < n; j++)
            assert_true((columns[j] == 0 || columns[j] >= enough) && (rows[j] == 0 || rows[j] >= enough));
    }
}

/* What is close already gets one factor: the largest comes below 1, nothing else moves. */
static void close_entries_keep_their_ratios(void **state) {
    (void)state;
    const double given[] = {1, 0, 3000, 5};
    for (int k = 0; k < 4; k++)
        a[k % 2 + k / 2 * LD] = given[k];
    ns_linalg_equilibrate(2, a, LD, r, c, work);
    for (int i = 0; i < 2; i++)
        assert_true(r[i] == -12 && c[i] == 0); /* 3000 is below 2^12 */
    a[0] = a[1] = a[LD] = a[1 + LD] = 0;
    ns_linalg_equilibrate(2, a, LD, r, c, work);
    for (int i = 0; i < 2; i++)
        assert_true(r[i] == 0 && c[i] == 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(units_come_off),
        cmocka_unit_test(each_line_has_a_largest_of_one),
        cmocka_unit_test(close_entries_keep_their_ratios),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
