/* tests/compare/circuits.h - circuits of the benchmark, each with an engine, at work for some 10^8
 * instructions. They use no more of the library than include/. */
#ifndef NONSMOOTH_TESTS_CIRCUITS_H
#define NONSMOOTH_TESTS_CIRCUITS_H

#include "cases.h"

/* Of run number `at`, from 0; NULL: there are no more. */
const char *circuits_name(int at, const char **engine);

/* Goes through it; the sum of sizes of x at all points.  To file (may be NULL), at each point, time, x,
 * lambda and y to the last digit, and the mode; then the counters.  What fails ends the program. */
double circuits_run(int at, FILE *file, ns_counts *counts);

/* Twice, from its start, by one marcher: that sum of the second time, and the counters before and after it.
 */
double circuits_run_again(int at, ns_counts *before, ns_counts *after);

#endif
