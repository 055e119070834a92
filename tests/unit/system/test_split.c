/* tests/unit/system/test_split.c - systems split into differential and algebraic rows. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "nonsmooth/system.h"
#include "wrap_alloc.h"

static ns_system *make(int n, int m, int nz, int nc) {
    ns_system *s = NULL;
    assert_int_equal(ns_system_create(n, m, nz, nc, &s), NS_OK);
    return s;
}

/* What every split must satisfy: unit rows first, T M = 0 behind them to the rounding of its sums. */
static void assert_split(const ns_system *s, const double *T, int rank) {
    int n = s->n;
    for (int i = 0; i < n; i++) {
        double largest = 0, sum_abs = 0;
        for (int j = 0; j < n; j++) {
            largest = fmax(largest, fabs(T[i + j * n]));
            sum_abs += fabs(T[i + j * n]);
        }
        assert_true(largest > 0);
        if (i < rank) {
            assert_true(largest == 1 && sum_abs == 1);
            continue;
        }
        for (int k = 0; k < n; k++) {
            double sum = 0, size = 0;
            for (int j = 0; j < n; j++) {
                sum += T[i + j * n] * s->M[j + k * n];
                size += fabs(T[i + j * n] * s->M[j + k * n]);
            }
            assert_true(fabs(sum) <= 64 * DBL_EPSILON * size);
        }
    }
}

static void capacitor(ns_system *s, int p, int n, double farads) {
    s->M[p + p * s->n] += farads;
    if (n >= 0) {
        s->M[n + n * s->n] += farads;
        s->M[p + n * s->n] -= farads;
        s->M[n + p * s->n] -= farads;
    }
}

static void split(const ns_system *s, double *T, int *rank) {
    assert_int_equal(ns_system_split(s, T, rank), NS_OK);
    assert_split(s, T, *rank);
}

static void nothing_differential(void **state) {
    ns_system *s = make(2, 0, 0, 0), *none = make(0, 0, 0, 0);
    double T[4];
    int rank = -1;
    (void)state;
    split(s, T, &rank);
    assert_true(rank == 0 && T[0] == 1 && T[1] == 0 && T[2] == 0 && T[3] == 1);
    assert_int_equal(ns_system_split(none, NULL, &rank), NS_OK);
    assert_int_equal(rank, 0);
    assert_int_equal(ns_system_split(NULL, T, &rank), NS_E_NULL);
    assert_int_equal(ns_system_split(s, NULL, &rank), NS_E_NULL);
    assert_int_equal(ns_system_split(s, T, NULL), NS_E_NULL);
    ns_system_free(s);
    ns_system_free(none);
}

/* Three capacitors in a floating ring of nodes 0, 1, 2, node 3 without any, one to ground at node 4: what
 * flows into the ring as a whole is algebraic, the sum of its three rows. */
static void floating_ring_sums_its_rows(void **state) {
    ns_system *s = make(5, 0, 0, 0);
    double T[25];
    int rank, ring_rows = 0;
    (void)state;
    capacitor(s, 0, 1, 0.1e-6);
    capacitor(s, 1, 2, 0.3e-9);
    capacitor(s, 2, 0, 0.7e-3);
    capacitor(s, 4, -1, 1e-12);
    split(s, T, &rank);
    assert_int_equal(rank, 3);
    for (int i = rank; i < 5; i++) {
        double ring = T[i] + T[i + 5] + T[i + 10];
        assert_true(T[i] == T[i + 5] && T[i] == T[i + 10] && (T[i] == 0 || T[i] == 1));
        assert_true(T[i + 15] == (ring == 0) && T[i + 20] == 0);
        ring_rows += ring == 3;
    }
    assert_int_equal(ring_rows, 1);
    ns_system_free(s);
}

/* 1e-12 F beside 1e-3 F: the small one is a state of its own, wherever it sits. */
static void small_beside_large_stays(void **state) {
    double T[9];
    int rank;
    (void)state;
    for (int where = 0; where < 3; where++) {
        ns_system *s = make(3, 0, 0, 0);
        capacitor(s, 0, 1, where == 0 ? 1e-12 : 1e-3);
        capacitor(s, 1, 2, where == 1 ? 1e-12 : 1e-3);
        capacitor(s, 2, -1, where == 2 ? 1e-12 : 1e-3);
        split(s, T, &rank);
        assert_int_equal(rank, 3);
        ns_system_free(s);
    }
}

/* Two coupled windings with K = 1: v2 = sqrt(L2/L1) v1 is algebraic.  K = 1 - 1e-9: leakage is a state. */
static void perfect_coupling_loses_a_state(void **state) {
    const double turns[] = {1, 0.1, 7.3, 1e3, 1e-4};
    double T[4];
    int rank;
    (void)state;
    for (int i = 0; i < 5; i++) {
        ns_system *s = make(2, 0, 0, 0);
        double l1 = 3.3e-3, l2 = l1 * turns[i] * turns[i], m = sqrt(l1) * sqrt(l2);
        s->M[0] = l1;
        s->M[3] = l2;
        s->M[1] = s->M[2] = m;
        split(s, T, &rank);
        assert_int_equal(rank, 1);
        /* a multiple of (turns, -1) */
        assert_true(fabs(T[1] + turns[i] * T[3]) <= 64 * DBL_EPSILON * fabs(T[1]));
        s->M[1] = s->M[2] = (1 - 1e-9) * m;
        split(s, T, &rank);
        assert_int_equal(rank, 2);
        ns_system_free(s);
    }
}

