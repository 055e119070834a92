/* src/events/guard.c - the sign of what is read as one number (J4). */
#include "guard.h"

#include <math.h>

/* What rates and second rates, over the time g, may be off by, in roundings of the value: they are one and
 * two differences less exact. */
static const double of_rate = 8, of_second_rate = 64;

int ns_events_sign(int count, const double *number, const double *off) {
    for (int i = 0; i < count; i++)
        if (!(fabs(number[i]) <= off[i]))
            return number[i] > 0 ? 1 : -1;
    return 0;
}

static ns_guard_sign as_guard(int sign) {
    return sign < 0 ? NS_SIGN_BREAKS : sign > 0 ? NS_SIGN_HOLDS : NS_UNDECIDED;
}

ns_guard_sign ns_events_value_sign(const ns_guard *of, double time_error) {
    const double off = of->rounding + fabs(of->rate) * time_error;
    return as_guard(ns_events_sign(1, &of->value, &off));
}

ns_guard_sign ns_events_guard_sign(const ns_guard *of, double time_error, double g) {
    const double number[] = {of->value, g * of->rate, g * g * of->second_rate};
    const double off[] = {of->rounding + fabs(of->rate) * time_error,
                          of_rate * of->rounding + 2 * g * fabs(of->second_rate) * time_error,
                          of_second_rate * of->rounding};
    return as_guard(ns_events_sign(3, number, off));
}
