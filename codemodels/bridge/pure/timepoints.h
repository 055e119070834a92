/* bridge/pure/timepoints.h - where ngspice's timepoints should be. */
#ifndef BRIDGE_TIMEPOINTS_H
#define BRIDGE_TIMEPOINTS_H

#include <math.h>

#include "nonsmooth/system.h"

typedef struct ns_timepoints {
    double step;        /* the longest step that .tran asks for, s */
    int at_corners;     /* events and corners of the sources get timepoints as well */
    double next_corner; /* the next corner of the sources when it was last looked for, s */

    /* --- ngspice's loop, s --- */
    double t;         /* the present timepoint */
    double start;     /* .tran's tstart: nothing is shown before */
    double stop;      /* .tran's tstop */
    double min_break; /* breakpoints closer than this are one */
    int skips_start;  /* the present point is t = 0 and ngspice does not show it (uic) */

    /* --- the same, set by ns_bridge_timepoints_next() --- */
    double max_step; /* ngspice's longest step */
    double *breaks;  /* breakpoints, ascending, two or more; the last one is stop */
    int nbreaks;
} ns_timepoints;

/* Times closer than this, s, are one to ngspice: it compares breakpoints to 100 ulps. */
static inline double ns_bridge_timepoints_closeness(const ns_timepoints *p) {
    return fmax(p->min_break, 200.0 * 2.3e-16 * p->stop);
}

/* 1 if t1 differs from t2 by no more than the rounding of a sum. */
static inline int ns_bridge_timepoints_same(double t1, double t2) {
    return fabs(t1 - t2) <= 4.0 * 2.3e-16 * fmax(fabs(t1), fabs(t2));
}

/* 1 if events get timepoints at the present time. */
static inline int ns_bridge_timepoints_at_events(const ns_timepoints *p) {
    return p->at_corners && p->t >= p->start;
}

/* The next timepoint if no event comes before it: on the grid of p->step, at a breakpoint or at a corner of
 * the inputs of s; always after t_accepted.  Removes the breakpoints that are reached and those that get no
 * timepoint; sets the longest step. */
double ns_bridge_timepoints_next(ns_timepoints *p, const ns_system *s, double t_accepted);

#endif
