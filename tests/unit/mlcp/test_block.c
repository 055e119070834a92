/* tests/unit/mlcp/test_block.c - principal pivoting by blocks: networks of more pairs than the transform
 * takes, alone and within AUTO. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "generators.h"
#include "grids.h"
#include "nonsmooth/mlcp.h"

enum { MAX = 200 };

static sample s;
static ns_mlcp_solver *solver;
static ns_mode mode[MAX];
static double lambda[MAX], y[MAX];
static ns_mlcp_info info;

static int make_room(void **state) {
    (void)state;
    return sample_create(MAX, &s) || ns_mlcp_create(MAX, &solver) != NS_OK;
}

static int free_room(void **state) {
    (void)state;
    sample_free(&s);
    ns_mlcp_free(solver);
    return 0;
}

static int solve(ns_mlcp_method method, int keep_mode) {
    const ns_mlcp p = sample_problem(&s);
    if (!keep_mode)
        memset(mode, NS_LOWER, sizeof mode);
    assert_int_equal(ns_mlcp_use(solver, method), NS_OK);
    return ns_mlcp_solve(solver, &p, mode, lambda, y, &info);
}

/* Within bounds, signs as the mode says; the residual of 1e-10 that every answer has to have. */
static void answer_fits(void) {
    const ns_mlcp p = sample_problem(&s);
    assert_true(ns_mlcp_residual(&p, lambda, NULL) < 1e-10);
    for (int i = 0; i < s.m; i++) {
        assert_true(lambda[i] >= s.l[i] && lambda[i] <= s.u[i]);
        if (mode[i] == NS_INSIDE)
            assert_true(y[i] == 0);
        else
            assert_true(mode[i] == NS_LOWER && lambda[i] == s.l[i] && y[i] >= 0);
    }
}

/* Loops of ideal diodes and closed switches make most of these singular. */
static void networks_need_no_other_method(void **state) {
    (void)state;
    for (int kind = 0; kind < GRID_KINDS; kind++)
        for (unsigned k = 0; k < 12; k++) {
            grid_make(&s, kind, 70 + 8 * (int)k, k);
            assert_int_equal(solve(NS_MLCP_PIVOT, 0), NS_OK);
            answer_fits();
            assert_int_equal(solve(NS_MLCP_AUTO, 0), NS_OK);
            assert_int_equal(info.method, NS_MLCP_PIVOT);
        }
}

/* y >= 0 and lambda >= 0 do not care in which units a row or a column is. */
static void units_do_not_matter(void **state) {
    (void)state;
    for (int kind = 0; kind < GRID_KINDS; kind++) {
        grid_make(&s, kind, 90, 3);
        sample_units(&s, 40);
        assert_int_equal(solve(NS_MLCP_PIVOT, 0), NS_OK);
        answer_fits();
    }
}

/* Drives changed by 1 part in 1e9: the mode stays, nothing is factored. */
static void the_last_mode_costs_no_factor(void **state) {
    (void)state;
    for (int kind = 0; kind < GRID_KINDS; kind++) {
        grid_make(&s, kind, 120, 5);
        assert_int_equal(solve(NS_MLCP_AUTO, 0), NS_OK);
        assert_true(info.factors > 0);
        for (int i = 0; i < s.m; i++)
            s.q[i] *= 1 + 1e-9;
        for (int again = 0; again < 2; again++) {
            assert_int_equal(solve(NS_MLCP_AUTO, 1), NS_OK);
            assert_int_equal(info.factors, 0);
            assert_int_equal(info.pivots, 0);
            answer_fits();
        }
    }
}

/* Where rounds of pivoting go in a circle Lemke's method answers before all ridges, and proofs, were tried.
 */
static void what_leads_nowhere_is_left(void **state) {
    (void)state;
    static const struct {
        int class;
        unsigned number;
    } at[] = {{CLASS_BOXES, 81}, {CLASS_BOXES, 75}, {CLASS_DEGENERATE, 119}, {CLASS_COPOSITIVE, 130}};
    for (size_t k = 0; k < sizeof at / sizeof *at; k++) {
        generate(&s, at[k].class, at[k].number, MAX);
        assert_true(s.m > 64);
        assert_int_equal(solve(NS_MLCP_AUTO, 0), NS_OK);
        assert_true(info.residual < 1e-10);
        assert_int_equal(info.method, NS_MLCP_LEMKE);
        assert_true(info.factors < 60);
    }
}

/* A node, 1 S to ground, a current I into it and n ideal diodes from it to ground:
 *     v + sum i_k = I,   y_k = -v >= 0:   v = 0, sum i_k = I, and I/n each is the shortest. */
static void make_parallel(int n, double current) {
    sample_start(&s, n + 1);
    *sample_entry(&s, 0, 0) = 1;
    for (int k = 0; k <= n; k++) {
        s.l[k] = k == 0 ? -INFINITY : 0;
        s.u[k] = INFINITY;
        s.q[k] = k == 0 ? -current : 0;
        if (k > 0) {
            *sample_entry(&s, 0, k) = 1;
            *sample_entry(&s, k, 0) = -1;
        }
    }
}

