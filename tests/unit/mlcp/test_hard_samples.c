/* tests/unit/mlcp/test_hard_samples.c - problems of tests/rig/generators.h that only one part of the default
 * order solves, or keeps from being called solved: without that part the line fails.
 *
 * Each was made backwards from an answer, or made to have none, and is judged by sample.c, which shares
 * nothing with the solver.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "generators.h"

enum { MAX = 200 };

typedef struct hard {
    const char *needs;       /* the part */
    int class, number, most; /* generate() */
} hard;

static sample s;
static ns_mlcp_solver *solver;
static ns_mode mode[MAX];
static double lambda[MAX], y[MAX];

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

/* The problem, and the mode to start from, as tests/stress draws it. */
static int solve(const hard *h) {
    generate(&s, h->class, (unsigned long long)h->number, h->most);
    const int how = dice_below(&s.dice, 3);
    for (int i = 0; i < s.m; i++)
        mode[i] = how == 0 ? NS_LOWER : how == 1 ? NS_INSIDE : (ns_mode)(dice_below(&s.dice, 3) - 1);
    const ns_mlcp p = sample_problem(&s);
    return ns_mlcp_solve(solver, &p, mode, lambda, y, NULL);
}

/* y and lambda obey their laws to 1e-10 of their terms, as ns_mlcp_solve() promises. */
static void solved(const hard *h) {
    const int status = solve(h);
    const ns_mlcp p = sample_problem(&s);
    if (status != NS_OK || !(ns_mlcp_residual(&p, lambda, NULL) < 1e-10) ||
        !(sample_residual(&s, lambda) < 1e-10))
        fail_msg("%s %d of at most %d: %s, needs %s", generator_name(h->class), h->number, h->most,
                 ns_status_name(status), h->needs);
    if (!s.unique)
        return;
    /* rounding of the data and of m sums, or what the residual leaves, times the condition */
    double condition;
    const double error = sample_error(&s, lambda, mode, &condition),
                 left = fmax(1e-15 * s.m, ns_mlcp_residual(&p, lambda, NULL));
    if (!(error <= 10 * condition * left))
        fail_msg("%s %d of at most %d: off by %g, needs %s", generator_name(h->class), h->number, h->most,
                 error, h->needs);
}

/* And once more: nothing is kept of the answers that were refused. */
static void refused(const hard *h) {
    const int first = solve(h), status = first == NS_E_INFEASIBLE ? solve(h) : first;
    const double *v = ns_mlcp_certificate(solver);
    const ns_mlcp p = sample_problem(&s);
    if (status != NS_E_INFEASIBLE || !v || !(ns_mlcp_certify(&p, v) > 0) || !(sample_margin(&s, v) > 0))
        fail_msg("%s %d of at most %d: %s, needs %s", generator_name(h->class), h->number, h->most,
                 ns_status_name(status), h->needs);
}

/* What is large in one row is no measure of another: rows that contradict by 2 % of a small q were called
 * solved with lambda 2e8 times what that q asks for, beside rows with large numbers. */
static void without_a_solution(void **state) {
    static const hard all[] = {
        {"lambda compared with the q of each row", CLASS_INFEASIBLE, 8970, 12},
        {"lambda compared with the q of each row", CLASS_INFEASIBLE, 9005, 12},
        {"lambda compared with the q of each row", CLASS_INFEASIBLE, 40981, 10},
        {"lambda compared with the q of each row", CLASS_INFEASIBLE, 29778, 20},
        {"lambda compared with the q of each row", CLASS_INFEASIBLE, 30141, 10},
        {"lambda compared with the q of each row", CLASS_INFEASIBLE, 71210, 10},
        {"a transform that is not that of a refused answer", CLASS_INFEASIBLE, 403, 12},
        {"a transform that is not that of a refused answer", CLASS_INFEASIBLE, 780, 12},
        {"two rows that are one", CLASS_INFEASIBLE, 9323, 12},
        {"two rows that are one", CLASS_INFEASIBLE, 1871, 24},
        {"a tableau made anew after some pivots", CLASS_INFEASIBLE, 539, 48},
        {"a tableau made anew after some pivots", CLASS_NEAR, 2755, 48},
        {"reduced costs that are rounding left aside", CLASS_INFEASIBLE, 268, 24},
    };
    (void)state;
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        refused(&all[k]);
}

static void with_a_solution(void **state) {
    static const hard all[] = {
        {"t = 0 before other pivots", CLASS_BOXES, 4338, 40},
        {"t = 0 before other pivots", CLASS_BOXES, 2436, 24},
        {"lambda refined where equations hold too coarsely for guards", CLASS_P, 13206, 12},
        {"rows and columns that elimination left over, in the proximal points", CLASS_PASSIVE, 5618, 24},
        {"rows and columns that elimination left over, in the proximal points", CLASS_PASSIVE, 175, 48},
        {"refinements of a mode's answer", CLASS_EQUALITIES, 9168, 12},
        {"refinements of a mode's answer", CLASS_PASSIVE, 3324, 48},
        {"refinements of the answer of branch and bound", CLASS_PASSIVE, 2346, 48},
        {"elimination on pairs that are inside", CLASS_MIXED, 2247, 48},
        {"covering vectors of other weights", CLASS_EQUALITIES, 3867, 48},
        {"starts of Lemke's method behind the sixth", CLASS_DEGENERATE, 81, 200},
        {"a tableau of Lemke's method made anew after many exchanges", CLASS_MIXED, 1391, 200},
        {"a tableau of Lemke's method made anew after many exchanges", CLASS_MIXED, 1791, 200},
    };
    (void)state;
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        solved(&all[k]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_a_solution),
        cmocka_unit_test(with_a_solution),
    };
    return cmocka_run_group_tests(tests, make_room, free_room);
}
