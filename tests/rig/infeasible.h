/* tests/rig/infeasible.h - random problems without a solution, each made from a proof of that. */
#ifndef NONSMOOTH_TESTS_INFEASIBLE_H
#define NONSMOOTH_TESTS_INFEASIBLE_H

#include "sample.h"

/* s->none is set, s->farkas proves it.  Constraints that contradict each other, linear programs without a
 * feasible point or without a bound, monotone and copositive-plus problems that end in a ray, networks with
 * two rows that contradict. */
void infeasible_any(sample *s, int m);

/* Monotone, with or without a solution, by a little: 2^-17 of numbers of about 1 at the least. */
void infeasible_near(sample *s, int m);

#endif
