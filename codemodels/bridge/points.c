/* bridge/points.c - where ngspice's timepoints should be: on its grid, its breakpoints and the sources'
 * corners. */
#include "points.h"

#include <math.h>
#include <string.h>

double points_closeness(const CKTcircuit *ckt) {
    return fmax(ckt->CKTminBreak, 200.0 * 2.3e-16 * ckt->CKTfinalTime);
}

/* Forgets breakpoints that are reached: ngspice would cut its step after each to a tenth. */
static void drop_breaks(CKTcircuit *ckt) {
    int passed = 0;
    while (passed < ckt->CKTbreakSize - 1 && ckt->CKTbreaks[passed] <= ckt->CKTtime + points_closeness(ckt)) {
        passed++;
    }
    if (ckt->CKTbreakSize - passed < 2) { /* ngspice looks at two */
        ckt->CKTbreaks[0] = ckt->CKTbreaks[1] = ckt->CKTfinalTime;
        ckt->CKTbreakSize = 2;
        return;
    }
    memmove(ckt->CKTbreaks, ckt->CKTbreaks + passed,
            (size_t)(ckt->CKTbreakSize - passed) * sizeof *ckt->CKTbreaks);
    ckt->CKTbreakSize -= passed;
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

double points_next(CKTcircuit *ckt, const ns_system *s, double t_accepted, int first) {
    const double now = ckt->CKTtime;
    const double step = ckt->CKTmaxStep;
    double stop;
    double t;
    drop_breaks(ckt);
    stop = fmin(ckt->CKTbreaks[0], next_corner(s, fmax(now, t_accepted)));
    t = fmin(now + step, (floor(now / step + 1e-3) + 1.0) * step);
    if (first && (ckt->CKTmode & MODEUIC)) {
        t = now + step / 1048576.0; /* ngspice does not show t = 0 then: shows 0+ */
    } else if (stop < t + 1e-3 * step) {
        t = stop <= now + step ? stop : now + 0.5 * step; /* in two, rather than leave a sliver */
    }
    return fmax(t, t_accepted + points_closeness(ckt)); /* whatever rounding did, ahead */
}
