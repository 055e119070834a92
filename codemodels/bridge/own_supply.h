/* bridge/own_supply.h - the current of a supply that feeds gates alone, whose charge is left out. */
#ifndef BRIDGE_OWN_SUPPLY_H
#define BRIDGE_OWN_SUPPLY_H

#include "analysis.h"

/* Before the first point: the V that feeds the gate of each M through switches. */
void ns_bridge_own_find_supplies(const CKTcircuit *ckt, ns_extract *ex);

/* A point of .tran, `seconds` after the one before; below 0: that is far away. */
void ns_bridge_own_count_supply(const ns_analysis *a, ns_own_taken *o, double seconds);

/* One line about a V that would show another current, if the charge of gates is most of it.  1 if it was
 * written. */
int ns_bridge_own_note_supply(const ns_analysis *a);

#endif
