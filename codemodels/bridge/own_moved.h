/* bridge/own_moved.h - the charge that the junction of a D moves back and forth, which is left out. */
#ifndef BRIDGE_OWN_MOVED_H
#define BRIDGE_OWN_MOVED_H

#include "own_stored.h"

/* A D is at v (V) and carried `mean` A in the `seconds` since the point before; below 0: that is far away. */
void ns_bridge_own_count_moved(const ns_analysis *a, ns_own_taken *o, const ns_own_flow *flow, double mean,
                               double v, double seconds);

/* One line about the D of which most would be moved, if that is much.  1 if it was written. */
int ns_bridge_own_note_moved(const ns_analysis *a);

#endif
