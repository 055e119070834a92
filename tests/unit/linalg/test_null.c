/* tests/unit/linalg/test_null.c - what a singular matrix leaves open. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "dice.h"
#include "linalg/null.h"
#include "nonsmooth/status.h"

enum { MOST = 6 };

/* Weights of a (n*n, row by row), also in other units: a_ij / (rows_i units_j) with these rows and units. */
static void has_weights(int n, const double *a, const double *expected) {
    for (int run = 0; run < 20; run++) {
        dice d = dice_make(31, (unsigned)run);
        double rows[MOST], units[MOST], scaled[MOST * MOST], weight[MOST];
        for (int i = 0; i < n; i++) {
            rows[i] = run ? ldexp(1, dice_below(&d, 81) - 40) : 1;
            units[i] = run ? ldexp(1, dice_below(&d, 81) - 40) : 1;
        }
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                scaled[i + j * n] = a[i * n + j] / (rows[i] * units[j]);
        assert_int_equal(ns_linalg_null_weights(n, scaled, rows, units, weight), NS_OK);
        for (int j = 0; j < n; j++)
            assert_true(fabs(weight[j] - expected[j]) < 1e-12);
    }
}

/* Two columns that are one: (1, -1, 0) / sqrt 2 is left open. */
static void equal_columns(void **state) {
    (void)state;
    const double a[] = {1, 1, 0.5, 1, 1, 0.25, 0.5, 0.5, 1}, half = sqrt(0.5);
    has_weights(3, a, (const double[]){half, half, 0});
}

/* All entries 1: what is left open is all but the mean: the projector I - 1/n, its diagonal 1 - 1/n. */
static void rank_one(void **state) {
    (void)state;
    double a[MOST * MOST], expected[MOST];
    for (int n = 1; n <= MOST; n++) {
        for (int k = 0; k < n * n; k++)
            a[k] = 1;
        for (int j = 0; j < n; j++)
            expected[j] = sqrt(1 - 1.0 / n);
        has_weights(n, a, expected);
    }
}

/* An unknown that no equation has is left open; a triangle with ones leaves nothing. */
static void a_zero_column_and_none(void **state) {
    (void)state;
    has_weights(3, (const double[]){1, 0, 0.5, 0, 0, 1, 0, 0, 0}, (const double[]){0, 1, 0});
    has_weights(3, (const double[]){1, 0.5, 0.5, 0, 1, 1, 0, 0, 1}, (const double[]){0, 0, 0});
    double none;
    assert_int_equal(ns_linalg_null_weights(0, NULL, NULL, NULL, &none), NS_OK);
}

/* Singular but for 1e-13 of its entries counts as singular, but for 1e-10 not. */
static void rounding_is_no_equation(void **state) {
    (void)state;
    const double half = sqrt(0.5);
    has_weights(2, (const double[]){1, 1, 1, 1 + 1e-13}, (const double[]){half, half});
    has_weights(2, (const double[]){1, 1, 1, 1 + 1e-10}, (const double[]){0, 0});
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_columns),
        cmocka_unit_test(rank_one),
        cmocka_unit_test(a_zero_column_and_none),
        cmocka_unit_test(rounding_is_no_equation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
