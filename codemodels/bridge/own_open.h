/* bridge/own_open.h - switches of ngspice whose control is connected to nothing. */
#ifndef BRIDGE_OWN_OPEN_H
#define BRIDGE_OWN_OPEN_H

#include "extract_walk.h"

/* Holds the nodes of a control at 0 V, as ngspice does, where nothing may carry a current into them; their
 * names are kept in *taken.  A status of the library. */
int ns_bridge_own_hold_open(const ns_extract_walk *w, int cp, int cn, ns_own_taken *taken);

/* One line for each such node. */
void ns_bridge_own_announce_open(const ns_extract *ex);

#endif
