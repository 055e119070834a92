/* bridge/overvoltage.h - a switch that interrupts a coil's current into its roff. */
#ifndef BRIDGE_OVERVOLTAGE_H
#define BRIDGE_OVERVOLTAGE_H

#include "analysis.h"

/* One line at the end of .tran, if a node of a switch came to a voltage that no such circuit has; 1: it was
 * written. */
int ns_bridge_overvoltage_note(const CKTcircuit *ckt, const ns_analysis *a);

#endif