static double uniform(unsigned long *seed) {
    *seed = (*seed * 1103515245UL + 12345UL) & 0x7fffffffUL;
    return (double)*seed / 2147483648.;
}

static int root(const int *parent, int i) {
    while (parent[i] != i) {
        i = parent[i];
    }
    return i;
}

/* Random capacitors of 1 pF to 1 mF between random nodes.  With union-find beside: the rank is the nodes less
 * the floating groups, and the algebraic rows are the sums over the groups. */
static void random_capacitors(void **state) {
    enum { N = 12 };
    double T[N * N];
    unsigned long seed = 7;
    (void)state;
    for (int trial = 0; trial < 500; trial++) {
        ns_system *s = make(N, 0, 0, 0);
        int parent[N + 1], rank, floating = 0, count = (int)(20 * uniform(&seed));
        for (int i = 0; i <= N; i++) {
            parent[i] = i;
        }
        for (int k = 0; k < count; k++) {
            int a = (int)(N * uniform(&seed)), b = (int)((N + 1) * uniform(&seed));
            if (a != b) {
                capacitor(s, a, b == N ? -1 : b, pow(10, -12 + 9 * uniform(&seed)));
                if (root(parent, a) == N) { /* ground stays a root */
                    parent[root(parent, b)] = N;
                } else {
                    parent[root(parent, a)] = root(parent, b);
                }
            }
        }
        for (int i = 0; i < N; i++) {
            floating += parent[i] == i;
        }
        split(s, T, &rank);
        assert_int_equal(rank, N - floating);
        for (int i = rank; i < N; i++) {
            for (int j = 0; j < N; j++) {
                assert_true(T[i + j * N] == 0 || T[i + j * N] == 1);
            }
        }
        ns_system_free(s);
    }
}

/* Five windings that share two fluxes, L_ij = sqrt(L_i L_j) g_i g_j with unit vectors g in the plane: rank 2,
 * also where the second pivot is what little two nearly parallel windings leave over. */
static void windings_of_two_fluxes(void **state) {
    enum { N = 5 };
    double T[N * N];
    unsigned long seed = 11;
    (void)state;
    for (int trial = 0; trial < 20000; trial++) {
        ns_system *s = make(N, 0, 0, 0);
        double angle[N], root_l[N];
        int rank;
        for (int i = 0; i < N; i++) {
            angle[i] = (trial % 2 ? 0.03 : 6.3) * uniform(&seed);
            root_l[i] = pow(10, -4 * uniform(&seed));
        }
        for (int i = 0; i < N * N; i++) {
            double k = cos(angle[i / N] - angle[i % N]);
            s->M[i] = k * (root_l[i / N] * root_l[i % N]);
        }
        assert_int_equal(ns_system_split(s, T, &rank), NS_OK);
        assert_int_equal(rank, 2);
        ns_system_free(s);
    }
}

/* Rows scaled by 1e-200..1e200 in either direction change nothing about the rank. */
static void units_do_not_matter(void **state) {
    ns_system *s = make(3, 0, 0, 0);
    double T[9];
    int rank;
    (void)state;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { /* rank 2: row 2 = row 0 + row 1 in other units */
            double entry = i < 2 ? (i == j) + 0.5 : (j < 2) + 1.0;
            s->M[i + 3 * j] = entry * pow(10, -200 + 200 * i) * pow(10, 90 - 90 * j);
        }
    }
    assert_int_equal(ns_system_split(s, T, &rank), NS_OK);
    assert_int_equal(rank, 2);
    ns_system_free(s);
}

static void every_allocation_failing(void **state) {
    ns_system *s = NULL, *floating = make(2, 0, 0, 0);
    double T[4], t[] = {0, 1};
    ns_signal in = {.kind = NS_PWL};
    int rank, tried[3] = {0};
    in.u.pwl.n = 2;
    in.u.pwl.t = in.u.pwl.v = t;
    in.u.pwl.repeat = NAN;
    (void)state;
    capacitor(floating, 0, 1, 1);
    for (int what = 0; what < 3; what++) {
        for (long k = 1;; k++) {
            int status;
            long made;
            fail_alloc_at(k);
            status = what == 0   ? ns_system_create(2, 2, 2, 2, &s)
                     : what == 1 ? ns_system_set_input(s, 1, &in)
                                 : ns_system_split(floating, T, &rank);
            made = allocs_made();
            fail_alloc_off();
            if (made < k) {
                assert_int_equal(status, NS_OK);
                break;
            }
            assert_int_equal(status, NS_E_MEMORY);
            tried[what]++;
            assert_true(what > 0 || s == NULL);
        }
    }
    assert_true(tried[0] >= 14 && tried[1] >= 2 && tried[2] >= 1);
    ns_system_free(s);
    ns_system_free(floating);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_differential),     cmocka_unit_test(floating_ring_sums_its_rows),
        cmocka_unit_test(small_beside_large_stays), cmocka_unit_test(perfect_coupling_loses_a_state),
        cmocka_unit_test(random_capacitors),        cmocka_unit_test(windings_of_two_fluxes),
        cmocka_unit_test(units_do_not_matter),      cmocka_unit_test(every_allocation_failing),
    };
    return cmocka_run_group_tests_name("split", tests, NULL, NULL);
}
