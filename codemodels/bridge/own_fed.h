/* bridge/own_fed.h - the currents that I, F, G and B feed into a node, as ranges. */
#ifndef BRIDGE_OWN_FED_H
#define BRIDGE_OWN_FED_H

#include "own_way.h"

enum { FED_BY_NONE, FED_KNOWN, FED_UNKNOWN };

/* FED_BY_NONE: it is no source of current.  *p, *n: its nodes; *r, if known: A from the first through it to
 * the second, as V hold its control. */
int ns_bridge_own_read_fed(const ns_own_way *w, const GENinstance *inst, int *p, int *n, ns_own_range *r);

#endif
