/* tests/unit/linalg/test_dense.c - LU factors and small products against sums written out. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "linalg/abs_product.h"
#include "linalg/dense.h"
#include "nonsmooth/status.h"
#include "wrap_alloc.h"

static unsigned long long seed = 1;

/* In (-1,1); xorshift. */
static double random_unit(void) {
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return 2.0 * ((double)(seed >> 11) / 9007199254740992.0) - 1.0;
}

static ns_lu *room(int n) {
    ns_lu *f;
    assert_int_equal(ns_linalg_lu_create(n, &f), NS_OK);
    return f;
}

/* Whole numbers: every product and sum is exact, so results must be equal to the last bit. */
static void products_are_the_sums_of_their_terms(void **state) {
    (void)state;
    for (int p = 0; p <= 19; p++)
        for (int q = 0; q <= 7; q++) {
            double a[19 * 7], x[7], y[20], z[20];
            for (int k = 0; k < p * q; k++)
                a[k] = floor(50.0 * random_unit());
            for (int j = 0; j < q; j++)
                x[j] = floor(50.0 * random_unit());
            for (int i = 0; i <= p; i++)
                y[i] = z[i] = 7.0 + i;
            ns_linalg_matvec(p, q, a, x, y);
            ns_linalg_matvec_add(p, q, a, x, z);
            for (int i = 0; i < p; i++) {
                double sum = 0.0;
                for (int j = 0; j < q; j++)
                    sum += a[i + j * p] * x[j];
                assert_true(y[i] == sum);
                assert_true(z[i] == 7.0 + i + sum);
            }
            assert_true(y[p] == 7.0 + p && z[p] == 7.0 + p); /* nothing behind the end is touched */
        }
}

static void what_is_no_number_is_seen(void **state) {
    (void)state;
    const double bad[] = {NAN, INFINITY, -INFINITY};
    double x[] = {1, -1.7e308, 5e-324, 0};
    assert_true(ns_linalg_finite(4, x) && ns_linalg_finite(0, NULL));
    for (int k = 0; k < 12; k++) {
        const double was = x[k % 4];
        x[k % 4] = bad[k / 4];
        assert_false(ns_linalg_finite(4, x));
        x[k % 4] = was;
    }
}

/* y1 = 2 x1 + 4 x2, y2 = 3 x1 + 6 x2 + x3 with x2 out: x2 = -x1/2 + y1/4, y2 = (3-3) x1 + 3/2 y1 + x3, where
 * the coefficient of x1 cancels exactly.  Exchanged back, the table is the first one, but for what was
 * cancelled. */
static void exchanges_solve_for_the_other_variable(void **state) {
    (void)state;
    const double before[] = {2, 3, 4, 6, 0, 1}, after[] = {-0.5, 0, 0.25, 1.5, 0, 1};
    double T[6];
    memcpy(T, before, sizeof T);
    ns_linalg_exchange(2, 3, T, 0, 1, 1e-14);
    for (int k = 0; k < 6; k++)
        assert_true(T[k] == after[k]);
    ns_linalg_exchange(2, 3, T, 0, 1, 1e-14);
    for (int k = 0; k < 6; k++)
        assert_true(T[k] == before[k]);
    T[1] = 3 + 1e-15; /* rounding of 3: what is left of it is 0, or 1e-15 */
    ns_linalg_exchange(2, 3, T, 0, 1, 1e-14);
    assert_true(T[1] == 0);
    T[0] = 2, T[1] = 3 + 1e-15, T[2] = 4, T[3] = 6;
    ns_linalg_exchange(2, 3, T, 0, 1, 0);
    assert_true(T[1] > 0);
}

/* Whole numbers again; p on both sides of where the loops change. */
static void sizes_are_the_sums_of_what_was_summed(void **state) {
    (void)state;
    enum { P = 300, Q = 5 };
    static double a[P * Q], y[P], size[P];
    const double x[Q] = {3, 0, -2, 1, -7};
    for (int p = 1; p <= P; p += 23) {
        for (int k = 0; k < p * Q; k++)
            a[k] = floor(50.0 * random_unit());
        for (int i = 0; i < p; i++)
            y[i] = size[i] = i;
        ns_linalg_abs_product_add(p, Q, p, a, x, y, size);
        for (int i = 0; i < p; i++) {
            double sum = i, terms = i;
            for (int j = 0; j < Q; j++) {
                sum += a[i + j * p] * x[j];
                terms += fabs(a[i + j * p] * x[j]);
            }
            assert_true(y[i] == sum && size[i] == terms);
        }
    }
}

