/* tests/unit/theta/test_guard_rounding.c - by how much guards and slopes of a map may be off: against the
 * same equations solved in long double.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <float.h>

#include "formula.h"
#include "theta/regularise.h"
#include "theta/theta_internal.h"

enum { N = FORMULA_N, P = FORMULA_P, MOST = N + P };

static ns_theta *stepper(const ns_system *s, double theta) {
    const ns_theta_options o = {theta, theta, 0};
    ns_theta *t;
    const double w0[N] = {0};
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
    assert_int_equal(ns_theta_start(t, w0, NULL), NS_OK);
    return t;
}

/* b = a^-1 b by elimination with the largest pivots. */
static void solve_long(int n, long double a[MOST][MOST], long double *b) {
    for (int k = 0; k < n; k++) {
        int best = k;
        for (int i = k; i < n; i++)
            best = fabsl(a[i][k]) > fabsl(a[best][k]) ? i : best;
        for (int j = 0; j < n; j++) {
            const long double was = a[k][j];
            a[k][j] = a[best][j];
            a[best][j] = was;
        }
        const long double was = b[k];
        b[k] = b[best];
        b[best] = was;
        for (int i = k + 1; i < n; i++) {
            const long double by = a[i][k] / a[k][k];
            for (int j = k; j < n; j++)
                a[i][j] -= by * a[k][j];
            b[i] -= by * b[k];
        }
    }
    for (int k = n - 1; k >= 0; k--) {
        for (int j = k + 1; j < n; j++)
            b[k] -= a[k][j] * b[j];
        b[k] /= a[k][k];
    }
}

/* Column k of the map (one of eta): x, lambda_J in long double. */
static int solve_column(ns_theta *t, double h, const ns_mode *mode, int k, long double *x) {
    long double a[MOST][MOST] = {{0}};
    const int nj = ns_theta_map_matrix(t, h, 1, mode), size = N + nj;
    for (int i = 0; i < size; i++) {
        x[i] = i == k;
        for (int j = 0; j < size; j++)
            a[i][j] = t->K[i + j * size];
    }
    solve_long(size, a, x);
    return nj;
}

/* A circuit's numbers: unknowns and rows in units from 1e-6 to 1e6. */
static void change_units(ns_system *s, dice *d) {
    double row[N], unit[N];
    for (int i = 0; i < N; i++) {
        row[i] = pow(10, 6 * dice_either(d));
        unit[i] = pow(10, 6 * dice_either(d));
    }
    double *M, *A, *B, *C; /* the system is this test's own */
    memcpy(&M, &s->M, sizeof M);
    memcpy(&A, &s->A, sizeof A);
    memcpy(&B, &s->B, sizeof B);
    memcpy(&C, &s->C, sizeof C);
    for (int j = 0; j < N; j++)
        for (int i = 0; i < N; i++) {
            M[i + j * N] *= row[i] * unit[j];
            A[i + j * N] *= row[i] * unit[j];
        }
    for (int j = 0; j < P; j++)
        for (int i = 0; i < N; i++) {
            B[i + j * N] *= row[i];
            C[j + i * P] *= unit[i];
        }
}

/* Guards by eta, of pairs at their lower bound (y) and inside (lambda): what double arithmetic has lost is no
 * more than the rounding says, and that is no excuse for everything: some units of eps of the terms. */
static void what_is_lost_is_covered(void **state) {
    (void)state;
    for (int run = 0; run < 200; run++) {
        dice d = dice_make(11, (unsigned)run);
        ns_system *s = formula_system(&d);
        change_units(s, &d);
        ns_theta *t = stepper(s, 1);
        ns_mode mode[P];
        ns_map *map;
        for (int j = 0; j < P; j++)
            mode[j] = dice_below(&d, 2) ? NS_INSIDE : NS_LOWER;
        assert_int_equal(ns_theta_map_build(t, 0.1, 1, mode, 0, &map), NS_OK);
        for (int k = 0; k < t->r; k++) {
            long double x[MOST] = {0};
            const int nj = solve_column(t, 0.1, mode, k, x);
            int g = 0;
            for (int j = 0, in = 0; j < P; j++) {
                long double guard = 0, terms = 0;
                for (int i = 0; i < N + nj && mode[j] != NS_INSIDE; i++) {
                    const double c = i < N ? s->C[j + i * P] : s->D[j + t->inside[i - N] * P];
                    guard += c * x[i];
                    terms += fabsl(c * x[i]);
                }
                if (mode[j] == NS_INSIDE) {
                    guard = x[N + in++];
                    terms = fabsl(guard);
                }
                for (int n = ns_theta_guards_of(t, mode, j); n > 0; n--, g++) {
                    const double got = map->step[(map->guard + g) + k * map->p];
                    const double rounding = map->rounding[g + k * map->guards];
                    const double lost = (double)fminl(fabsl(got - guard), fabsl(got + guard));
                    assert_true(lost <= 4 * DBL_EPSILON * rounding);
                    assert_true(rounding >= (double)terms * (1 - 1e-9) && rounding <= 1e3 * (double)terms);
                }
            }
        }
        ns_theta_map_free(map);
        ns_theta_free(t);
        ns_system_free(s);
    }
}

