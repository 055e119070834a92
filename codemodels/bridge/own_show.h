/* bridge/own_show.h - ngspice's own devices that were taken: what they show of a point, and what they were
 * taken for. */
#ifndef BRIDGE_OWN_SHOW_H
#define BRIDGE_OWN_SHOW_H

#include "analysis.h"

/* Node voltages inside D at a->x, a->lambda -> value (neq). */
void ns_bridge_own_show_values(const ns_analysis *a, double *value);

/* What @d1[id] and @s1[i] show, at the same point. */
void ns_bridge_own_show_states(const ns_analysis *a, CKTcircuit *ckt);

/* The accepted point of .tran, at t, s, counts for ns_bridge_own_note_curve(); what is between points counts
 * from `since` on, s: before, they are far apart. */
void ns_bridge_own_count_point(const CKTcircuit *ckt, ns_analysis *a, double since, double t);

/* At the end of .tran, at most one line of each kind, about the device for which it matters most: of a D or M
 * whose own voltage at the current that it carried is far from the one it was taken for, beside the voltages
 * it blocks, or whose current is far from one that was guessed; of charge that flows back; of the charge of
 * gates; of rings; of supplies.  1 if any was written. */
int ns_bridge_own_note_curve(const CKTcircuit *ckt, const ns_analysis *a);

/* In .op and .dc: the currents of the point read last into `most` (one of each own device), where they are
 * larger; one line about the D, if any, whose own is far from the one that was guessed.  1: likewise. */
void ns_bridge_own_count_dc(const ns_analysis *a, double *most);
int ns_bridge_own_note_guess(const ns_analysis *a, const double *most);

/* One line for each kind of device. */
void ns_bridge_own_announce(const ns_analysis *a);
/* A hash of the models of what was taken: another one after altermod. */
unsigned long long ns_bridge_own_hash(const ns_analysis *a);

/* own_early.c: what the other elements of an S or W of a negative vh carry at the point, and whether they are
 * closed, is added. */
void ns_bridge_own_add_beside_early(const ns_analysis *a, const ns_own_taken *o, double *i, int *on);

#endif
