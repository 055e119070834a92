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

/* The first corner of an input of s after t, s; INFINITY: none. */
double ns_bridge_timepoints_corner(const ns_system *s, double t);

/* The next timepoint if no event comes before it: on the grid of p->step, or at a corner of the inputs of s;
 * always after t_accepted.  Removes ngspice's breakpoints; sets the longest step. */
double ns_bridge_timepoints_next(ns_timepoints *p, const ns_system *s, double t_accepted);

/* The step, s, by which ngspice comes to t, when no breakpoint but p->stop is left: t becomes the first one,
 * and the step is longer by some rounding errors, so that ngspice cuts it.  From version 46 on it halves a
 * step that ends in the second half of the way to a breakpoint, and not at it. */
double ns_bridge_timepoints_step_to(ns_timepoints *p, double t);

/* --- where a waveform chooses them (nonsmooth/waveform.h) --- */

/* The longest step of the scheme, s, in a run up to stop: a small part of the shortest period of the inputs
 * of s, and of the run. */
double ns_bridge_timepoints_longest_step(const ns_system *s, double stop);

/* The time, s, in which every input of s that repeats itself has done so once; stop, if that is less. */
double ns_bridge_timepoints_slowest(const ns_system *s, double stop);

/* Points at all multiples of this time, s, at least: 1, 2 or 5 times a power of ten, fifty of them or more in
 * a run up to stop.  .meas sees nothing between from= and to= but points. */
double ns_bridge_timepoints_round(double stop);

/* The first time after t that is, or is just before, the beginning of a period of a PULSE (with a slow ramp
 * just behind it too; if the plot does not show its edges just before and behind it alone) or the end of the
 * run, s; INFINITY: none.  from= and to= of .meas often name such times, with another last digit; .meas takes
 * no interval that is not between both, and its rms and integ leave out the first point after from=. */
double ns_bridge_timepoints_beside_mark(const ns_system *s, double t, double stop, int edges_are_shown);

/* Two points of a run up to stop are further apart than this, s. */
double ns_bridge_timepoints_closest(double stop);

/* The timepoint before p->start, the first one that is not t = 0, or (0) one that the waveform chooses. */
double ns_bridge_timepoints_unchosen(ns_timepoints *p);

#endif
