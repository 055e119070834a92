/* bridge/points.h - where ngspice's timepoints should be. */
#ifndef BRIDGE_POINTS_H
#define BRIDGE_POINTS_H

#include "ngspice.h"
#include "nonsmooth/system.h"

/* Times closer than this, s, are one to ngspice: it compares breakpoints to 100 ulps. */
double points_closeness(const CKTcircuit *ckt);

typedef struct points_plan {
    double step; /* the longest that .tran asks for, s: ngspice's, as it was at first */
    double near; /* ngspice's CKTminBreak, as it was at first: `resume` makes it a part of the step, s */
    int corners; /* events and corners of the sources get points as well */
    double next; /* of the sources' corners, as it was last asked for, s */
} points_plan;

/* 1 if events get points at the present time: nothing is shown before .tran's tstart. */
int points_at_events(const CKTcircuit *ckt, const points_plan *p);

/* Where the point after the present one should be if no event comes before: on the grid of p->step, or a
 * breakpoint or a corner of the inputs of s that gets a point; after t_accepted in any case.  first: the
 * present point is t = 0.  Forgets the breakpoints that are reached, and those that get no point.  Lets
 * ngspice go further than p->step where nothing is shown. */
double points_next(CKTcircuit *ckt, points_plan *p, const ns_system *s, double t_accepted, int first);

#endif
