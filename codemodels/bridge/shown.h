/* bridge/shown.h - which signals are in the plot of this run. */
#ifndef BRIDGE_SHOWN_H
#define BRIDGE_SHOWN_H

#include "ngspice.h"

/* During a transient analysis: shown[eq] (neq of ngspice's equations) becomes 1 where .save, .print and the
 * like put the voltage or current of equation eq into the plot.  0: that is not known, as where a device's
 * parameter (@r1[i]) is saved too, which depends on others. */
int ns_bridge_shown_read(const CKTcircuit *ckt, int neq, unsigned char *shown);

/* 1 if no device's parameter (@r1[i]) is in the plot of this run; 0 also where there is none. */
int ns_bridge_shown_no_parameters(const CKTcircuit *ckt);

/* 1 if the plot has a node of each V of PULSE: a point where each of its edges ends.  shown: as read. */
int ns_bridge_shown_edges(const CKTcircuit *ckt, const unsigned char *shown);

/* During a transient analysis: the tmax of .tran, s; 0: it has none. */
double ns_bridge_shown_tmax(const CKTcircuit *ckt);

/* 1 if ngspice was given so many points of this run and left some out: with `.options interp` it writes one
 * value for each multiple of tstep, and at most one for each point that it is given. */
int ns_bridge_shown_interpolated(const CKTcircuit *ckt, int given);

#endif
