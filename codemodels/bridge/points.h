/* bridge/points.h - where ngspice's timepoints should be. */
#ifndef BRIDGE_POINTS_H
#define BRIDGE_POINTS_H

#include "ngspice.h"
#include "nonsmooth/system.h"

/* Times closer than this, s, are one to ngspice: it compares breakpoints to 100 ulps. */
double points_closeness(const CKTcircuit *ckt);

/* Where the point after the present one should be if no event comes before: on the grid of ngspice's longest
 * step, beyond which ngspice does not go, on a breakpoint or on a corner of the inputs of s; after t_accepted
 * in any case.  first: the present point is t = 0.  Forgets the breakpoints that are reached. */
double points_next(CKTcircuit *ckt, const ns_system *s, double t_accepted, int first);

#endif
