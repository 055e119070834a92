/* bridge/own_weak.h - M whose gate comes slowly through what its own channel conducts at below vto. */
#ifndef BRIDGE_OWN_WEAK_H
#define BRIDGE_OWN_WEAK_H

#include "analysis.h"

/* A point of .tran of an M, `seconds` after the one before; i: A through its channel; above: V of
 * v(gate,source) beyond vto.  To be called before these are noted as those of the point before. */
void ns_bridge_own_count_weak(ns_own_taken *o, double i, double above, double seconds);

/* One line about the one whose gate was there for longest, if that is long.  1 if it was written. */
int ns_bridge_own_note_weak(const ns_analysis *a);

#endif
