/* tests/unit/mlcp/test_textbook.c - problems made to be slow or endless for a method, solved by each method.
 *
 * Murty 1978 ("Computational complexity of complementary pivot methods"), Fathi 1979 ("Computational
 * complexity of LCPs associated with positive definite symmetric matrices"): 2^n steps of principal pivoting
 * by least index and of Lemke's method from the cover e.  Kostreva 1979 ("Cycling in linear complementarity
 * problems"), Beale 1955 ("Cycling in the dual simplex algorithm"): without a rule for ties they never end.
 * A method alone may give up, within its bounds, about twice of what each is seen to take here (it is
 * printed): Lemke's method leaves a cover whose path is long, pivoting by blocks leaves such problems to it.
 * AUTO may not.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "trials.h"

/* What a method may take, whether it answers or not.  Paths are 2^20 and 2^100 long here. */
static const struct {
    long pivots, factors; /* pivots: a pair */
} most[NS_MLCP_METHODS] = {
    [NS_MLCP_AUTO] = {200, 300},
    [NS_MLCP_PIVOT] = {10, 100},
    [NS_MLCP_LEMKE] = {200, 300},
    [NS_MLCP_ENUMERATE] = {0, 4096}, /* 2^12 */
};

typedef void maker(trial *t);
typedef void judge(const trial *t);

/* Upper triangular, 2 above 1, q = -1: the last row says lambda_n = 1, then y_i = 2 - 1 = 1. */
static void murty(trial *t) {
    for (int i = 0; i < t->m; i++) {
        t->q[i] = -1;
        for (int j = i; j < t->m; j++)
            t->rows[i * t->m + j] = i == j ? 1 : 2;
    }
}

/* Murty's own: lower triangular, q_i = -(2^n + ... + 2^(n-i)): lambda_1 = 2^n, then y_i = 2 2^n + q_i > 0. */
static void murty_lower(trial *t) {
    double sum = 0;
    for (int i = 0; i < t->m; i++) {
        t->q[i] = -(sum += ldexp(1, t->m - i));
        for (int j = 0; j <= i; j++)
            t->rows[i * t->m + j] = i == j ? 1 : 2;
    }
}

/* L L' of the lower triangle above, positive definite, q = -1: 1 5 9 .. on the diagonal, 4 min(i,j) - 2 off
 * it (from 1).  lambda_1 = 1, y_i = 2 - 1. */
static void fathi(trial *t) {
    for (int i = 0; i < t->m; i++) {
        t->q[i] = -1;
        for (int j = 0; j < t->m; j++)
            t->rows[i * t->m + j] = i == j ? 4 * i + 1 : 4 * (i < j ? i : j) + 2;
    }
}

/* P-matrix, three ratios tie: by symmetry lambda = 1/3 each, l + 2 l = 1. */
static void kostreva(trial *t) {
    for (int i = 0; i < t->m; i++) {
        t->q[i] = -1;
        t->rows[i * t->m + i] = 1;
        t->rows[i * t->m + (i + 1) % t->m] = 2;
    }
}

/* ... turned round: the one on which principal pivoting (Bard's rule) cycles. */
static void kostreva_turned(trial *t) {
    for (int i = 0; i < t->m; i++) {
        t->q[i] = -1;
        t->rows[i * t->m + i] = 1;
        t->rows[(i + 1) % t->m * t->m + i] = 2;
    }
}

/* Beale's linear program as [0 -A'; A 0]: min -3/4 x4 + 20 x5 - 1/2 x6 + 6 x7, optimum x4 = x6 = 1. */
static const double cost[4] = {-0.75, 20, -0.5, 6};
static void beale(trial *t) {
    const double A[3][4] = {{0.25, -8, -1, 9}, {0.5, -12, -0.5, 3}, {0, 0, 1, 0}}, b[3] = {0, 0, 1};
    for (int j = 0; j < 4; j++) {
        t->q[j] = cost[j];
        for (int i = 0; i < 3; i++) {
            t->rows[j * 7 + 4 + i] = A[i][j];
            t->rows[(4 + i) * 7 + j] = -A[i][j];
        }
    }
    for (int i = 0; i < 3; i++)
        t->q[4 + i] = b[i];
}

/* y_i = sum of all lambda - n: every ratio ties. */
static void all_tie(trial *t) {
    for (int i = 0; i < t->m; i++) {
        t->q[i] = -t->m;
        for (int j = 0; j < t->m; j++)
            t->rows[i * t->m + j] = 1;
    }
}