/* b made from a known x; n*eps*condition: random 43*43 matrices have condition 1e4 at the most.  Up to 40
 * rows go without LAPACK. */
static void known_solutions_come_back(void **state) {
    (void)state;
    enum { N = 43 };
    ns_lu *f = room(N);
    for (int n = 0; n <= N; n++) {
        const int rhs = 1 + n % 6;
        double a[N * N], keep[N * N], x[6 * N], b[6 * N], rcond;
        for (int k = 0; k < n * n; k++)
            keep[k] = a[k] = random_unit() + (k % (n + 1) == 0 ? 3.0 : 0.0);
        for (int i = 0; i < rhs * n; i++)
            x[i] = random_unit();
        for (int k = 0; k < rhs; k++)
            ns_linalg_matvec(n, n, a, x + k * n, b + k * n);
        assert_int_equal(ns_linalg_lu_factor(f, n, a, &rcond), NS_OK);
        assert_memory_equal(a, keep, sizeof(double) * (size_t)(n * n));
        assert_true(rcond > 0.0 && rcond <= 1.0);
        ns_linalg_lu_solve(f, rhs, b);
        for (int i = 0; i < rhs * n; i++)
            assert_true(fabs(b[i] - x[i]) < 1e-11);
        for (int j = 0; j < n; j++) { /* b' = x' A */
            b[j] = 0;
            for (int i = 0; i < n; i++)
                b[j] += a[i + j * n] * x[i];
        }
        ns_linalg_lu_solve_transposed(f, 1, b);
        for (int i = 0; i < n; i++)
            assert_true(fabs(b[i] - x[i]) < 1e-11);
    }
    ns_linalg_lu_free(f);
}

/* The same matrix in other units of rows and columns: same rcond, and the solution to full precision. */
static void units_do_not_matter(void **state) {
    (void)state;
    enum { N = 3 };
    const double base[N * N] = {2, 1, 0, 1, 3, 1, 0, 1, 4}, r[N] = {1e-12, 1, 1e12}, c[N] = {1e9, 1e-12, 1};
    const double x[N] = {1, -2, 3};
    double a[N * N], b[N], plain, scaled;
    ns_lu *f = room(N);
    assert_int_equal(ns_linalg_lu_factor(f, N, base, &plain), NS_OK);
    ns_linalg_matvec(N, N, base, x, b);
    for (int j = 0; j < N; j++)
        for (int i = 0; i < N; i++)
            a[i + j * N] = base[i + j * N] * r[i] * c[j];
    for (int i = 0; i < N; i++)
        b[i] *= r[i];
    assert_int_equal(ns_linalg_lu_factor(f, N, a, &scaled), NS_OK);
    assert_true(scaled > plain / 20.0 &&
                scaled < plain * 20.0); /* powers of two leave factors up to 2 each */
    ns_linalg_lu_solve(f, 1, b);
    for (int i = 0; i < N; i++)
        assert_true(fabs(b[i] * c[i] / x[i] - 1.0) < 1e-14);
    ns_linalg_lu_free(f);
}

/* [1 e; 1 -e] has condition 1/e, but the columns are merely in different units. */
static void rcond_is_that_of_the_equilibrated_matrix(void **state) {
    (void)state;
    const double a[4] = {1, 1, 1e-20, -1e-20}, hilbertish[4] = {1, 1, 1, 1 + 1e-10};
    double rcond;
    ns_lu *f = room(2);
    assert_int_equal(ns_linalg_lu_factor(f, 2, a, &rcond), NS_OK);
    assert_true(rcond > 0.1);
    assert_int_equal(ns_linalg_lu_factor(f, 2, hilbertish, &rcond), NS_OK);
    assert_true(rcond > 1e-11 && rcond < 1e-10); /* 1/(norm 2 times norm of the inverse 2e10) */
    ns_linalg_lu_free(f);
}

