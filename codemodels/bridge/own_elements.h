/* bridge/own_elements.h - the readers of ngspice's own D, S, W, M, as option `take` lets them be taken. */
#ifndef BRIDGE_OWN_ELEMENTS_H
#define BRIDGE_OWN_ELEMENTS_H

#include "extract_walk.h"

ns_extract_reader ns_bridge_own_diode, ns_bridge_own_switch, ns_bridge_own_current_switch,
    ns_bridge_own_mosfet;

/* Notes what was taken.  A status. */
int ns_bridge_own_keep(ns_extract_walk *w, const ns_own_taken *taken);

#endif
