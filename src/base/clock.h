/* src/base/clock.h - the time of an integration, and what it lost in rounding.
 *
 * A step of length h does not always take t to t + h: t has a rounding error of some eps t.  Steps of one
 * length round in the same direction each time, which would add up over many steps.
 */
#ifndef NS_BASE_CLOCK_H
#define NS_BASE_CLOCK_H

typedef struct ns_clock {
    double t;    /* s, as shown */
    double lost; /* s: the steps have come to t + lost */
} ns_clock;

/* A step of length h has been taken; its end is shown as t. */
static inline void ns_clock_advance(ns_clock *c, double t, double h) {
    c->lost += (c->t - t) + h;
    c->t = t;
}

#endif
