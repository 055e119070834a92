/* tests/bench/rival.h - one run of a case by ngspice in batch, with its own models or with ours. */
#ifndef NONSMOOTH_TESTS_RIVAL_H
#define NONSMOOTH_TESTS_RIVAL_H

#include "cases.h"

typedef struct rival_setting {
    const char *name; /* of the models */
    deck_models models;
    int gear;     /* else trap */
    int unmarked; /* no time points at the times that are compared: `values` lie on straight lines */
    double reltol;
    double step;         /* the longest, in units of the case */
    const char *options; /* of ours: what stands in .model nonsmooth(...); NULL: nothing */
} rival_setting;

typedef enum rival_end { RIVAL_DONE, RIVAL_ABORTED, RIVAL_TIMEOUT } rival_end;

/* Of one unknown over the run, as .meas computes it: straight lines between the time points. */
typedef struct rival_shape {
    double mean, size, most, least; /* size: the mean of the absolute value at the points */
} rival_shape;

typedef struct rival_result {
    rival_end end;
    double process; /* s of CPU of the whole process, start and output included */
    long points, rejected;
    double values[CASE_VALUES];
    rival_shape shape[CASE_UNKNOWNS];
} rival_result;

/* Where netlists are written and run; models: path of nonsmooth.cm.  Both are kept, not copied. */
void rival_home(const char *in, const char *models);

/* Runs it `runs` times in one process, for at most `limit` seconds of CPU.  0: it only reads the netlist and
 * ends.  Points, rejected and values are those of the last run. */
void rival_run(const bench_case *c, const rival_setting *s, int runs, double limit, rival_result *r);

#endif
