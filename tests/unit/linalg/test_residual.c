/* tests/unit/linalg/test_residual.c - what an equation leaves over, against sums that are known exactly. */
#include <float.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "linalg/residual.h"

/* 1 - (1 + e)(1 - e) = e^2, e = 2^-40: 2^-80 is below the rounding of the product, in long double too. */
static void digits_of_products_stay(void **state) {
    const double e = 0x1p-40, row[] = {1 + e, 1}, x[] = {1 - e, -1};
    const int list[] = {0, 1};
    (void)state;
    assert_true(ns_linalg_residual(0, 2, list, row, 1, x) == e * e);
}

/* b + 2^80 + 1 - 2^80 = b + 1 */
static void digits_of_sums_stay(void **state) {
    const double big = 0x1p80, row[] = {-big, -1, big}, x[] = {1, 1, 1};
    const int list[] = {0, 1, 2};
    (void)state;
    assert_true(ns_linalg_residual(0.25, 3, list, row, 1, x) == 1.25);
}

/* Row 1 of a 2*3 matrix, column by column, of which the middle entry is not in the list. */
static void only_what_is_listed_counts(void **state) {
    const double a[] = {9, 2, 9, 1e300, 9, 5}, x[] = {3, 1e300, 4};
    const int list[] = {0, 2};
    (void)state;
    assert_true(ns_linalg_residual(1, 2, list, a + 1, 2, x) == 1 - 6 - 20);
    assert_true(ns_linalg_residual(1, 0, list, a + 1, 2, x) == 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(digits_of_products_stay),
                                       cmocka_unit_test(digits_of_sums_stay),
                                       cmocka_unit_test(only_what_is_listed_counts)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
