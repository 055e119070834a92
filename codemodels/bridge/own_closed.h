/* bridge/own_closed.h - a follower that its gate closes, or that conducts backwards, beside its own model. */
#ifndef BRIDGE_OWN_CLOSED_H
#define BRIDGE_OWN_CLOSED_H

#include "analysis.h"

/* Once it is taken: which end of its channel V hold. */
void ns_bridge_own_find_held(const CKTcircuit *ckt, ns_own_taken *o);

/* A point of .tran; i: what it carries forwards, A; seconds: since the point before. */
void ns_bridge_own_count_closed(const ns_analysis *a, ns_own_taken *o, double i, double seconds);

/* The part of its charge, or of the largest voltage there, that was off in .tran, forwards or backwards: the
 * larger one. */
double ns_bridge_own_closed_off(const ns_own_taken *o);

/* The line that says so. */
void ns_bridge_own_note_one_closed(const ns_own_taken *o);

#endif
