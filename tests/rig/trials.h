/* tests/rig/trials.h - one method of (P1) tried on problems whose answers are known. */
#ifndef NONSMOOTH_TESTS_TRIALS_H
#define NONSMOOTH_TESTS_TRIALS_H

#include "generators.h"

enum { TRIAL_MAX = 100 };

/* A small problem, W written row by row, and what a method made of it. */
typedef struct trial {
    double rows[TRIAL_MAX * TRIAL_MAX], q[TRIAL_MAX], l[TRIAL_MAX], u[TRIAL_MAX];
    int m;
    ns_mode mode[TRIAL_MAX];
    double lambda[TRIAL_MAX], y[TRIAL_MAX], residual;
    ns_mlcp_info info;
} trial;

/* Solves; an answer must satisfy the problem (natural residual 1e-10), which is asserted. */
int trial_run(trial *t, ns_mlcp_method method);

void trial_complementary(trial *t); /* all l = 0, u = inf */

void trial_close(double got, double expected); /* but for a few roundings of numbers of size 1 to 10 */

/* y = w lambda + q and the answer; from every start. */
typedef struct trial_pair {
    double w, q, l, u, lambda, y;
    ns_mode mode;
} trial_pair;
void trial_pairs(const trial_pair *c, int count, ns_mlcp_method method);

/* One pair of each law whose W is not 0, solved by hand, from every start; then five laws at once; then m =
 * 0. */
void trial_closed_forms(ns_mlcp_method method);

/* Problems 0..n-1 of a class with at most max pairs: how many a method solves.  Asserted: every answer
 * satisfies its problem; is the only one where that is known; nothing is called unsolvable. */
int trial_class(ns_mlcp_method method, int class, int n, int max);

/* ... solved by a method as well as by enumeration, at most 8 pairs, P-matrices: the same mode's values. */
void trial_agrees_with_the_oracle(ns_mlcp_method method, int class, int n);

/* Small problems without a solution: none may be called solved. */
void trial_infeasible(ns_mlcp_method method, int must_say_so);

#endif
