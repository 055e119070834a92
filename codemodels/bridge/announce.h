/* bridge/announce.h - what is said once of the circuit that is simulated. */
#ifndef BRIDGE_ANNOUNCE_H
#define BRIDGE_ANNOUNCE_H

#include "session.h"

/* After the analysis was made: its size and what became of its devices, where that was not said yet.  OK, or
 * a code after one line. */
int ns_bridge_announce(ns_session *s);

#endif
