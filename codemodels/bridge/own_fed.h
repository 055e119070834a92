/* bridge/own_fed.h - the currents that I, F, G and B feed into a node, as ranges. */
#ifndef BRIDGE_OWN_FED_H
#define BRIDGE_OWN_FED_H

#include "own_way.h"

/* The nodes of an I, F, G or a B of current, which flows from the first through it to the second; 0: it is
 * none. */
int ns_bridge_own_read_fed_ends(const GENinstance *inst, int *p, int *n);

/* Its current, A, as V hold its control; 0: they do not say. */
int ns_bridge_own_find_fed(const ns_own_way *w, const GENinstance *inst, ns_own_range *r);

#endif
