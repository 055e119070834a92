/* src/events/guard.h - a guard at an instant, and whether it is about to break.
 *
 * A guard must not be negative.  Where it is zero but for rounding its rate decides, and where that is zero
 * too its second rate; where something jumps its impulse comes first: lexicographic order (J4).
 */
#ifndef NS_EVENTS_GUARD_H
#define NS_EVENTS_GUARD_H

/* value, rate, second rate: V or A, and 1/s and 1/s^2 of that; rounding: what the value may be off by. */
typedef struct ns_guard {
    double value;
    double rate;
    double second_rate;
    double rounding;
} ns_guard;

/* HOLDS, BREAKS: by its value, rate and second rate; SEEMS_TO: by what a kernel knows besides. */
typedef enum ns_guard_sign {
    NS_SIGN_HOLDS,
    NS_SIGN_SEEMS_TO_HOLD,
    NS_UNDECIDED,
    NS_SIGN_SEEMS_TO_BREAK,
    NS_SIGN_BREAKS
} ns_guard_sign;

/* The sign of numbers (count) in lexicographic order: that of the first one that is beyond what it may be off
 * by.  -1, 0 (none is), 1. */
int ns_events_sign(int count, const double *number, const double *off);

/* By the value alone, which is known as well as the instant: that may be off by time_error (s). */
ns_guard_sign ns_events_value_sign(const ns_guard *of, double time_error);
/* By all of them; g (s): the time in which a rate is told from rounding. */
ns_guard_sign ns_events_guard_sign(const ns_guard *of, double time_error, double g);

#endif
