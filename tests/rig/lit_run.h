/* tests/rig/lit_run.h - a system run from t = 0 and read at equal intervals. */
#ifndef NONSMOOTH_TESTS_LIT_RUN_H
#define NONSMOOTH_TESTS_LIT_RUN_H

#include "nonsmooth.h"

typedef struct lit_plan {
    double theta, gamma, h;
    double every; /* a multiple of h for lit_capture() */
    int samples;
} lit_plan;

/* Steps of h, events captured at their ends: ns_theta with NS_RESOLVE, after a jump at t = 0.
 * X: samples*n, the states read.  Returns the status of the first call that failed, else NS_OK. */
int lit_capture(const ns_system *s, const double *w0, const lit_plan *plan, double *X, ns_counts *counts);

/* Events located: ns_march. */
int lit_march(const ns_system *s, const double *w0, const lit_plan *plan, double *X, ns_counts *counts);

#endif
