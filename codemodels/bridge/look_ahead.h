/* bridge/look_ahead.h - the marcher's next trial, and with it ngspice's next timepoint. */
#ifndef BRIDGE_LOOK_AHEAD_H
#define BRIDGE_LOOK_AHEAD_H

#include "session.h"

/* Tries to go to the next event or output time and sets ngspice's step to it.  first: the present point is
 * the start.  OK, or a code after one line. */
int ns_bridge_look_ahead(ns_session *s, int first);

#endif
