/* bridge/loop.c - ngspice's transient loop, made to step to the timepoints that the bridge chooses. */
#include "loop.h"

#include <math.h>

#include "versions.h"

static const double no_truncation_errors = 1e30; /* of CKTtrtol */

int ns_bridge_loop_began_anew(CKTcircuit *ckt) {
    const int anew = ckt->CKTtrtol != no_truncation_errors;
    ckt->CKTtrtol = no_truncation_errors;
    ns_bridge_versions_no_newtrunc(ckt);
    return anew;
}

void ns_bridge_loop_take(CKTcircuit *ckt, ns_loop *loop, int at_corners, int resumed) {
    if (resumed) /* ngspice made it a part of the step */
        ckt->CKTminBreak = loop->points.min_break;
    ckt->CKTtrtol = no_truncation_errors;
    ns_bridge_versions_no_newtrunc(ckt);
    loop->points = (ns_timepoints){.step = ckt->CKTmaxStep, .at_corners = at_corners};
    ns_bridge_loop_read(ckt, loop, 0);
    if (ckt->CKTmaxOrder == 2) { /* else ngspice asks twice a point for its truncation error */
        loop->max_order = ckt->CKTmaxOrder;
        ckt->CKTmaxOrder = 1;
    }
}

void ns_bridge_loop_take_close(CKTcircuit *ckt, ns_loop *loop) {
    const double closest = ns_bridge_timepoints_closest(ckt->CKTfinalTime);
    ckt->CKTminBreak = 0.5 * closest;
    ckt->CKTdelmin = 0.01 * closest;
    loop->points.min_break = ckt->CKTminBreak;
}

void ns_bridge_loop_release(CKTcircuit *ckt, ns_loop *loop) {
    if (loop->max_order) /* ngspice frees as many states as it allocated by it */
        ckt->CKTmaxOrder = loop->max_order;
    loop->max_order = 0;
}

void ns_bridge_loop_read(const CKTcircuit *ckt, ns_loop *loop, int first) {
    ns_timepoints *p = &loop->points;
    p->t = ckt->CKTtime;
    p->start = ckt->CKTinitTime;
    p->stop = ckt->CKTfinalTime;
    p->min_break = ckt->CKTminBreak;
    p->skips_start = first && (ckt->CKTmode & MODEUIC) != 0;
    p->breaks = ckt->CKTbreaks;
    p->nbreaks = ckt->CKTbreakSize;
}

double ns_bridge_loop_next(CKTcircuit *ckt, ns_loop *loop, const ns_system *s, double t_accepted) {
    const double t = ns_bridge_timepoints_next(&loop->points, s, t_accepted);
    ckt->CKTmaxStep = loop->points.max_step;
    ckt->CKTbreakSize = loop->points.nbreaks;
    return t;
}

double ns_bridge_loop_unchosen(CKTcircuit *ckt, ns_loop *loop) {
    loop->points.breaks = ckt->CKTbreaks; /* a dac_bridge may have set some in a load */
    loop->points.nbreaks = ckt->CKTbreakSize;
    const double t = ns_bridge_timepoints_unchosen(&loop->points);
    ckt->CKTmaxStep = loop->points.max_step;
    ckt->CKTbreakSize = loop->points.nbreaks;
    return t;
}

/* s: a shorter one ngspice refuses. */
static double least_step(const CKTcircuit *ckt) {
    return 2.0 * ckt->CKTdelmin;
}

double ns_bridge_loop_after(const CKTcircuit *ckt, double t) {
    static const double ulps = 1.8e-15; /* twice what _same() does not tell apart */
    return fmax(t, ckt->CKTtime + fmax(least_step(ckt), ulps * ckt->CKTtime));
}

void ns_bridge_loop_step_to(CKTcircuit *ckt, ns_loop *loop, double t) {
    const double step = ns_bridge_timepoints_step_to(&loop->points, t);
    ckt->CKTdelta = fmax(step, least_step(ckt));
    ckt->CKTmaxStep = loop->points.max_step;
}

void ns_bridge_loop_at_no_break(CKTcircuit *ckt) {
    ckt->CKTbreak = 0;
}
