/* tests/unit/mlcp/test_enumerate.c - the oracle: all modes, singular ones included, and proofs that there is
 * no solution. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "trials.h"

#define INF INFINITY

static void closed_forms(void **state) {
    (void)state;
    trial_closed_forms(NS_MLCP_ENUMERATE);
}

static void no_solution(void **state) {
    (void)state;
    trial_infeasible(NS_MLCP_ENUMERATE, 1);
}

/* Of at most 10 pairs every problem must be solved; passive #189 has a solution of 3e10 beside entries of
 * 1e-14, where neither answer nor proof is certain: LIMIT. */
static void every_class(void **state) {
    (void)state;
    for (int class = 0; class < CLASSES; class ++) {
        int n = 200, solved = trial_class(NS_MLCP_ENUMERATE, class, n, 10);
        assert_true(solved == n || (class == CLASS_PASSIVE && solved == n - 1));
    }
}

/* Sources of 5 V and 6 V in parallel: rows 1 and 2 contradict, and the proof must name them, not row 0. */
static void a_proof_names_its_rows(void **state) {
    (void)state;
    trial t = {.m = 3,
               .rows = {1e-3, 1, 1, -1, 0, 0, -1, 0, 0},
               .q = {0, 5, 6},
               .l = {-INF, -INF, -INF},
               .u = {INF, INF, INF}};
    assert_int_equal(trial_run(&t, NS_MLCP_ENUMERATE), NS_E_INFEASIBLE);
    assert_true(t.info.certified);
    assert_int_equal(t.info.fault.npairs, 2);
    assert_int_equal(t.info.fault.pair[0] + t.info.fault.pair[1], 3);
}

/* a = 1e9, b = 1e100 a, c = 1e200 b = 1e309, and a pair y = d - 1 beside them: an answer, d = 1, of which no
 * double holds c.  That no mode has numbers proves nothing. */
static void what_overflows_proves_nothing(void **state) {
    (void)state;
    for (int method = 0; method < NS_MLCP_METHODS; method++) {
        trial t = {.m = 4,
                   .rows = {1, 0, 0, 0, -1e100, 1, 0, 0, 0, -1e200, 1, 0, 0, 0, 0, 1},
                   .q = {-1e9, 0, 0, -1},
                   .l = {-INF, -INF, -INF, 0},
                   .u = {INF, INF, INF, INF}};
        const int status = trial_run(&t, (ns_mlcp_method)method);
        assert_true(status != NS_OK && status != NS_E_INFEASIBLE);
        assert_true((method != NS_MLCP_AUTO && method != NS_MLCP_LEMKE) || status == NS_E_OVERFLOW);
    }
}

/* lambda = -q / w is the answer.  1e-320 has three digits and 1e-350 none, which no mode's failure is proof
 * of; 1e-310 has thirteen, which do: 5e-324 / 1e-310 = 5e-14. */
static void what_underflows_proves_nothing(void **state) {
    static const double w[] = {1e300, 1e200, 1e300}, q[] = {-1e-20, -1e-150, -1e-10};
    (void)state;
    for (int k = 0; k < 3; k++)
        for (int method = 0; method < NS_MLCP_METHODS; method++) {
            trial t = {.m = 1, .rows = {w[k]}, .q = {q[k]}, .u = {INF}};
            const int status = trial_run(&t, (ns_mlcp_method)method); /* no NAN is a residual */
            assert_true(status != NS_E_INFEASIBLE && (k == 2 || status != NS_OK));
            if (k == 2 && (method == NS_MLCP_AUTO || method == NS_MLCP_PIVOT || method == NS_MLCP_ENUMERATE))
                assert_int_equal(status, NS_OK);
            assert_true(status != NS_OK || fabs(t.lambda[0] - 1e-310) < 1e-323);
        }
}

/* y = 1e-200 lambda - 1 has the answer 1e200: v = 1e-200 would prove the contrary if v w = 1e-400 were 0. */
static void a_proof_does_not_underflow(void **state) {
    const double w = 1e-200, q = -1, l = 0, u = INF, v = 1e-200;
    const ns_mlcp p = {.m = 1, .W = &w, .q = &q, .l = &l, .u = &u};
    (void)state;
    assert_true(ns_mlcp_certify(&p, &v) == -1);
}

/* Without complementarity feasible: no ray proves it, only that every branch has a proof of its own. */
static void proved_branch_by_branch(void **state) {
    (void)state;
    trial t = {.m = 2, .rows = {0, 1, 1, 0}, .q = {-1, 1}, .l = {0, 0}, .u = {INF, INF}};
    assert_int_equal(trial_run(&t, NS_MLCP_ENUMERATE), NS_E_INFEASIBLE);
    assert_false(t.info.certified);
    assert_true(t.info.fault.npairs > 0);
}