/* Whether there are factors or not: the entries of a permuted diagonal in units 2^-40 to 2^50 are 1/4 to 2 in
 * it, and it is that of the factors, before and after. */
static void scaling_alone_is_that_of_the_factors(void **state) {
    (void)state;
    enum { N = 3 };
    const double a[N * N] = {0, ldexp(3, 50), 0, ldexp(-5, -40), 0, 0, 0, ldexp(1, 10), 7}, zero[N * N] = {0};
    ns_lu *f = room(N);
    assert_int_equal(ns_linalg_lu_scale(f, N, zero), NS_OK);
    assert_int_equal(ns_linalg_lu_scale(f, N, a), NS_OK);
    double rows[N], units[N];
    memcpy(rows, ns_linalg_lu_rows(f), sizeof rows);
    memcpy(units, ns_linalg_lu_units(f), sizeof units);
    const int row[N] = {1, 0, 2};
    for (int j = 0; j < N; j++) {
        const double entry = fabs(a[row[j] + N * j]) * rows[row[j]] * units[j];
        assert_true(entry >= 0.25 && entry <= 2);
    }
    assert_int_equal(ns_linalg_lu_factor(f, N, zero, NULL), NS_E_SINGULAR);
    assert_int_equal(ns_linalg_lu_factor(f, N, a, NULL), NS_OK);
    assert_memory_equal(rows, ns_linalg_lu_rows(f), sizeof rows);
    assert_memory_equal(units, ns_linalg_lu_units(f), sizeof units);
    ns_linalg_lu_free(f);
}

static void singular_matrices_are_refused(void **state) {
    (void)state;
    const double twice[9] = {1, 2, 3, 2, 4, 6, 1, 0, 1}, empty[4] = {0, 0, 1, 1}, zero[1] = {0};
    ns_lu *f = room(3);
    assert_int_equal(ns_linalg_lu_factor(f, 3, twice, NULL), NS_E_SINGULAR);
    assert_int_equal(ns_linalg_lu_factor(f, 2, empty, NULL), NS_E_SINGULAR);
    assert_int_equal(ns_linalg_lu_factor(f, 1, zero, NULL), NS_E_SINGULAR);
    ns_linalg_lu_free(f);
}

static void bad_input_is_refused(void **state) {
    (void)state;
    const double bad[4] = {1, NAN, 0, 1}, inf[4] = {1, 0, 0, -INFINITY}, good[1] = {1};
    ns_lu *f = room(2);
    assert_int_equal(ns_linalg_lu_factor(f, 2, bad, NULL), NS_E_NUMBER);
    assert_int_equal(ns_linalg_lu_factor(f, 2, inf, NULL), NS_E_NUMBER);
    assert_int_equal(ns_linalg_lu_scale(f, 2, inf), NS_E_NUMBER);
    assert_int_equal(ns_linalg_lu_factor(f, 3, bad, NULL), NS_E_SIZE);
    assert_int_equal(ns_linalg_lu_factor(f, -1, good, NULL), NS_E_SIZE);
    assert_int_equal(ns_linalg_lu_factor(f, 1, NULL, NULL), NS_E_NULL);
    assert_int_equal(ns_linalg_lu_factor(NULL, 1, good, NULL), NS_E_NULL);
    ns_linalg_lu_free(f);
    f = (ns_lu *)&seed;
    assert_int_equal(ns_linalg_lu_create(-1, &f), NS_E_SIZE);
    assert_null(f);
    assert_int_equal(ns_linalg_lu_create(2, NULL), NS_E_NULL);
    ns_linalg_lu_free(NULL);
}

static void every_allocation_may_fail(void **state) {
    (void)state;
    long k = 1;
    for (;; k++) {
        ns_lu *f = (ns_lu *)&seed;
        fail_alloc_at(k);
        int status = ns_linalg_lu_create(5, &f);
        long made = allocs_made();
        fail_alloc_off();
        if (made < k) {
            assert_int_equal(status, NS_OK);
            ns_linalg_lu_free(f);
            break;
        }
        assert_int_equal(status, NS_E_MEMORY);
        assert_null(f);
    }
    assert_true(k > 1);
}

