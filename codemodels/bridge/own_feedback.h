/* bridge/own_feedback.h - an M whose drain acts on its own gate. */
#ifndef BRIDGE_OWN_FEEDBACK_H
#define BRIDGE_OWN_FEEDBACK_H

#include "own_mosfet.h"

/* 1 if a capacitor ends at the gate, or at what resistors join to it, that does not lead to the source or
 * to a known voltage, or if an F or G of a current that V do not give feeds it: a Miller capacitance, or what
 * stands for one in the subcircuits of vendors. */
int ns_bridge_own_has_feedback(const CKTcircuit *ckt, const ns_own_mosfet *m);

/* 1 if a capacitor leads to anything but the source or ground: a signal may come through it. */
int ns_bridge_own_is_coupled(const CKTcircuit *ckt, const ns_own_mosfet *m);

/* 1 if a source feeds a current into the network of its gate that is not known here, or that charges it
 * rather than gives it a level, and that is no stand-in for a Miller capacitance: what drives the gate is not
 * known. */
int ns_bridge_own_is_fed(const CKTcircuit *ckt, const ns_own_mosfet *m);

#endif
