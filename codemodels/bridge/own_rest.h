/* bridge/own_rest.h - S and W of vh = 0 whose control is at its threshold from the start on. */
#ifndef BRIDGE_OWN_REST_H
#define BRIDGE_OWN_REST_H

#include "analysis.h"

/* a->march was started, for .tran: the S and W that rest at their threshold and are not held there go into
 * found->start, to be held as long as .tran lasts; *any: there are some.  Not beside digital parts.  A
 * status. */
int ns_bridge_own_find_resting(const CKTcircuit *ckt, const ns_analysis *a, ns_own_found *found, int *any);

/* The march, of such a circuit with these held, was started: goes on to where the last of them leaves its
 * threshold, and sets found->start.until; failures end that.  Errors: MEMORY. */
int ns_bridge_own_find_leaving(const ns_analysis *a, ns_march *march, double stop, ns_own_found *found);

/* A point of .tran at t, by equation: an error, with one line, if the control of an S or W rests at its
 * threshold, for longer than `least` (s), and ngspice has the switch in the other state there. */
int ns_bridge_own_check_resting(ns_analysis *a, const double *value, double t, double least);

#endif