/* Rows and columns in units 2^-60 .. 2^60: known solutions come back, each to 1e-10 of its unit (n eps times
 * the condition of 1e4), and rcond is that of the matrix without units but for the rounding of its scaling to
 * powers of two, at most a factor 4 for rows and for columns. */
/* Of a + d and a d - b c, whatever the units of the two variables are; of a thousand, and of those that have
 * to be exact. */
static void eigenvalues_of_two_are_right(void **state) {
    (void)state;
    double re[2], im[2], none[4] = {0}, fast[4] = {-1, 0, 3e7, -1}, turns[4] = {0, 4, -9, 0}, one = -5;
    for (int k = 0; k < 1000; k++) {
        const double unit = ldexp(1.0, (int)(80 * random_unit()));
        const double a = random_unit(), b = random_unit() * unit, c = random_unit() / unit, d = random_unit();
        double m[4] = {a, c, b, d};
        assert_int_equal(ns_linalg_eigenvalues(2, m, re, im), NS_OK);
        const double product = re[0] * re[1] - im[0] * im[1], norm = fabs(a) + fabs(d) + sqrt(fabs(b * c));
        assert_true(fabs(re[0] + re[1] - (a + d)) <= 1e-15 * norm);
        assert_true(fabs(product - (a * d - b * c)) <= 1e-15 * norm * norm);
        assert_true(im[0] == -im[1] && (im[0] == 0 || re[0] == re[1]));
        assert_true(im[0] == 0 || (a - d) * (a - d) + 4 * b * c < 0);
    }
    assert_int_equal(ns_linalg_eigenvalues(2, none, re, im), NS_OK);
    assert_true(re[0] == 0 && re[1] == 0 && im[0] == 0 && im[1] == 0);
    assert_int_equal(ns_linalg_eigenvalues(2, fast, re, im), NS_OK);
    assert_true(re[0] == -1 && re[1] == -1 && im[0] == 0 && im[1] == 0);
    assert_int_equal(ns_linalg_eigenvalues(2, turns, re, im), NS_OK);
    assert_true(re[0] == 0 && re[1] == 0 && im[0] == 6 && im[1] == -6);
    assert_int_equal(ns_linalg_eigenvalues(1, &one, re, im), NS_OK);
    assert_true(re[0] == -5 && im[0] == 0);
    double huge[4] = {0, -1e200, 1e200, 0}; /* its squares are none */
    assert_int_equal(ns_linalg_eigenvalues(2, huge, re, im), NS_OK);
    assert_true(fabs(fabs(im[0]) / 1e200 - 1) < 1e-14);
}

static void quick_scaling_finds_units(void **state) {
    (void)state;
    enum { N = 30 };
    ns_lu *f = room(N);
    double a[N * N], x[N], b[N], r[N], c[N], plain, rcond;
    int unit[N];
    for (int k = 0; k < N * N; k++)
        a[k] = random_unit() + (k % (N + 1) == 0 ? 3.0 : 0.0);
    assert_int_equal(ns_linalg_lu_factor(f, N, a, &plain), NS_OK);
    for (int i = 0; i < N; i++) {
        r[i] = ldexp(1.0, (int)(60 * random_unit()));
        unit[i] = (int)(60 * random_unit());
        c[i] = ldexp(1.0, unit[i]);
        x[i] = random_unit() * c[i];
    }
    for (int k = 0; k < N * N; k++)
        a[k] *= r[k % N] / c[k / N];
    ns_linalg_matvec(N, N, a, x, b);
    assert_int_equal(ns_linalg_lu_factor_quickly(f, N, a, unit, &rcond), NS_OK);
    assert_true(rcond > plain / 16 && rcond < 16 * plain);
    ns_linalg_lu_solve(f, 1, b);
    for (int i = 0; i < N; i++)
        assert_true(fabs(b[i] - x[i]) < 1e-10 * c[i]);
    for (int i = 0; i < N; i++)
        a[i + 7 * N] = a[i + 5 * N];
    const int status = ns_linalg_lu_factor_quickly(f, N, a, unit, &rcond);
    assert_true(status == NS_E_SINGULAR || rcond < 1e-15);
    memset(a, 0, sizeof a);
    assert_int_equal(ns_linalg_lu_factor_quickly(f, N, a, unit, &rcond), NS_E_SINGULAR);
    assert_int_equal(ns_linalg_lu_factor_quickly(f, N + 1, a, unit, &rcond), NS_E_SIZE);
    assert_int_equal(ns_linalg_lu_factor_quickly(NULL, N, a, unit, &rcond), NS_E_NULL);
    ns_linalg_lu_free(f);
}

