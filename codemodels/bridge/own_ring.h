/* bridge/own_ring.h - the capacitance of junctions, which is left out, where it would ring with a coil. */
#ifndef BRIDGE_OWN_RING_H
#define BRIDGE_OWN_RING_H

#include "analysis.h"

/* After the D and M of a point of .tran were counted: s, and whether the point before is near. */
void ns_bridge_own_count_ring(const CKTcircuit *ckt, ns_analysis *a, double t, int follows);

/* One line about the D after whose current most would ring, if that is much.  1 if it was written. */
int ns_bridge_own_note_ring(const ns_analysis *a);

#endif
