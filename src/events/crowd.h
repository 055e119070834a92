/* src/events/crowd.h - events counted since a time: whether they crowd, or something chatters. */
#ifndef NS_EVENTS_CROWD_H
#define NS_EVENTS_CROWD_H

typedef struct ns_event_window {
    double from; /* s: the first of them */
    int events;  /* 0: there was none yet */
} ns_event_window;

/* One more at t: how many there were since the first, which is at most `length` s ago; else it is the first.
 */
static inline int ns_events_count(ns_event_window *w, double t, double length) {
    if (w->events == 0 || !(t - w->from <= length))
        *w = (ns_event_window){t, 0};
    return ++w->events;
}

#endif
