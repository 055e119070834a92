/* bridge/own_touch.h - which elements may carry a current into a node. */
#ifndef BRIDGE_OWN_TOUCH_H
#define BRIDGE_OWN_TOUCH_H

#include "ngspice.h"

/* 0: none of its terminals that carry a current is at this node (an equation); gates and controls carry none.
 * Of what is not known here every terminal counts. */
int ns_bridge_own_touches(const GENinstance *inst, int node);

/* 1 if an R joins these nodes (equations). */
int ns_bridge_own_joined_by_r(const CKTcircuit *ckt, int a, int b);

/* 1 if nothing but D touch one end of this D, each of them with the same side: none of them can carry a
 * current forwards, but for one that another one carries in breakdown. */
int ns_bridge_own_is_opposed(const CKTcircuit *ckt, const GENinstance *diode);

#endif
