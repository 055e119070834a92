/* src/inputs/time_events.h - events that are known ahead of time: when inputs turn and jump, and when
 * switches flip whose commands depend on time only.
 *
 * An object stands at the right side of some time (or, after a seek, at its left side) and is moved from
 * event to event:
 *
 *     ns_inputs_events_seek(s, 0, NS_RIGHT, NULL);
 *     while (ns_inputs_events_next(s, end) <= end) {
 *         const ns_time_event *event = ns_inputs_events_pass(s);
 *         ... inputs right of event->t: ns_inputs_events_values(s, event->t, z, dz) ...
 *     }
 *
 * An input that does not enter, because it drives only commands of time, has no events of its own.
 */
#ifndef NS_INPUTS_TIME_EVENTS_H
#define NS_INPUTS_TIME_EVENTS_H

#include "nonsmooth/system.h"
#include "waves.h"

typedef struct ns_time_events ns_time_events;

typedef struct ns_time_event {
    double t;
    int jump;         /* an input that enters jumps, */
    int turn;         /* or its slope does, or a wave of it begins */
    int inputs;       /* which inputs jump or turn, */
    const int *input; /* in no order */
    int flips;        /* which commands flip, */
    const int *flip;  /* in no order */
} ns_time_event;

/* s must outlive it and not change.  active (nz): the inputs that enter; NULL: none does.
 * Errors: NULL, MEMORY. */
int ns_inputs_events_create(const ns_system *s, const unsigned char *active, ns_time_events **out);
void ns_inputs_events_free(ns_time_events *s); /* NULL is allowed */

/* This input of the system was replaced: what depends on it is made anew (*s as a whole, unless it was a
 * broken line and is one), to be put where it is needed by a seek.  After an error *s is as it was.  Errors:
 * MEMORY. */
int ns_inputs_events_renew(const unsigned char *active, int input, ns_time_events **s);

/* To one side of t.  closed (nc, or NULL): the states of the commands there; one that contradicts its control
 * flips at t, which is the first instant then.  NULL: as the controls say there, open between off and on. */
void ns_inputs_events_seek(ns_time_events *s, double t, ns_side side, const unsigned char *closed);

/* The time of the first event after the present time (at it, only after a seek: to the left side, or to a
 * contradiction); INFINITY: there is none up to `until`.  Times equal up to rounding are one event. */
double ns_inputs_events_next(ns_time_events *s, double until);

/* The period, s, with which all later events repeat for ever; 0: they do not, or there are none. */
double ns_inputs_events_period(const ns_time_events *s);

/* On by one such period, to t; the events between are skipped. */
void ns_inputs_events_skip(ns_time_events *s, double t, double period);

/* Whether the next event is more than a turn of inputs: a jump, or a flip. */
int ns_inputs_events_is_event(const ns_time_events *s);

/* To the right side of the next event.  *event is valid until the next call of this or of seek. */
const ns_time_event *ns_inputs_events_pass(ns_time_events *s);

/* The states of the switches there (nc; 0 of commands that depend on the state). */
const unsigned char *ns_inputs_events_closed(const ns_time_events *s);

/* The inputs that enter and their slopes at t, between the present time and the next event; of a SIN
 * or EXP all but the multiples of its waves.  z, dz: nz; of inputs that do not enter they are left alone. */
void ns_inputs_events_values(const ns_time_events *s, double t, double *z, double *dz);

#endif
