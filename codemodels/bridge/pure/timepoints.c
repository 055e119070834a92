/* bridge/pure/timepoints.c - where ngspice's timepoints should be: on its grid, its breakpoints and the
 * sources' corners. */
#include "timepoints.h"

#include <math.h>
#include <string.h>

/* Part of a step: a timepoint that close to the next of the grid replaces it. */
static const double sliver = 1e-3;

/* ngspice reads the first two. */
static void remove_all_breaks(ns_timepoints *p) {
    p->breaks[0] = p->breaks[1] = p->stop;
    p->nbreaks = 2;
}

/* ngspice would cut its step to a tenth after each breakpoint that is reached. */
static void remove_reached_breaks(ns_timepoints *p) {
    int reached = 0;
    while (reached < p->nbreaks - 1 && p->breaks[reached] <= p->t + ns_bridge_timepoints_closeness(p))
        reached++;
    if (p->nbreaks - reached < 2) {
        remove_all_breaks(p);
    } else if (reached > 0) {
        p->nbreaks -= reached;
        memmove(p->breaks, p->breaks + reached, (size_t)p->nbreaks * sizeof *p->breaks);
    }
}

/* The inputs' own corners: ngspice sets the breakpoint of a source's next corner only if it cut its step to
 * arrive at the one before, and for SIN and EXP never. */
static double next_corner(const ns_system *s, double t) {
    double corner = INFINITY;
    for (int i = 0; i < s->nz; i++)
        corner = fmin(corner, ns_signal_next_corner(&s->z[i], t));
    return corner;
}

/* Before tstart: steps of a fiftieth of the run, ngspice's own longest; Ctrl-C is heard between them. */
static double next_before_start(ns_timepoints *p) {
    const double step = fmax(p->step, p->stop / 50.0);
    const double start = p->start * (1.0 + 4.0 * 2.3e-16); /* rounding must not fall short of it */
    remove_all_breaks(p);
    p->max_step = step;
    return p->t + 1.5 * step < start ? p->t + step : p->t + step < start ? 0.5 * (p->t + start) : start;
}

/* The next timepoint of the grid, or a breakpoint or corner before it or closer behind it than a sliver. */
static double next_shown(ns_timepoints *p, const ns_system *s, double t_accepted) {
    const double grid = (floor(p->t / p->step + sliver) + 1.0) * p->step;
    const double now = fmax(p->t, t_accepted);
    double stop = p->stop;
    if (p->at_corners) {
        remove_reached_breaks(p);
        if (!(p->next_corner > now))
            p->next_corner = next_corner(s, now);
        stop = fmin(p->breaks[0], p->next_corner);
    } else {
        remove_all_breaks(p);
    }
    return stop < grid + sliver * p->step ? stop : grid;
}

double ns_bridge_timepoints_next(ns_timepoints *p, const ns_system *s, double t_accepted) {
    double t;
    p->max_step = (1.0 + 2.0 * sliver) * p->step;
    if (p->t < p->start)
        t = next_before_start(p);
    else if (p->skips_start)
        t = p->t + p->step / 1048576.0; /* shows 0+ in place of 0 */
    else
        t = next_shown(p, s, t_accepted);
    return fmax(t, t_accepted + ns_bridge_timepoints_closeness(p)); /* ahead, whatever rounding did */
}
