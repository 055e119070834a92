/* bridge/own_elements.h - the readers of ngspice's own D, S, W, M, as option `take` lets them be taken. */
#ifndef BRIDGE_OWN_ELEMENTS_H
#define BRIDGE_OWN_ELEMENTS_H

#include "extract_walk.h"
#include "own_structs.h"

ns_extract_reader ns_bridge_own_diode, ns_bridge_own_switch, ns_bridge_own_current_switch,
    ns_bridge_own_mosfet;

/* Notes what was taken.  A status. */
int ns_bridge_own_keep(ns_extract_walk *w, const ns_own_taken *taken);

/* own_start.c: 1 if ngspice has an S of vh = 0 closed whose control is at its threshold from the start on,
 * and never anywhere else. */
int ns_bridge_own_is_closed_at_rest(const ns_extract_walk *w, const ns_own_switch *s);
/* own_start.c: 1 if ngspice has it closed whose control is inside the hysteresis from the start on: by ON or
 * OFF; with uic the control of an S comes from its .ic, or from 0. */
int ns_bridge_own_is_closed_inside(const ns_extract_walk *w, const ns_own_switch *s);

/* An S that is closed at the start so, and whose control leaves the threshold later: *cp, the first node of
 * the control (of ron > roff, opens: the second one), becomes a node that stands for it.  Statuses of the
 * library. */
int ns_bridge_own_hold_start(ns_extract_walk *w, const ns_own_switch *s, int opens, int *cp);

#endif
