/* src/engine/watch.h - somebody who looks at points inside of a trial: both sides of events, ends of periods.
 */
#ifndef NS_ENGINE_WATCH_H
#define NS_ENGINE_WATCH_H

#include "nonsmooth/status.h"

#include "nonsmooth/mlcp.h"

typedef enum ns_watch_side {
    NS_WATCH_LEFT,  /* of an event */
    NS_WATCH_RIGHT, /* of an event that was resolved */
    NS_WATCH_PERIOD /* the end of a period that was taken as the one before */
} ns_watch_side;

/* What is looked at: nothing; x of the unknowns that charges and devices depend on, and lambda, as they are
 * at hand; x, lambda as they are shown. */
typedef enum ns_watch_part { NS_WATCH_NOTHING, NS_WATCH_SOME, NS_WATCH_ALL } ns_watch_part;

typedef struct ns_watch {
    void *data;
    /* What is looked at of a point in this mode (m); *jumped grew with each jump in the trial so far. */
    ns_watch_part (*wants)(void *data, ns_watch_side side, const ns_mode *mode);
    /* Then the engine writes that: x (n), lambda (m), and if anything jumped in the trial so far, X (n),
     * Lambda (m), as ns_march_impulse(); */
    double *x, *lambda, *X, *Lambda;
    long *jumped;
    int *periods; /* how many ends of periods are passed over before one is shown; the engine counts down */
    /* and asks what is to be done.  NS_GUARD: after NS_WATCH_SOME, all is to be shown.  Any other but NS_OK:
     * the trial ends with that. */
    int (*sees)(void *data, ns_watch_side side, double t);
} ns_watch;

static inline ns_watch_part ns_watch_wants(const ns_watch *w, ns_watch_side side, const ns_mode *mode) {
    return w ? w->wants(w->data, side, mode) : NS_WATCH_NOTHING;
}

#endif
