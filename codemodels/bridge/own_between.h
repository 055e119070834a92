/* bridge/own_between.h - switches with VON, VOFF whose control is long between these. */
#ifndef BRIDGE_OWN_BETWEEN_H
#define BRIDGE_OWN_BETWEEN_H

#include "analysis.h"

/* A point of .tran of an OWN_PSWITCH, `seconds` after the one before; below 0: that is far away. */
void ns_bridge_own_count_between(const ns_analysis *a, ns_own_taken *o, double seconds);

/* One line about the one whose control was there for longest, if that is long.  1 if it was written. */
int ns_bridge_own_note_between(const ns_analysis *a);

#endif
