/* bridge/timepoints.c - where ngspice's timepoints should be: on its grid, its breakpoints and the sources'
 * corners. */
#include "timepoints.h"

#include <math.h>
#include <string.h>

/* Of a step: no point is left to be that near to another. */
static const double sliver = 1e-3;

double ns_bridge_timepoints_closeness(const CKTcircuit *ckt) {
    return fmax(ckt->CKTminBreak, 200.0 * 2.3e-16 * ckt->CKTfinalTime);
}

int ns_bridge_timepoints_at_events(const CKTcircuit *ckt, const ns_timepoints_plan *p) {
    return p->corners && ckt->CKTtime >= ckt->CKTinitTime;
}

/* ngspice looks at two. */
static void drop_all_breaks(CKTcircuit *ckt) {
    ckt->CKTbreaks[0] = ckt->CKTbreaks[1] = ckt->CKTfinalTime;
    ckt->CKTbreakSize = 2;
}

/* Forgets breakpoints that are reached: ngspice would cut its step after each to a tenth. */
static void drop_breaks(CKTcircuit *ckt) {
    int passed = 0;
    while (passed < ckt->CKTbreakSize - 1 &&
           ckt->CKTbreaks[passed] <= ckt->CKTtime + ns_bridge_timepoints_closeness(ckt)) {
        passed++;
    }
    if (ckt->CKTbreakSize - passed < 2) {
        drop_all_breaks(ckt);
    } else if (passed > 0) {
        memmove(ckt->CKTbreaks, ckt->CKTbreaks + passed,
                (size_t)(ckt->CKTbreakSize - passed) * sizeof *ckt->CKTbreaks);
        ckt->CKTbreakSize -= passed;
    }
}

/* The sources' own: ngspice sets its breakpoint after one only on arriving at that by cutting its step, and
 * never for SIN and EXP. */
static double next_corner(const ns_system *s, double t) {
    double corner = INFINITY;
    for (int i = 0; i < s->nz; i++) {
        corner = fmin(corner, ns_signal_next_corner(&s->z[i], t));
    }
    return corner;
}

/* Before tstart: there in steps of a fiftieth of the run, ngspice's own longest; Ctrl-C is heard between
 * them. */
static double next_unshown(CKTcircuit *ckt, const ns_timepoints_plan *p) {
    const double step = fmax(p->step, ckt->CKTfinalTime / 50.0);
    const double start = ckt->CKTinitTime * (1.0 + 4.0 * 2.3e-16); /* rounding must not fall short of it */
    drop_all_breaks(ckt);
    ckt->CKTmaxStep = step;
    return ckt->CKTtime + 1.5 * step < start ? ckt->CKTtime + step
           : ckt->CKTtime + step < start     ? 0.5 * (ckt->CKTtime + start)
                                             : start;
}

/* The next point on the grid. */
static double next_of_grid(const CKTcircuit *ckt, double step) {
    return (floor(ckt->CKTtime / step + sliver) + 1.0) * step;
}

/* That, or a corner before it or as good as there. */
static double next_shown(CKTcircuit *ckt, ns_timepoints_plan *p, const ns_system *s, double t_accepted) {
    const double t = next_of_grid(ckt, p->step);
    const double now = fmax(ckt->CKTtime, t_accepted);
    double stop = ckt->CKTfinalTime;
    if (p->corners) {
        drop_breaks(ckt);
        if (!(p->next > now)) {
            p->next = next_corner(s, now);
        }
        stop = fmin(ckt->CKTbreaks[0], p->next);
    } else {
        drop_all_breaks(ckt);
    }
    return stop < t + sliver * p->step ? stop : t;
}

double ns_bridge_timepoints_next(CKTcircuit *ckt, ns_timepoints_plan *p, const ns_system *s,
                                 double t_accepted, int first) {
    double t;
    ckt->CKTmaxStep = (1.0 + 2.0 * sliver) * p->step;
    if (ckt->CKTtime < ckt->CKTinitTime) {
        t = next_unshown(ckt, p);
    } else if (first && (ckt->CKTmode & MODEUIC)) {
        t = ckt->CKTtime + p->step / 1048576.0; /* ngspice does not show t = 0 then: shows 0+ */
    } else {
        t = next_shown(ckt, p, s, t_accepted);
    }
    return fmax(t, t_accepted + ns_bridge_timepoints_closeness(ckt)); /* whatever rounding did, ahead */
}
