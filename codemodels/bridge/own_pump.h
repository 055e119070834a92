/* bridge/own_pump.h - the gate of an M that a C drives and that a D clamps. */
#ifndef BRIDGE_OWN_PUMP_H
#define BRIDGE_OWN_PUMP_H

#include "own_mosfet.h"

/* Of a gate that a C couples with a V that switches, and that a D keeps from falling below (or rising above)
 * a constant voltage: what that D leaves in the C.  0: it is none, or something else carries a current there.
 */
int ns_bridge_own_find_pumped(const CKTcircuit *ckt, const ns_own_mosfet *m, ns_own_drive *drive);

#endif
