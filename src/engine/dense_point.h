/* src/engine/dense_point.h - the point that the dense engines (exact, ladder) hand to one another.
 *
 * Charges, fluxes, mode and rates of that point are the past of the theta stepper (nonsmooth/theta.h), which
 * both engines use.  march/dense_run.c owns stepper and point, and keeps a copy of both for the accepted
 * point.
 */
#ifndef NS_ENGINE_DENSE_POINT_H
#define NS_ENGINE_DENSE_POINT_H

#include "base/clock.h"
#include "instant.h"

/* Events are located to h 2^-NS_EVENT_EXPONENT, and those closer together than that count as simultaneous. */
enum { NS_EVENT_EXPONENT = 20 };

typedef struct ns_dense_point {
    ns_clock now;
    double last_event_t; /* s: the last discontinuity that the exact engine passed */
    int at_event;        /* 1: this is the left side of an event that is not resolved yet, */
    int input_jumps;     /* and at it an input jumps or turns */
    unsigned char *flip; /* nc: commands that change at this event */
    ns_instant *instant; /* what jumped in this trial; NULL: not wanted */
} ns_dense_point;

#endif
