/* tests/stress/run.h - one run of a netlist by the library, in a child process with bounds on time and
 * memory. */
#ifndef NONSMOOTH_TESTS_RUN_H
#define NONSMOOTH_TESTS_RUN_H

#include "plan.h"

/* Compared are RUN_TIMES instants; for those whose events are a little early or late a run also has the
 * values at RUN_ASIDE steps of .tran (of a 160th of the run, if that is less) before and after each. */
enum { RUN_TIMES = 160, RUN_BAND = 3, RUN_LINE = 200 };
#define RUN_ASIDE 0.1

typedef struct run_setting {
    const char *name;
    double reltol;              /* 0: the default */
    double h;                   /* in steps of .tran; 0: the default of ngspice's code models */
    double longer;              /* times h; 0: 1 */
    double theta, gamma;        /* 0: 1 */
    unsigned long long shuffle; /* as plan_build() */
    double vary;
    ns_method method;
    int on_grid;     /* goes from time to time, without points between */
    double limit;    /* s of CPU */
    double at_least; /* s of CPU: a shorter run is repeated until all have taken so much; its mean counts */
} run_setting;

typedef enum run_end { RUN_NOT, RUN_DONE, RUN_REFUSED, RUN_SLOW, RUN_CRASHED } run_end;

/* A probe on the straight lines between all points that ngspice shows. */
typedef struct run_shown {
    double integral, of_abs; /* of it, of its absolute value, from the first point to the last */
    double low, high, first, last;
    double nodes;  /* of a voltage: the largest ones of its two nodes against ground, added */
    double jumped; /* by how much it changed between points that no time lies between */
} run_shown;

typedef struct run_result {
    run_end end;
    int status;             /* of the library, where it refused */
    char line[RUN_LINE];    /* what it said, or the signal that ended it */
    double t;               /* where it is, or stopped */
    double seconds, effort; /* CPU; effort_so_far() of the run */
    ns_counts counts;
    int engine;
    /* (S4) at all points: the largest wrong sign of a device, relative to the largest current or voltage of
     * all devices, and where. */
    double wrong_sign, wrong_t;
    int wrong_part;
    double value[RUN_TIMES * RUN_BAND * PLAN_PROBES]; /* by time, place in the band, probe */
    double most[PLAN_PROBES];                         /* of each probe, at these and where trials ended */
    run_shown shown[PLAN_PROBES];                     /* only by ngspice */
} run_result;

/* The k-th instant; of value[at * probes]. */
double run_time(const plan *p, int k);
double run_band_time(const plan *p, int at);

/* A result that a child can write to; never freed. */
run_result *run_room(void);

void run(const plan *p, const run_setting *s, run_result *r);

/* In this process: for a debugger. */
void run_here(const plan *p, const run_setting *s, run_result *r);

#endif