static void parallel_diodes_share_alike(void **state) {
    (void)state;
    const int n = 80;
    make_parallel(n, 2);
    assert_int_equal(solve(NS_MLCP_PIVOT, 0), NS_OK);
    for (int again = 0; again < 2; again++) {
        assert_true(fabs(lambda[0]) < 1e-14); /* eps of the currents */
        for (int k = 1; k <= n; k++)          /* eps of 2 over the first ridge, 1e-6 */
            assert_true(fabs(lambda[k] - 2.0 / n) < 1e-9);
        assert_int_equal(solve(NS_MLCP_PIVOT, 1), NS_OK);
    }
}

/* The same node with two sources at it, 1 V and 1 V + difference: no answer. */
static void contradictions_are_not_solved(void **state) {
    (void)state;
    for (int digits = 0; digits < 8; digits++) {
        const double difference = pow(10, -digits);
        make_parallel(80, 2);
        for (int k = 1; k <= 2; k++) {
            s.l[k] = -INFINITY;
            s.q[k] = 1 + (k == 2 ? difference : 0);
        }
        for (int k = 3; k < s.m; k++)
            s.q[k] = 2 + k; /* these diodes are blocked */
        assert_int_not_equal(solve(NS_MLCP_PIVOT, 0), NS_OK);
        assert_int_equal(solve(NS_MLCP_AUTO, 0), NS_E_INFEASIBLE);
        assert_true(info.certified);
    }
}

/* lambda_0 + lambda_1 = 0 and = -difference: lambda may grow, one against the other, until rounding of its
 * terms is more than the difference. */
static void large_amounts_do_not_hide_contradictions(void **state) {
    (void)state;
    for (int digits = 3; digits < 10; digits++) {
        const double difference = pow(10, -digits);
        sample_start(&s, 80);
        for (int i = 0; i < s.m; i++) {
            *sample_entry(&s, i, i) = 1;
            s.q[i] = i == 1 ? difference : i > 1 ? -1 : 0;
            s.l[i] = i < 2 ? -INFINITY : 0;
            s.u[i] = INFINITY;
        }
        *sample_entry(&s, 0, 1) = *sample_entry(&s, 1, 0) = 1;
        assert_int_not_equal(solve(NS_MLCP_PIVOT, 0), NS_OK);
    }
}

/* W = -1 on the diagonal, q = -1: y = -lambda - 1 is negative for every lambda >= 0. */
static void what_has_no_answer_gets_none(void **state) {
    (void)state;
    sample_start(&s, 100);
    for (int i = 0; i < s.m; i++) {
        *sample_entry(&s, i, i) = -1;
        s.q[i] = -1;
        s.l[i] = 0;
        s.u[i] = INFINITY;
    }
    assert_int_not_equal(solve(NS_MLCP_PIVOT, 0), NS_OK);
    assert_int_equal(solve(NS_MLCP_AUTO, 0), NS_E_INFEASIBLE);
}

/* W = tridiag(-1, 2.1, -1) + skew part, so x'Wx >= 0.1 x'x: monotone, one answer, of which q is made; a third
 * of the pairs conducts, a third blocks, a third does neither nor (both 0).  Condition below 50, 300 terms of
 * size 1. */
static void three_hundred_pairs(void **state) {
    enum { M = 300 };
    static double A[M * M], b[M], l[M], u[M], x[M], z[M];
    static ns_mode start[M];
    const ns_mlcp p = {.m = M, .W = A, .q = b, .l = l, .u = u};
    ns_mlcp_solver *large;
    (void)state;
    for (int i = 0; i < M; i++) {
        A[i + i * M] = 2.1;
        if (i > 0)
            A[i + (i - 1) * M] = A[i - 1 + i * M] = -1;
        if (i >= 7) {
            A[i + (i - 7) * M] = 0.5;
            A[i - 7 + i * M] = -0.5;
        }
        u[i] = INFINITY;
        b[i] = i % 3 == 1 ? 1 : 0;
    }
    for (int j = 0; j < M; j += 3)
        for (int i = 0; i < M; i++)
            b[i] -= A[i + j * M];
    assert_int_equal(ns_mlcp_create(M, &large), NS_OK);
    assert_int_equal(ns_mlcp_solve(large, &p, start, x, z, &info), NS_OK);
    for (int i = 0; i < M; i++)
        assert_true(fabs(x[i] - (i % 3 == 0)) <= 1e-12);
    ns_mlcp_free(large);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(networks_need_no_other_method),
        cmocka_unit_test(units_do_not_matter),
        cmocka_unit_test(the_last_mode_costs_no_factor),
        cmocka_unit_test(what_leads_nowhere_is_left),
        cmocka_unit_test(parallel_diodes_share_alike),
        cmocka_unit_test(contradictions_are_not_solved),
        cmocka_unit_test(large_amounts_do_not_hide_contradictions),
        cmocka_unit_test(what_has_no_answer_gets_none),
        cmocka_unit_test(three_hundred_pairs),
    };
    return cmocka_run_group_tests(tests, make_room, free_room);
}
