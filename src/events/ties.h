/* src/events/ties.h - thresholds that are met in one instant: which commands change with the one whose guard
 * broke, in whatever order they stand, and which switch slides.
 */
#ifndef NS_EVENTS_TIES_H
#define NS_EVENTS_TIES_H

#include <math.h>

#include "modes/mode.h"

/* MET: with a hysteresis, if its threshold is met in the same instant, as after the first of them the control
 * of the next may go back.  SAME: without, if its control is that of the event but for a factor; or if its
 * threshold is met in the same instant, as between the two a leg would be a short circuit: it then may go
 * back, and does not slide. */
typedef enum ns_tie { NS_TIE_NONE, NS_TIE_MET, NS_TIE_SAME } ns_tie;

/* What makes a command, whose switch is in this mode, change with another one; NONE: nothing does. */
static inline ns_tie ns_events_tie(const ns_command *of, ns_mode mode) {
    if (!of->gx || ns_mode_slides(mode))
        return NS_TIE_NONE;
    return of->on > of->off ? NS_TIE_MET : NS_TIE_SAME;
}

/* When a control that is that of the event reaches its own threshold, if that differs only by rounding (a
 * sign at zero), s after the event, where its guard has this value and rate.  INFINITY: it is no part of that
 * event, as it takes more than 2^-10 of h (s). */
static inline double ns_events_delay(double value, double rate, double h) {
    enum { LONGEST_EXPONENT = 10 };
    const double delay = -value / rate;
    return rate < 0 && delay <= ldexp(h, -LONGEST_EXPONENT) ? delay : INFINITY;
}

/* How far beyond that what follows counts. */
static const double ns_events_beyond_delay = 1 + 1e-6;

/* 1 if a switch slides that changes again in the instant in which it changed: without hysteresis its control
 * asks for the state that it has just left. */
static inline int ns_events_slides(const ns_command *of, int changed_before) {
    return changed_before && of->gx && of->on == of->off;
}

/* Where a charge or flux moves by no more than this, relative to the largest, commands do not wait for one
 * another: w is consistent but for its rounding. */
static const double ns_events_jump_waits = 1e-6;

/* How it slides; side: its current, or what it blocks backwards: (y, lambda) are both positive, or negative.
 */
static inline ns_mode ns_events_sliding_mode(double side) {
    return side >= 0 ? NS_SLIDES_UP : NS_SLIDES_DOWN;
}

#endif
