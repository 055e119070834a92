/* bridge/own_elements.h - the readers of ngspice's own D, S, W, M, as option `take` lets them be taken. */
#ifndef BRIDGE_OWN_ELEMENTS_H
#define BRIDGE_OWN_ELEMENTS_H

#include "extract_walk.h"
#include "own_structs.h"

ns_extract_reader ns_bridge_own_diode, ns_bridge_own_switch, ns_bridge_own_current_switch,
    ns_bridge_own_mosfet;

/* own_kept.c. */

/* Notes what was taken.  A status. */
int ns_bridge_own_keep(ns_extract_walk *w, const ns_own_taken *taken);

/* Not taken: what to write so that it is. */
int ns_bridge_own_refuse_untaken(ns_extract_walk *w, const GENinstance *inst, const char *group);
int ns_bridge_own_refuse_value(ns_extract_walk *w, const GENinstance *inst, const char *name, double value,
                               const char *why);

/* own_diode.c. */

/* The current (A) at which the curve of a D, or of the body diode of an M, is read; the line for its curve,
 * whose voltage there is vf. */
double ns_bridge_own_current_of(const ns_extract_walk *w, const GENinstance *inst);

/* Refuses a model whose n or rs no diode has. */
int ns_bridge_own_check_law(ns_extract_walk *w, const GENinstance *inst, const ns_own_diode *d);

/* What an earlier pass found of it; NULL: nothing. */
const ns_own_current *ns_bridge_own_found(const ns_extract_walk *w, const GENinstance *inst,
                                          ns_own_path path);
ns_diode ns_bridge_own_ideal_of(const ns_extract_walk *w, const GENinstance *inst, const ns_own_diode *d,
                                double vf);

/* own_early.c: an S or W of a negative vh.  Statuses of a reader. */
int ns_bridge_own_add_early(ns_extract_walk *w, const GENinstance *inst, const ns_own_switch *s,
                            ns_own_taken *taken);

/* own_start.c. */

/* 1 if ngspice has an S or W of vh = 0 closed whose control is at its threshold from the start on. */
int ns_bridge_own_is_closed_at_rest(const CKTcircuit *ckt, int uic, const ns_own_switch *s);
/* 1 if ngspice has it closed whose control is inside the hysteresis from the start on: by ON or
 * OFF (a W: with uic only, else it is open); with uic the control of an S comes from its .ic, or from 0.
 * One of a negative vh: closed, but for where it came from under uic and in .dc. */
int ns_bridge_own_is_closed_inside(const ns_extract_walk *w, const ns_own_switch *s);

/* *cp, the first node of the control of an S (the second one, if ron > roff), becomes a node that stands for
 * it and keeps the switch so until the control leaves the threshold, if that is known of it; _found: in any
 * case.  Statuses of the library. */
int ns_bridge_own_hold_start(ns_extract_walk *w, const ns_own_switch *s, int *cp);
int ns_bridge_own_hold_found(ns_extract_walk *w, const ns_own_switch *s, const ns_own_start *start, int *cp);

/* NULL: no pass found that it is to be held. */
const ns_own_start *ns_bridge_own_found_start(const ns_extract_walk *w, const GENinstance *inst);

/* *node: a new node, whose voltage is gain times the current of element `by`. */
int ns_bridge_own_current_node(ns_extract_walk *w, const GENinstance *inst, int by, double gain, int *node);

#endif
