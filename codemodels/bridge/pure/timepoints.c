/* bridge/pure/timepoints.c - where ngspice's timepoints should be: on its grid and the sources' corners. */
#include "timepoints.h"

#include <math.h>

/* Part of a step: a timepoint that close to the next of the grid replaces it. */
static const double sliver = 1e-3;

/* ngspice reads the first two. */
static void remove_all_breaks(ns_timepoints *p) {
    p->breaks[0] = p->breaks[1] = p->stop;
    p->nbreaks = 2;
}

/* The inputs' own corners: ngspice sets the breakpoint of a source's next corner only if it cut its step to
 * arrive at the one before, for SIN and EXP never, and cuts its step to a tenth after each. */
double ns_bridge_timepoints_corner(const ns_system *s, double t) {
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

/* The next timepoint of the grid, or a corner before it or closer behind it than a sliver. */
static double next_shown(ns_timepoints *p, const ns_system *s, double t_accepted) {
    const double grid = (floor(p->t / p->step + sliver) + 1.0) * p->step;
    const double now = fmax(p->t, t_accepted);
    double stop = p->stop;
    if (p->at_corners && !(p->next_corner > now))
        p->next_corner = ns_bridge_timepoints_corner(s, now);
    if (p->at_corners)
        stop = fmin(stop, p->next_corner);
    remove_all_breaks(p);
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

/* --- where a waveform chooses them --- */

/* The period of a signal, s; INFINITY: it has none. */
static double period_of(const ns_signal *z) {
    switch (z->kind) {
    case NS_PULSE:
        return z->u.pulse.per > 0.0 ? z->u.pulse.per : INFINITY;
    case NS_SIN:
        return z->u.sin.freq > 0.0 ? 1.0 / z->u.sin.freq : INFINITY;
    case NS_PWL:
        return isnan(z->u.pwl.repeat) || z->u.pwl.n < 1 ? INFINITY
                                                        : z->u.pwl.t[z->u.pwl.n - 1] - z->u.pwl.repeat;
    default:
        return INFINITY;
    }
}

double ns_bridge_timepoints_longest_step(const ns_system *s, double stop) {
    static const double of_period = 1.0 / 1024.0, of_run = 1.0 / 65536.0;
    double step = of_run * stop;
    for (int i = 0; i < s->nz; i++) {
        const double period = period_of(&s->z[i]);
        if (period > 0.0)
            step = fmin(step, of_period * period);
    }
    return step;
}

static double delay_of(const ns_signal *z) {
    return z->kind == NS_PULSE ? z->u.pulse.td : z->kind == NS_SIN ? z->u.sin.td : z->u.pwl.td;
}

double ns_bridge_timepoints_slowest(const ns_system *s, double stop) {
    double slowest = 0.0;
    for (int i = 0; i < s->nz; i++) {
        const double period = period_of(&s->z[i]);
        if (isfinite(period)) /* so it is a PULSE, SIN or PWL */
            slowest = fmax(slowest, period + fmax(delay_of(&s->z[i]), 0.0));
    }
    return fmin(slowest, stop);
}

double ns_bridge_timepoints_round(double stop) {
    const double power = pow(10.0, floor(log10(stop / 50.0)));
    return 5.0 * power <= stop / 50.0 ? 5.0 * power : 2.0 * power <= stop / 50.0 ? 2.0 * power : power;
}

/* How far before a mark, and behind it, the points are, as a part of the period or of the run.  Far more than
 * rounding: ngspice divides differences of voltages by this time, for the currents of its capacitors. */
static const double aside_part = 7e-7, behind_part = 1.5; /* .meas takes equal intervals by Simpson's rule */

/* Which of these: `aside` before the mark, the mark itself, and behind_part times aside after it. */
typedef enum ns_beside { UP_TO_IT, ALL_OF_THEM, NOT_THE_MARK } ns_beside;

/* The first of them after t; INFINITY: none. */
static double beside(double mark, double t, double aside, ns_beside which) {
    const double least = t + 0.25 * aside, behind = mark + behind_part * aside;
    if (mark - aside > least)
        return mark - aside;
    if (mark > least && which != NOT_THE_MARK)
        return mark;
    return behind > least && which != UP_TO_IT ? behind : INFINITY;
}

/* Behind the begin of a period there is a point soon, where an edge of a hundredth of it is over.  Where the
 * plot does not show that, one beside the begin does for from= and to= each. */
static ns_beside beside_begin(const ns_signal *z, double stop, int edges_are_shown) {
    if (z->u.pulse.tr > 0.01 * fmin(period_of(z), stop))
        return ALL_OF_THEM;
    return edges_are_shown ? UP_TO_IT : NOT_THE_MARK;
}

static double beside_period(const ns_signal *z, double t, double stop, ns_beside which) {
    const double td = z->u.pulse.td, per = fmin(period_of(z), stop), aside = aside_part * per;
    const double mark = td + fmax(floor((t + 2.0 * aside - td) / per), 0.0) * per;
    const double first = beside(mark, t, aside, which);
    if (aside < ns_bridge_timepoints_closest(stop))
        return INFINITY;
    return first < INFINITY ? first : beside(mark + per, t, aside, which);
}

double ns_bridge_timepoints_beside_mark(const ns_system *s, double t, double stop, int edges_are_shown) {
    double first = beside(stop, t, aside_part * stop, UP_TO_IT);
    for (int i = 0; i < s->nz; i++) {
        const ns_signal *z = &s->z[i];
        if (z->kind == NS_PULSE)
            first = fmin(first, beside_period(z, t, stop, beside_begin(z, stop, edges_are_shown)));
    }
    return first;
}

double ns_bridge_timepoints_closest(double stop) {
    return 16.0 * 2.3e-16 * stop; /* times that differ by 4 ulps are the same */
}

double ns_bridge_timepoints_unchosen(ns_timepoints *p) {
    double t = 0.0;
    if (p->t < p->start)
        return next_before_start(p);
    if (p->skips_start)
        t = 0.5 * ns_bridge_timepoints_closest(p->stop); /* shows 0+ in place of 0, once */
    p->skips_start = 0;
    remove_all_breaks(p);
    p->max_step = p->stop;
    return t;
}

double ns_bridge_timepoints_step_to(ns_timepoints *p, double t) {
    static const double ulps = 4.4e-16; /* more than rounding takes away, less than _same() tells apart */
    const double step = t * (1.0 + ulps) - p->t;
    if (t - p->t < 0.5 * ns_bridge_timepoints_closeness(p))
        return t - p->t; /* ngspice would take the breakpoint for the present time */
    p->breaks[0] = t;
    p->max_step = fmax(p->max_step, step);
    return step;
}
