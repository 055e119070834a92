/* src/exact/periodic_map.h - periods of the sources that recur, as one product each.
 *
 * All that is known ahead repeats with one period.  Where a period had events at known instants only, and was
 * kept steps from one to the next, the next period is
 *
 *     w <- P w + c,    guards at all samples of all its steps: G w + c_g
 *
 * as long as no guard comes near zero.  Else it is integrated event by event.
 *
 * Where guards broke in the period, the next one is integrated step by step; the modes that follow at its
 * events are known, and only checked (periodic_replay.c).
 */
#ifndef NS_EXACT_PERIODIC_MAP_H
#define NS_EXACT_PERIODIC_MAP_H

#include <stddef.h>

typedef struct ns_exact ns_exact;
typedef struct ns_exact_mode ns_exact_mode;
typedef struct ns_time_scale ns_time_scale;
typedef struct ns_step_map ns_step_map;
typedef struct ns_exact_step ns_exact_step;

enum { NS_PERIOD_STEPS = 24 };

/* A kept step, or all from one event to the next. */
typedef struct ns_period_step {
    ns_exact_mode *mode;        /* in which */
    const ns_time_scale *scale; /* of the kept step */
    const ns_step_map *map;     /* the kept step; NULL: all up to the next event */
    int event;                  /* 1: a known instant is at its end */
    double end;                 /* s: that instant, after the begin of the period */
    int guard;                  /* guard that breaks at its end; NS_GUARD_NONE */
} ns_period_step;

/* The guards of one step among all guards of the period. */
typedef struct ns_period_part {
    int rows, samples;
} ns_period_part;

/* A period; its arrays are one block. */
typedef struct ns_period {
    ns_exact_mode *mode;   /* in which it begins and ends */
    double from, duration; /* s: it begins at from + k duration */
    int events;            /* in it */
    size_t bytes;          /* of all of it */

    /* as a product */
    double steps_length;                  /* s: lengths of its steps added up */
    int r, rows, parts;                   /* charges; guards at all samples; steps */
    ns_period_part part[NS_PERIOD_STEPS]; /* guards by steps */
    double *P, *c;                        /* r*r, r */
    double *G, *cg, *work;                /* rows*r, rows, max(r, rows) */

    /* as steps */
    int steps;            /* 0: it is a product */
    ns_period_step *step; /* steps */
    double *v;            /* steps*nv: inputs where each begins */
    double *X_before;     /* q: X at its begin */
} ns_period;

/* What is recorded of the present period. */
typedef struct ns_period_record {
    ns_period *period;                    /* made of the last ones; NULL: none is made */
    int open;                             /* 1: the steps since `begin` are all there */
    int since_event;                      /* the first step since the last event */
    int searched;                         /* 1: that one stands for all since the last event */
    int steps, known;                     /* of this period; of the last whole one (0: there was none) */
    ns_period_step step[NS_PERIOD_STEPS]; /* of this period */
    ns_period_step last[NS_PERIOD_STEPS]; /* of the last whole one */
    double *v;              /* NS_PERIOD_STEPS*nv: inputs where each begins; NULL: not needed yet */
    ns_exact_mode *first;   /* mode in which it began */
    double begin, duration; /* s: when it began; how long it takes, 0: not known */
    int refused;            /* periods in a row that did not repeat the kept one */
    double retry_at;        /* s: the kept period is not tried before */
    long steps_dropped;     /* cache.steps_dropped at the last step */
} ns_period_record;

/* While the record is open: a step begins, and its inputs are noted; it was taken, and is recorded. */
void ns_exact_period_note_inputs(ns_exact *f);
void ns_exact_period_record(ns_exact *f, const ns_exact_step *step);
/* At its end a guard broke, which led from a mode to the present one. */
void ns_exact_period_guard_broke(ns_exact *f, const ns_exact_mode *from, int guard);
/* Something else happened: this period is not recorded. */
void ns_exact_period_abort(ns_exact *f);
/* A known instant was passed.  Errors: MEMORY. */
int ns_exact_period_time_event(ns_exact *f);
/* The kept period is dropped: before modes are. */
void ns_exact_period_drop(ns_exact *f);

/* periodic_replay.c: one period on, if one begins here, ends before t, and repeats the kept one: 1. */
int ns_exact_period_replay(ns_exact *f, double t);

#endif
