/* src/exact/periodic_map.h - periods of a drive that recur, as one product each.
 *
 * Where all that is known ahead of time repeats with one period, and a period went by with nothing but its
 * instants, each way between two of them a kept leg, then the next one is
 *
 *     w <- P w + c,    guards at all samples of all its legs: G w + c_g
 *
 * as long as no guard comes near: else it is flown event by event, as before.
 *
 * Where guards broke in it, at instants of their own, ways are flown as ever, but the events and modes that
 * are met on them are known, and only proved (periodic_replay.c): a period that goes another way is flown
 * event by event from its begin.
 */
#ifndef NS_EXACT_PERIODIC_MAP_H
#define NS_EXACT_PERIODIC_MAP_H

#include <stddef.h>

typedef struct ns_exact ns_exact;
typedef struct ns_exact_mode ns_exact_mode;
typedef struct ns_time_scale ns_time_scale;
typedef struct ns_step_map ns_step_map;
typedef struct ns_exact_step ns_exact_step;

enum { NS_LAP_STEPS = 24 };

/* A leg that was flown all through, or all the way from one event to the next. */
typedef struct ns_period_step {
    ns_exact_mode *mode;
    const ns_time_scale *level;
    const ns_step_map *leg; /* NULL: the way to the next event */
    int event;              /* an instant is at its end, */
    double end;             /* so much after the period began */
    int guard;              /* what breaks at its end, -1: nothing */
} ns_period_step;

/* The guards of a step, in all guards of the lap. */
typedef struct ns_period_part {
    int rows, samples;
} ns_period_part;

/* A period as a product; its arrays are one block. */
typedef struct ns_period {
    ns_exact_mode *mode; /* in which it begins and ends, */
    double from, period; /* at from + k period, */
    double length;       /* of its legs together */
    int events, changes; /* in it, and those that change the mode */
    int r, rows, parts;
    ns_period_part part[NS_LAP_STEPS];
    double *P, *c;         /* r*r, r */
    double *G, *cg, *work; /* rows*r, rows, max(r, rows) */
    int steps;             /* 0: it is that product; else these are flown, */
    ns_period_step *step;
    double *v, *back; /* steps*nv: with these inputs; q: where it began */
    size_t bytes;
} ns_period;

/* What is recorded. */
typedef struct ns_period_record {
    ns_period *lap;   /* NULL: none is made */
    int open;         /* the steps since `begin` are all there, */
    int stretch, way; /* the first since the last event; it stands for all the way from there */
    int steps, known; /* so many of this period; of the last whole one (0: there was none) */
    ns_period_step step[NS_LAP_STEPS], last[NS_LAP_STEPS];
    double *v;            /* NS_LAP_STEPS * nv: the inputs where each begins; NULL until needed */
    ns_exact_mode *first; /* in which it began, */
    double begin, period; /* when, and how long it takes, as far as is known; 0: not */
    int refused;          /* laps in a row in which a guard came near */
    double again;         /* not before this time */
    long steps_dropped;   /* as it was at the last step */
} ns_period_record;

/* While the record is open: a step begins, its inputs are noted; it was taken, it is recorded. */
void ns_exact_period_note_inputs(ns_exact *f);
void ns_exact_period_record(ns_exact *f, const ns_exact_step *step);
/* At its end a guard broke, which led from a mode to the present one. */
void ns_exact_period_guard_broke(ns_exact *f, const ns_exact_mode *from, int guard);
/* Something else happened: the period does not count. */
void ns_exact_period_abort(ns_exact *f);
/* An instant that was known is behind.  Errors: MEMORY. */
int ns_exact_period_time_event(ns_exact *f);
/* The period is dropped: before modes are. */
void ns_exact_period_drop(ns_exact *f);

/* periodic_replay.c: one period on, if one begins here, ends before t, and no guard comes near: 1. */
int ns_exact_period_replay(ns_exact *f, double t);

#endif
