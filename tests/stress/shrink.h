/* tests/stress/shrink.h - a netlist with a finding -> the smallest one that still shows it. */
#ifndef NONSMOOTH_TESTS_SHRINK_H
#define NONSMOOTH_TESTS_SHRINK_H

#include "judge.h"

/* Takes out and short-circuits parts, shortens the run, drops parameters, rounds numbers, as long as the
 * verdict and its kind stay; for at most `seconds`.  f: the finding of *n, then that of what is left. */
void shrink(netlist *n, judge_finding *f, const judge_options *o, double seconds);

#endif
