/* bridge/own_stored.h - the charge that the transit time of a D would hold, which is left out. */
#ifndef BRIDGE_OWN_STORED_H
#define BRIDGE_OWN_STORED_H

#include "analysis.h"

/* What flows at a point of .tran, and what the D are judged by. */
typedef struct ns_own_flow {
    double watts;   /* what V supply, those left out that take power */
    double amperes; /* the largest current of a source or an inductor; both 0 where no D asks */
} ns_own_flow;

ns_own_flow ns_bridge_own_flow(const CKTcircuit *ckt, const ns_analysis *a);

/* A D carries i (A) at v (V), `seconds` after the point before; below 0: that is far away.  Of an M its body
 * diode counts. */
void ns_bridge_own_count_stored(const ns_analysis *a, ns_own_taken *o, const ns_own_flow *flow, double i,
                                double v, double seconds);

/* One line about the D of which most would flow back, if that is much.  1 if it was written. */
int ns_bridge_own_note_stored(const ns_analysis *a);

#endif
