/* tests/bench/ways.h - ways to run a case through ngspice: by nonsmooth.cm, or by ngspice's own models at a
 * setting that bench_cases found best; and how far off what .meas reads from the time points is. */
#ifndef NONSMOOTH_TESTS_WAYS_H
#define NONSMOOTH_TESTS_WAYS_H

#include "results.h"
#include "rival.h"

enum { WAY_RUNS = 3 };

typedef struct way { /* one way to run a case, with what came of it */
    char name[96];
    rival_setting setting;
    rival_result result; /* of the last run */
    double seconds;      /* of CPU of the whole process, the median */
} way;

/* Of the worst unknown: of the mean, relative to the mean of the absolute value; of the extremes, relative to
 * the largest absolute value. */
typedef struct way_errors {
    double mean, extreme;
} way_errors;

/* With options in .model nonsmooth(...) (NULL: none), .tran step in units of the case. */
way way_ours(const char *name, double step, const char *options);

/* The fastest setting of ngspice's own models in build/bench/NAME.csv (of bench_cases) whose error there is
 * at most this, or the most accurate one; 0: there is none. */
int way_theirs(const bench_case *c, double error, way *w);

/* Runs it `count` times (at most WAY_RUNS), each at most `limit` s of CPU. */
void way_run(const bench_case *c, double limit, int count, way *w);

/* s of CPU of ngspice's start with the same netlist, which is read and not run. */
double way_start(const bench_case *c, const way *w);

way_errors way_errors_of(const bench_case *c, const rival_result *got, const rival_result *right);

#endif
