/* tests/bench/sweep.h - the ways in which a case is run, and the turns in which it is. */
#ifndef NONSMOOTH_TESTS_SWEEP_H
#define NONSMOOTH_TESTS_SWEEP_H

#include "report.h"

typedef struct plan {
    int quick, library,
        netlists; /* library: nothing else; netlists: nothing but ngspice, with ours and its own */
    int rounds;
    double limit;  /* s of CPU a run may take, */
    double budget; /* and all first runs of a case by the library, and by others */
} plan;

/* Runs c in every way, round by round: in the first all, then those that matter (the library's, and of the
 * others those that none of them beats in both time and error).  Returns the rows, which the caller frees. */
row *sweep_run(const bench_case *c, const plan *p, int *count);

#endif
