/* bridge/loop.h - ngspice's transient loop, made to step to the timepoints that the bridge chooses. */
#ifndef BRIDGE_LOOP_H
#define BRIDGE_LOOP_H

#include "ngspice.h"
#include "pure/timepoints.h"

typedef struct ns_loop {
    ns_timepoints points;
    double min_break; /* ngspice's CKTminBreak at the start, s: `resume` makes it a part of the step */
    int max_order;    /* ngspice's CKTmaxOrder while it is set to 1; else 0 */
} ns_loop;

/* No truncation errors, order 1, timepoints at_corners or on the grid alone.  For a start and, with
 * `resumed`, after `resume`.  ns_bridge_loop_release() gives the order back. */
void ns_bridge_loop_take(CKTcircuit *ckt, ns_loop *loop, int at_corners, int resumed);
void ns_bridge_loop_release(CKTcircuit *ckt, ns_loop *loop);

/* 1 if an analysis or a `resume` began since the last call: both set CKTtrtol anew. */
int ns_bridge_loop_began_anew(CKTcircuit *ckt);

/* The functions of pure/timepoints.h, of ckt's fields.  first: the present point is t = 0. */
double ns_bridge_loop_closeness(const CKTcircuit *ckt);
int ns_bridge_loop_at_events(const CKTcircuit *ckt, const ns_loop *loop);
double ns_bridge_loop_next(CKTcircuit *ckt, ns_loop *loop, const ns_system *s, double t_accepted, int first);

#endif
