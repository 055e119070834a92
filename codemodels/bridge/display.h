/* bridge/display.h - B sources that act on nothing: what they show is computed from each point.
 *
 * Such a source holds a node that no other element reads and that R to ground alone load, or that others of
 * its kind read.  Where its expression is none of the library's, as a power v(a)*i(v1), the node is left out
 * of the circuit. */
#ifndef BRIDGE_DISPLAY_H
#define BRIDGE_DISPLAY_H

#include "analysis.h"
#include "extract_walk.h"

/* display_find.c: 1 if inst, whose expression was refused, acts on nothing: it and all that read its node are
 * kept in *list, and the circuit is to be read again with that.  0 too if there is no memory. */
int ns_bridge_display_may(const CKTcircuit *ckt, const GENinstance *inst, ns_display_list *list);

/* 1 if inst is in the list; it is kept in w->ex then, *status (as a reader's) says how. */
int ns_bridge_display_takes(ns_extract_walk *w, const GENinstance *inst, int *status);

/* What they show, in `value` (by equation), of all other values there; 0 where that is no finite number. */
void ns_bridge_display_values(const ns_extract *ex, double *value);

/* What they read is looked at if they are: marks it in `shown` (by equation). */
void ns_bridge_display_mark(const ns_extract *ex, unsigned char *shown);

/* display_points.c: between the point last read, at `from` (s), and p, between which all else is on straight
 * lines: until when (s) what they show is, too, within the option lines. */
double ns_bridge_display_until(ns_analysis *a, CKTcircuit *ckt, double from, const ns_waveform_point *p);

void ns_bridge_display_announce(const ns_extract *ex);

#endif
