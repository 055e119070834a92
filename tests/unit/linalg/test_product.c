/* tests/unit/linalg/test_product.c - small matrix-vector products: to the bit the sums of their rows in the
 * order of the columns, by wide registers and by narrow ones. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

/* NOLINTNEXTLINE(bugprone-suspicious-include) */
#include "linalg/product.c" /* both ways of it, whatever this machine would take */

enum { MOST = 70, COLUMNS = 9 };

static double next(uint64_t *dice) {
    *dice ^= *dice << 13;
    *dice ^= *dice >> 7;
    *dice ^= *dice << 17;
    return (double)(int64_t)*dice / 9e18;
}

static void plain(const factors *f, double *y) {
    for (int i = 0; i < f->p; i++) {
        volatile double sum = f->from_y ? y[i] : 0; /* rounded after every term */
        for (int j = 0; j < f->qz; j++) {
            const volatile double term = f->b[i + j * f->p] * f->z[j];
            sum = sum + term;
        }
        for (int j = 0; j < f->q; j++) {
            const volatile double term = f->a[i + j * f->p] * f->x[j];
            sum = sum + term;
        }
        y[i] = sum;
    }
}

static void all_ways_are_one(void **state) {
    (void)state;
    uint64_t dice = 88172645463325252U;
    double a[MOST * COLUMNS], x[COLUMNS], expected[MOST], got[2][MOST];
    for (int p = 0; p <= MOST; p++)
        for (int q = 0; q < COLUMNS; q++)
            for (int from_y = 0; from_y < 2; from_y++) {
                const int qz = q / 3;
                for (int k = 0; k < p * q; k++)
                    a[k] = next(&dice);
                for (int k = 0; k < q; k++)
                    x[k] = next(&dice);
                for (int k = 0; k < MOST; k++)
                    expected[k] = got[0][k] = got[1][k] = next(&dice);
                const factors f = {p, q - qz, qz, a, x, a + p * (q - qz), x + (q - qz), from_y};
                plain(&f, expected);
                narrow(&f, got[0]);
                assert_memory_equal(got[0], expected, sizeof expected); /* and nothing behind them */
                if (!ns_simd_is_wide())
                    continue;
                wide(&f, got[1]);
                assert_memory_equal(got[1], expected, sizeof expected);
            }
}

static void they_are_what_they_say(void **state) {
    (void)state;
    const double a[] = {1, 2, 3, 4, 5, 6}, x[] = {1, 10, 100}; /* rows 1 3 5 and 2 4 6 */
    double y[2] = {7, 8};
    ns_linalg_matvec_add(2, 3, a, x, y);
    assert_true(y[0] == 7 + 531 && y[1] == 8 + 642);
    ns_linalg_matvec(2, 3, a, x, y);
    assert_true(y[0] == 531 && y[1] == 642);
    ns_linalg_matvec_two(2, 2, x, 1, x + 2, a, y);
    assert_true(y[0] == 531 && y[1] == 642);
    ns_linalg_matvec(2, 0, NULL, NULL, y);
    assert_true(y[0] == 0 && y[1] == 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_ways_are_one),
        cmocka_unit_test(they_are_what_they_say),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