/* At most four entries a column, as in matrices of circuits.  The largest is on the diagonal (whole: 1) or
 * just below it (0). */
static void fill_thinly(int n, int whole, double *a) {
    memset(a, 0, sizeof *a * (size_t)n * (size_t)n);
    for (int j = 0; j < n; j++) {
        a[whole ? j + j * n : (j + 1) % n + j * n] = 2.0 + random_unit();
        for (int k = 0; k < 3; k++)
            a[(int)floor(0.5 * n * (1.0 + random_unit())) + j * n] += random_unit();
    }
}

/* Solutions that are known, of few and of many rows, with zeros and without; x A = b too, and a matrix with
 * one column twice is singular. */
static void thin_matrices_of_all_sizes(void **state) {
    enum { MOST = 300, SIDES = 5 };
    static const int rows[] = {31, 32, 33, 64, 65, 127, 178, 255, 256, 257, MOST};
    static double a[MOST * MOST], x[MOST * SIDES], b[MOST * SIDES];
    (void)state;
    ns_lu *f = room(MOST);
    for (int s = 0; s < 3 * (int)(sizeof rows / sizeof *rows); s++) {
        const int n = rows[s / 3];
        fill_thinly(n, s % 3 > 0, a);
        for (int k = 0; k < n * n && s % 3 == 2; k++)
            a[k] += 0.1 * random_unit();
        for (int k = 0; k < SIDES * n; k++)
            x[k] = random_unit();
        for (int k = 0; k < SIDES; k++)
            ns_linalg_matvec(n, n, a, x + k * n, b + k * n);
        assert_int_equal(ns_linalg_lu_factor(f, n, a, NULL), NS_OK);
        ns_linalg_lu_solve(f, SIDES, b);
        for (int k = 0; k < SIDES * n; k++)
            assert_true(fabs(b[k] - x[k]) < 1e-8);
        for (int j = 0; j < n; j++) {
            b[j] = 0.0;
            for (int i = 0; i < n; i++)
                b[j] += x[i] * a[i + j * n];
        }
        ns_linalg_lu_solve_transposed(f, 1, b);
        for (int k = 0; k < n; k++)
            assert_true(fabs(b[k] - x[k]) < 1e-8);
        double rcond;
        memcpy(a + 5 * n, a + 7 * n, sizeof *a * (size_t)n);
        const int status = ns_linalg_lu_factor(f, n, a, &rcond);
        assert_true(status == NS_E_SINGULAR || rcond < 1e-15);
    }
    ns_linalg_lu_free(f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(thin_matrices_of_all_sizes),
        cmocka_unit_test(products_are_the_sums_of_their_terms),
        cmocka_unit_test(sizes_are_the_sums_of_what_was_summed),
        cmocka_unit_test(what_is_no_number_is_seen),
        cmocka_unit_test(exchanges_solve_for_the_other_variable),
        cmocka_unit_test(known_solutions_come_back),
        cmocka_unit_test(units_do_not_matter),
        cmocka_unit_test(quick_scaling_finds_units),
        cmocka_unit_test(eigenvalues_of_two_are_right),
        cmocka_unit_test(rcond_is_that_of_the_equilibrated_matrix),
        cmocka_unit_test(scaling_alone_is_that_of_the_factors),
        cmocka_unit_test(singular_matrices_are_refused),
        cmocka_unit_test(bad_input_is_refused),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