/* What d may be off by: that of each input times its size, and d is covered likewise. */
static void slopes_sum_up_their_inputs(void **state) {
    (void)state;
    for (int run = 0; run < 20; run++) {
        dice d = dice_make(13, (unsigned)run);
        ns_system *s = formula_system(&d);
        ns_theta *t = stepper(s, 0.5);
        double w0[N], z[FORMULA_Z] = {0.5, -2}, rounding[N];
        for (int i = 0; i < N; i++)
            w0[i] = 3 * dice_either(&d);
        assert_int_equal(ns_theta_start(t, w0, NULL), NS_OK);
        assert_int_equal(ns_theta_try(t, 0.1, z, 1, NS_RESOLVE), NS_OK);
        ns_theta_rate_rounding(t, t->trial.map, rounding);
        for (int i = 0; i < t->r; i++) {
            double sum = 0;
            for (int k = 0; k < t->q; k++) {
                const double input = k < t->r ? t->past.w[k] : k < t->q - 1 ? z[k - t->r] : 1;
                const double by = t->trial.map->d_rounding[i + k * t->r];
                const double entry = t->trial.map->step[(t->r + i) + k * t->trial.map->p];
                assert_true(k >= t->r || by >= fabs(entry) * (1 - 1e-12));
                sum += by * fabs(input);
            }
            assert_true(fabs(rounding[i] - sum) <= 1e-14 * sum);
        }
        ns_theta_free(t);
        ns_system_free(s);
    }
}

/* A map's guards at some input are the distances of its own lambda and y from what the mode allows. */
static void guards_are_distances(void **state) {
    (void)state;
    static const double bounds[][2] = {
        {0, INFINITY}, {-INFINITY, 1}, {-1, 2}, {0.5, 0.5}, {-INFINITY, INFINITY}};
    int seen = 0;
    for (int run = 0; run < 300; run++) {
        dice d = dice_make(14, (unsigned)run);
        ns_system *s = formula_system(&d);
        ns_mode mode[P];
        for (int j = 0; j < P; j++) {
            const double *b = bounds[dice_below(&d, 5)];
            s->l[j] = b[0];
            s->u[j] = b[1];
            s->e[j] = dice_either(&d);
            mode[j] = isinf(b[0]) ? NS_UPPER : NS_LOWER;
            if (b[0] < b[1] && (dice_below(&d, 2) || (isinf(b[0]) && isinf(b[1]))))
                mode[j] = NS_INSIDE;
            else if (isfinite(b[0]) && isfinite(b[1]) && dice_below(&d, 2))
                mode[j] = NS_UPPER;
        }
        ns_theta *t = stepper(s, 1);
        ns_map *map;
        double in[N + FORMULA_Z + 1], v[N + P] = {0};
        assert_int_equal(ns_theta_map_build(t, 0.1, 1, mode, 0, &map), NS_OK);
        for (int k = 0; k < t->q; k++)
            in[k] = k == t->q - 1 ? 1 : dice_either(&d);
        for (int k = 0; k < t->q; k++)
            for (int i = 0; i < N + P; i++)
                v[i] += map->full[i + k * (N + P)] * in[k];
        for (int j = 0, g = 0; j < P; j++) {
            double y = s->e[j], expected[2];
            int count = 0;
            for (int i = 0; i < N + P; i++)
                y += (i < N ? s->C[j + i * P] : s->D[j + (i - N) * P]) * v[i];
            for (int k = 0; k < FORMULA_Z; k++)
                y += s->F[j + k * P] * in[t->r + k];
            if (mode[j] == NS_INSIDE && isfinite(s->l[j]))
                expected[count++] = v[N + j] - s->l[j];
            if (mode[j] == NS_INSIDE && isfinite(s->u[j]))
                expected[count++] = s->u[j] - v[N + j];
            if (mode[j] == NS_INSIDE)
                assert_true(fabs(y) < 1e-12); /* terms of about 1 */
            else
                assert_true(v[N + j] == (mode[j] == NS_LOWER ? s->l[j] : s->u[j]));
            if (mode[j] != NS_INSIDE && s->l[j] < s->u[j])
                expected[count++] = mode[j] == NS_LOWER ? y : -y;
            assert_int_equal(ns_theta_guards_of(t, mode, j), count);
            for (int k = 0; k < count; k++, g++, seen++) {
                double got = 0;
                for (int c = 0; c < t->q; c++)
                    got += map->step[(map->guard + g) + c * map->p] * in[c];
                assert_true(fabs(got - expected[k]) < 1e-12);
            }
            assert_true(j < P - 1 || g == ns_theta_guard_count(t, mode));
        }
        ns_theta_map_free(map);
        ns_theta_free(t);
        ns_system_free(s);
    }
    assert_true(seen > 600);
}

