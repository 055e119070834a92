/* bridge/loop.c - ngspice's transient loop, made to step to the timepoints that the bridge chooses. */
#include "loop.h"

static const double no_truncation_errors = 1e30; /* of CKTtrtol */

int ns_bridge_loop_began_anew(CKTcircuit *ckt) {
    const int anew = ckt->CKTtrtol != no_truncation_errors;
    ckt->CKTtrtol = no_truncation_errors;
    return anew;
}

void ns_bridge_loop_take(CKTcircuit *ckt, ns_loop *loop, int at_corners, int resumed) {
    if (resumed) {
        ckt->CKTminBreak = loop->min_break;
    }
    ckt->CKTtrtol = no_truncation_errors;
    loop->min_break = ckt->CKTminBreak;
    loop->points = (ns_timepoints){.step = ckt->CKTmaxStep, .at_corners = at_corners};
    if (ckt->CKTmaxOrder == 2) { /* else ngspice asks twice a point for its truncation error */
        loop->max_order = ckt->CKTmaxOrder;
        ckt->CKTmaxOrder = 1;
    }
}

void ns_bridge_loop_release(CKTcircuit *ckt, ns_loop *loop) {
    if (loop->max_order) { /* ngspice frees as many states as it allocated by it */
        ckt->CKTmaxOrder = loop->max_order;
    }
    loop->max_order = 0;
}

static ns_time_loop read_times(const CKTcircuit *ckt) {
    return (ns_time_loop){.t = ckt->CKTtime,
                          .start = ckt->CKTinitTime,
                          .stop = ckt->CKTfinalTime,
                          .min_break = ckt->CKTminBreak,
                          .max_step = ckt->CKTmaxStep,
                          .breaks = ckt->CKTbreaks,
                          .nbreaks = ckt->CKTbreakSize};
}

double ns_bridge_loop_closeness(const CKTcircuit *ckt) {
    const ns_time_loop times = read_times(ckt);
    return ns_bridge_timepoints_closeness(&times);
}

int ns_bridge_loop_at_events(const CKTcircuit *ckt, const ns_loop *loop) {
    const ns_time_loop times = read_times(ckt);
    return ns_bridge_timepoints_at_events(&times, &loop->points);
}

double ns_bridge_loop_next(CKTcircuit *ckt, ns_loop *loop, const ns_system *s, double t_accepted, int first) {
    ns_time_loop times = read_times(ckt);
    times.skips_start = first && (ckt->CKTmode & MODEUIC) != 0;
    const double t = ns_bridge_timepoints_next(&times, &loop->points, s, t_accepted);
    ckt->CKTmaxStep = times.max_step;
    ckt->CKTbreakSize = times.nbreaks;
    return t;
}