/* Solutions in singular modes only: a + b = 1 twice over (equalities), and a - b >= 0.5 blocked by a pair
 * whose lambda nobody feels: y = a - b - 0.5 = 0 or more, any a, b of that sum. */
static void solutions_in_singular_modes(void **state) {
    (void)state;
    trial t = {.m = 3,
               .rows = {1, 1, 0, 1, 1, 0, 1, -1, 0},
               .q = {-1, -1, -0.5},
               .l = {-INF, -INF, 0},
               .u = {INF, INF, INF}};
    assert_int_equal(trial_run(&t, NS_MLCP_ENUMERATE), NS_OK);
    assert_true(fabs(t.lambda[0] + t.lambda[1] - 1) < 1e-14);
    assert_true(t.lambda[0] - t.lambda[1] >= 0.5 - 1e-14);
}

/* y = lambda - c in [0,1] each, coupled by 1e-3: of all combinations of bounds one is right: c_i = 2 and -1
 * are found at their bounds.  lambda = (1,0,1,0,...): y_i = 1 + 1e-3 (n/2 - 1) - 2 < 0 and 1e-3 n/2 + 1 > 0.
 */
static void bounds_by_columns(void **state) {
    (void)state;
    trial t = {.m = 8};
    for (int i = 0; i < t.m; i++) {
        t.q[i] = i % 2 ? 1 : -2;
        t.u[i] = 1;
        for (int j = 0; j < t.m; j++)
            t.rows[i * t.m + j] = i == j ? 1 : 1e-3;
    }
    assert_int_equal(trial_run(&t, NS_MLCP_ENUMERATE), NS_OK);
    for (int i = 0; i < t.m; i++) {
        assert_true(t.lambda[i] == (i % 2 ? 0 : 1));
        double y = i % 2 ? 1 + 1e-3 * 4 : 1 + 1e-3 * 3 - 2;
        assert_true(fabs(t.y[i] - y) < 1e-14);
    }
}

static void seventeen_pairs_are_too_many(void **state) {
    (void)state;
    trial t = {.m = 17};
    for (int i = 0; i < t.m; i++)
        t.rows[i * t.m + i] = 1;
    trial_complementary(&t);
    assert_int_equal(trial_run(&t, NS_MLCP_ENUMERATE), NS_E_SIZE);
    t.l[3] = -INF; /* an equality does not count */
    assert_int_equal(trial_run(&t, NS_MLCP_ENUMERATE), NS_OK);
}

/* Sixteen boxes have 43 million modes, too many to try: branches are cut instead.  W = I: lambda = proj(-q).
 */
static void sixteen_boxes(void **state) {
    (void)state;
    trial t = {.m = 16};
    for (int i = 0; i < t.m; i++) {
        t.l[i] = -1;
        t.u[i] = 1;
        t.q[i] = i % 3 - 1.5 * (i % 2);
        for (int j = 0; j < t.m; j++)
            t.rows[i * t.m + j] = i == j;
    }
    assert_int_equal(trial_run(&t, NS_MLCP_ENUMERATE), NS_OK);
    for (int i = 0; i < t.m; i++)
        assert_true(t.lambda[i] == fmin(fmax(-t.q[i], -1), 1));
}

/* y_2 = lambda_1 + 3 = 1.5 > 0 holds lambda_2 at -1; y_1 = 2 lambda_1 + 2 + 1 = 0 there: lambda_1 = -1.5,
 * inside
 * (-2, 1), from a branch in which it is at -2 with y_1 = 0. */
static void the_mode_is_that_of_lambda(void **state) {
    (void)state;
    trial t = {.m = 3,
               .rows = {0, 2, 0, 0, 2, -2, 0, 1, 0},
               .q = {3, 1, 3},
               .l = {-INF, -2, -1},
               .u = {INF, 1, 2},
               .mode = {NS_UPPER, NS_LOWER, NS_LOWER}};
    assert_int_equal(trial_run(&t, NS_MLCP_ENUMERATE), NS_OK);
    assert_true(t.lambda[1] == -1.5 && t.lambda[2] == -1 && t.y[1] == 0 && t.y[2] == 1.5);
    assert_int_equal(t.mode[1], NS_INSIDE);
    assert_int_equal(t.mode[2], NS_LOWER);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_forms),
        cmocka_unit_test(no_solution),
        cmocka_unit_test(every_class),
        cmocka_unit_test(a_proof_names_its_rows),
        cmocka_unit_test(what_overflows_proves_nothing),
        cmocka_unit_test(what_underflows_proves_nothing),
        cmocka_unit_test(a_proof_does_not_underflow),
        cmocka_unit_test(proved_branch_by_branch),
        cmocka_unit_test(solutions_in_singular_modes),
        cmocka_unit_test(bounds_by_columns),
        cmocka_unit_test(seventeen_pairs_are_too_many),
        cmocka_unit_test(sixteen_boxes),
        cmocka_unit_test(the_mode_is_that_of_lambda),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
