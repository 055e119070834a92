/* bridge/points.h - where ngspice's timepoints should be. */
#ifndef BRIDGE_POINTS_H
#define BRIDGE_POINTS_H

#include "ngspice.h"

/* Times closer than this, s, are one to ngspice: it compares breakpoints to 100 ulps. */
double points_closeness(const CKTcircuit *ckt);

/* Where the point after the present one should be if no event comes before: on the grid of ngspice's longest
 * step, beyond which ngspice does not go, or on a breakpoint; after t_accepted in any case.  first: the
 * present point is t = 0.  Forgets the breakpoints that are reached. */
double points_next(CKTcircuit *ckt, double t_accepted, int first);

#endif