/* In the units of the factors it adds just that fraction. */
static void leaks_in_series_are_fractions(void **state) {
    (void)state;
    dice d = dice_make(15, 0);
    ns_system *s = formula_system(&d);
    ns_theta *t = stepper(s, 1);
    const double K[4] = {1e6, 0, 0, 1e-3};
    assert_int_equal(ns_linalg_lu_factor(t->lu, 2, K, NULL), NS_OK);
    for (int i = 0; i < 2; i++) {
        const double scale = ns_linalg_lu_rows(t->lu)[i] * ns_linalg_lu_units(t->lu)[i];
        assert_true(fabs(K[3 * i] * scale - 1) <= 0.75); /* powers of two */
        assert_true(fabs(ns_theta_leak_series(t, i, 1e-10) * scale - 1e-10) < 1e-24);
    }
    ns_theta_free(t);
    ns_system_free(s);
}

/* The mode that a pair has after guard g broke, all others hold; lambda >= 0, lambda <= 0, -1 <= lambda <= 1.
 */
static void expect_flip(ns_theta *t, const ns_map *map, const ns_mode *mode, int g, int pair, ns_mode to) {
    ns_mode now[3];
    memcpy(now, mode, sizeof now);
    for (int k = 0; k < map->guards; k++)
        t->trial.out[map->guard + k] = k == g ? -1 : 1;
    assert_int_equal(ns_theta_guards_hold(t, map, 1), g < 0);
    assert_int_equal(ns_theta_guards_flip(t, map, 1, now), g >= 0);
    for (int j = 0; j < 3; j++)
        assert_int_equal(now[j], j == pair ? to : mode[j]);
}

static void a_broken_guard_changes_its_pair(void **state) {
    static const double l[] = {0, -INFINITY, -1}, u[] = {INFINITY, 0, 1};
    static const ns_mode inside[] = {NS_INSIDE, NS_INSIDE, NS_INSIDE},
                         bound[] = {NS_LOWER, NS_UPPER, NS_LOWER};
    ns_system *s;
    (void)state;
    assert_int_equal(ns_system_create(1, 3, 0, 0, &s), NS_OK);
    s->M[0] = 1;
    for (int j = 0; j < 3; j++) {
        s->D[4 * j] = 1;
        s->l[j] = l[j];
        s->u[j] = u[j];
    }
    const ns_theta_options o = {1, 1, 0};
    const double w0 = 0;
    ns_theta *t;
    ns_map *map;
    assert_int_equal(ns_theta_create(s, &o, &t, NULL), NS_OK);
    assert_int_equal(ns_theta_start(t, &w0, NULL), NS_OK);
    memset(t->trial.in, 0, sizeof *t->trial.in * (size_t)t->q);
    assert_int_equal(ns_theta_map_build(t, 0.1, 1, inside, 0, &map), NS_OK);
    assert_int_equal(map->guards, 4);
    expect_flip(t, map, inside, -1, -1, 0);
    expect_flip(t, map, inside, 0, 0, NS_LOWER);
    expect_flip(t, map, inside, 1, 1, NS_UPPER);
    expect_flip(t, map, inside, 2, 2, NS_LOWER);
    expect_flip(t, map, inside, 3, 2, NS_UPPER);
    ns_theta_map_free(map);
    assert_int_equal(ns_theta_map_build(t, 0.1, 1, bound, 0, &map), NS_OK);
    assert_int_equal(map->guards, 3);
    for (int j = 0; j < 3; j++)
        expect_flip(t, map, bound, j, j, NS_INSIDE);
    ns_theta_map_free(map);
    ns_theta_free(t);
    ns_system_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_broken_guard_changes_its_pair), cmocka_unit_test(what_is_lost_is_covered),
        cmocka_unit_test(slopes_sum_up_their_inputs),      cmocka_unit_test(guards_are_distances),
        cmocka_unit_test(leaks_in_series_are_fractions),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
