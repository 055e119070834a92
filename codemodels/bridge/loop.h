/* bridge/loop.h - ngspice's transient loop, made to step to the timepoints that the bridge chooses. */
#ifndef BRIDGE_LOOP_H
#define BRIDGE_LOOP_H

#include "ngspice.h"
#include "pure/timepoints.h"

typedef struct ns_loop {
    ns_timepoints points;
    int max_order; /* what ngspice's CKTmaxOrder was, if it is set to 1; else 0 */
} ns_loop;

/* No truncation errors, order 1, timepoints at_corners or on the grid alone.  For a start and, with
 * `resumed`, after `resume`.  ns_bridge_loop_release() gives the order back. */
void ns_bridge_loop_take(CKTcircuit *ckt, ns_loop *loop, int at_corners, int resumed);
/* After that, where a waveform chooses the timepoints: they may be as close as they must. */
void ns_bridge_loop_take_close(CKTcircuit *ckt, ns_loop *loop);
void ns_bridge_loop_release(CKTcircuit *ckt, ns_loop *loop);

/* 1 if an analysis or a `resume` began since the last call: both set CKTtrtol anew. */
int ns_bridge_loop_began_anew(CKTcircuit *ckt);

/* Reads ngspice's times into loop->points.  first: the present point is t = 0. */
void ns_bridge_loop_read(const CKTcircuit *ckt, ns_loop *loop, int first);

/* The next timepoint, as ns_bridge_timepoints_next(). */
double ns_bridge_loop_next(CKTcircuit *ckt, ns_loop *loop, const ns_system *s, double t_accepted);
/* The next timepoint, as ns_bridge_timepoints_unchosen(); no breakpoint is left. */
double ns_bridge_loop_unchosen(CKTcircuit *ckt, ns_loop *loop);
/* After that: ngspice's next step ends at t, s. */
void ns_bridge_loop_step_to(CKTcircuit *ckt, ns_loop *loop, double t);
/* t, s, or the first time that ngspice can step to, where t is before that or is the present time. */
double ns_bridge_loop_after(const CKTcircuit *ckt, double t);
/* The present timepoint is a breakpoint of ours: sources set none of theirs when it is accepted, which
 * ngspice would refuse, as in the past, where two corners are closer than 1e-7 pulse widths. */
void ns_bridge_loop_at_no_break(CKTcircuit *ckt);

#endif
