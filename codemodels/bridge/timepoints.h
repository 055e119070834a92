/* bridge/timepoints.h - where ngspice's timepoints should be. */
#ifndef BRIDGE_TIMEPOINTS_H
#define BRIDGE_TIMEPOINTS_H

#include "ngspice.h"
#include "nonsmooth/system.h"

/* Times closer than this, s, are one to ngspice: it compares breakpoints to 100 ulps. */
double ns_bridge_timepoints_closeness(const CKTcircuit *ckt);

typedef struct ns_timepoints_plan {
    double step; /* the longest that .tran asks for, s: ngspice's, as it was at first */
    double near; /* ngspice's CKTminBreak, as it was at first: `resume` makes it a part of the step, s */
    int corners; /* events and corners of the sources get points as well */
    double next; /* of the sources' corners, as it was last asked for, s */
} ns_timepoints_plan;

/* 1 if events get points at the present time: nothing is shown before .tran's tstart. */
int ns_bridge_timepoints_at_events(const CKTcircuit *ckt, const ns_timepoints_plan *p);

/* Where the point after the present one should be if no event comes before: on the grid of p->step, or a
 * breakpoint or a corner of the inputs of s that gets a point; after t_accepted in any case.  first: the
 * present point is t = 0.  Forgets the breakpoints that are reached, and those that get no point.  Lets
 * ngspice go further than p->step where nothing is shown. */
double ns_bridge_timepoints_next(CKTcircuit *ckt, ns_timepoints_plan *p, const ns_system *s,
                                 double t_accepted, int first);

#endif
