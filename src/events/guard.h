/* src/events/guard.h - a guard at an instant, and whether it is about to break.
 *
 * A guard must not be negative.  Where it is zero but for rounding its rate decides, and where that is zero
 * too its second rate; where something jumps its impulse comes first: lexicographic order (J4).
 */
#ifndef NS_EVENTS_GUARD_H
#define NS_EVENTS_GUARD_H

#include <math.h>

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
static inline int ns_events_sign(int count, const double *number, const double *off) {
    for (int i = 0; i < count; i++)
        if (!(fabs(number[i]) <= off[i]))
            return number[i] > 0 ? 1 : -1;
    return 0;
}

static inline ns_guard_sign ns_events_sign_of_guard(int sign) {
    return sign < 0 ? NS_SIGN_BREAKS : sign > 0 ? NS_SIGN_HOLDS : NS_UNDECIDED;
}

/* By the value alone, which is known as well as the instant: that may be off by time_error (s). */
static inline ns_guard_sign ns_events_value_sign(const ns_guard *of, double time_error) {
    const double off = of->rounding + fabs(of->rate) * time_error;
    return ns_events_sign_of_guard(ns_events_sign(1, &of->value, &off));
}

/* By the rates, where the value is undecided; g (s): the time in which a rate is told from rounding.  Over it
 * rates and second rates are one and two differences less exact than the value. */
static inline ns_guard_sign ns_events_rate_sign(const ns_guard *of, double time_error, double g) {
    const double number[] = {g * of->rate, g * g * of->second_rate};
    const double off[] = {8 * of->rounding + 2 * g * fabs(of->second_rate) * time_error, 64 * of->rounding};
    return ns_events_sign_of_guard(ns_events_sign(2, number, off));
}

#endif
