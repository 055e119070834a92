/* bridge/own_overlap.h - two M in series of which one closes while the other one is closed, or would be. */
#ifndef BRIDGE_OWN_OVERLAP_H
#define BRIDGE_OWN_OVERLAP_H

#include "analysis.h"

/* 1 if one end of the channel of each is that of the other: closed, both short-circuit what is across them.
 */
int ns_bridge_own_in_series(const ns_own_mosfet *m, const ns_own_mosfet *n);

/* Before the point is counted: the M that changes between the point before and this one, at t (s). */
void ns_bridge_own_count_overlap(const CKTcircuit *ckt, ns_analysis *a, ns_own_taken *o, double above,
                                 double t);

/* One line about two M that the charge of their gates would have closed at once.  1 if it was written. */
int ns_bridge_own_note_overlap(const ns_analysis *a);

#endif