/* q = 0: degenerate at the start, and nothing to do. */
static void all_zero(trial *t) {
    all_tie(t);
    memset(t->q, 0, sizeof t->q);
}

/* Within 1e-8: what the residual of an iterative method, 1e-10, leaves. */
static void near(double got, double expected, double size) {
    if (!(fabs(got - expected) <= 1e-8 * size))
        fail_msg("%.17g is not %.17g", got, expected);
}

static void only_first(const trial *t) {
    for (int i = 0; i < t->m; i++)
        near(t->lambda[i], i == 0 ? -t->q[0] : 0, fabs(t->q[0]));
}

static void only_last(const trial *t) {
    for (int i = 0; i < t->m; i++)
        near(t->lambda[i], i == t->m - 1, 1);
}

static void thirds(const trial *t) {
    for (int i = 0; i < t->m; i++)
        near(t->lambda[i], 1.0 / 3, 1);
}

static void optimum(const trial *t) {
    double value = 0;
    for (int j = 0; j < 4; j++)
        value += cost[j] * t->lambda[j];
    near(value, -1.25, 1);
    near(t->lambda[0], 1, 1);
    near(t->lambda[2], 1, 1);
}

static void sum(const trial *t) {
    double all = 0;
    for (int i = 0; i < t->m; i++)
        all += t->lambda[i];
    near(all, -t->q[0], t->m);
}

static const struct {
    const char *name;
    int m;
    maker *make;
    judge *is_right;
} problem[] = {
    {"Murty, upper", 8, murty, only_last},
    {"Murty, upper", 20, murty, only_last},
    {"Murty, upper", 100, murty, only_last},
    {"Murty, lower", 8, murty_lower, only_first},
    {"Murty, lower", 20, murty_lower, only_first},
    {"Murty, lower", 100, murty_lower, only_first},
    {"Fathi", 8, fathi, only_first},
    {"Fathi", 20, fathi, only_first},
    {"Fathi", 100, fathi, only_first},
    {"Kostreva", 3, kostreva, thirds},
    {"Kostreva, turned", 3, kostreva_turned, thirds},
    {"Beale", 7, beale, optimum},
    {"all tie", 12, all_tie, sum},
    {"all tie", 100, all_tie, sum},
    {"all zero", 12, all_zero, sum},
};
enum { PROBLEMS = sizeof problem / sizeof *problem };

static void prepare(int k, trial *t) {
    *t = (trial){.m = problem[k].m};
    problem[k].make(t);
    trial_complementary(t);
}

/* From all lambda at 0 or all inside.  All of them have a solution: nothing may be called unsolvable. */
static int run(int k, ns_mlcp_method method, ns_mode start, trial *t) {
    prepare(k, t);
    memset(t->mode, start, sizeof t->mode);
    const int status = trial_run(t, method);
    print_message("%-17s %3d  %-10s %-7s %-10s %5ld pivots %3ld factors\n", problem[k].name, t->m,
                  ns_mlcp_method_name((int)method), start == NS_LOWER ? "lower" : "inside",
                  ns_status_name(status), t->info.pivots, t->info.factors);
    assert_int_not_equal(status, NS_E_INFEASIBLE);
    assert_true(t->info.pivots <= most[method].pivots * t->m);
    assert_true(t->info.factors <= most[method].factors);
    if (status == NS_OK)
        problem[k].is_right(t);
    return status;
}

static void each_is_solved_in_few_steps(void **state) {
    (void)state;
    for (int k = 0; k < PROBLEMS; k++)
        for (int start = NS_LOWER; start <= NS_INSIDE; start++) {
            static trial t;
            assert_int_equal(run(k, NS_MLCP_AUTO, (ns_mode)start, &t), NS_OK);
        }
}

static void each_method_alone_ends(void **state) {
    (void)state;
    for (int method = NS_MLCP_PIVOT; method < NS_MLCP_METHODS; method++)
        for (int k = 0; k < PROBLEMS; k++)
            for (int start = NS_LOWER; start <= NS_INSIDE; start++) {
                static trial t;
                (void)run(k, (ns_mlcp_method)method, (ns_mode)start, &t);
            }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_is_solved_in_few_steps),
        cmocka_unit_test(each_method_alone_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
