/* src/engine/lap.h - periods of a drive that recur, as one product each.
 *
 * Where all that is known ahead of time repeats with one period, and a period went by with nothing but its
 * instants, each way between two of them a kept leg, then the next one is
 *
 *     w <- P w + c,    guards at all samples of all its legs: G w + c_g
 *
 * as long as no guard comes near: else it is flown event by event, as before.
 *
 * Where guards broke in it, at instants of their own, ways are flown as ever, but the events and modes that
 * are met on them are known, and only proved (replay.c): a period that goes another way is flown event by
 * event from its begin.
 */
#ifndef NS_LAP_H
#define NS_LAP_H

#include <stddef.h>

typedef struct ns_flight ns_flight;
typedef struct ns_flight_mode ns_flight_mode;
typedef struct ns_level ns_level;
typedef struct ns_leg ns_leg;

enum { NS_LAP_STEPS = 24 };

/* A leg that was flown all through, or all the way from one event to the next. */
typedef struct ns_lap_step {
    ns_flight_mode *mode;
    const ns_level *level;
    const ns_leg *leg; /* NULL: the way to the next event */
    int event;         /* an instant is at its end, */
    double end;        /* so much after the period began */
    int guard;         /* what breaks at its end, -1: nothing */
} ns_lap_step;

/* The guards of a step, in all guards of the lap. */
typedef struct ns_lap_part {
    int rows, samples;
} ns_lap_part;

/* A period as a product; its arrays are one block. */
typedef struct ns_lap {
    ns_flight_mode *mode; /* in which it begins and ends, */
    double from, period;  /* at from + k period, */
    double length;        /* of its legs together */
    int events, changes;  /* in it, and those that change the mode */
    int r, rows, parts;
    ns_lap_part part[NS_LAP_STEPS];
    double *P, *c;         /* r*r, r */
    double *G, *cg, *work; /* rows*r, rows, max(r, rows) */
    int steps;             /* 0: it is that product; else these are flown, */
    ns_lap_step *step;
    double *v, *back; /* steps*nv: with these inputs; q: where it began */
    size_t bytes;
} ns_lap;

/* What is recorded. */
typedef struct ns_laps {
    ns_lap *lap;      /* NULL: none is made */
    int open;         /* the steps since `begin` are all there, */
    int stretch, way; /* the first since the last event; it stands for all the way from there */
    int steps, known; /* so many of this period; of the last whole one (0: there was none) */
    ns_lap_step step[NS_LAP_STEPS], last[NS_LAP_STEPS];
    double *v;             /* NS_LAP_STEPS * nv: the inputs where each begins; NULL until needed */
    ns_flight_mode *first; /* in which it began, */
    double begin, period;  /* when, and how long it takes, as far as is known; 0: not */
    int refused;           /* laps in a row in which a guard came near */
    double again;          /* not before this time */
    long forgotten;        /* how often legs were */
} ns_laps;

/* A leg is about to be flown all through. */
void ns_laps_leg(ns_flight *f, const ns_level *level, const ns_leg *leg);
/* A way is about to be flown that is no kept leg, or not all of it. */
void ns_laps_way(ns_flight *f);
/* At its end a guard broke, which led from a mode to the present one. */
void ns_laps_broke(ns_flight *f, const ns_flight_mode *from, int guard);
/* Something else happened: the period does not count. */
void ns_laps_lost(ns_flight *f);
/* An instant that was known is behind.  Errors: MEMORY. */
int ns_laps_instant(ns_flight *f);
/* One period on, if one begins here, ends before t, and no guard comes near: 1. */
int ns_laps_fly(ns_flight *f, double t);
/* replay.c: the steps of such a period from here to t, flown; 0: it does not go that way, nothing is changed.
 */
int ns_laps_replay(ns_flight *f, const ns_lap *lap, double t);
/* Legs are gone; and modes. */
void ns_laps_forget_legs(ns_flight *f);
void ns_laps_drop(ns_flight *f);

#endif
