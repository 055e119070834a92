/* src/exact/exact_internal.h - the exact engine from inside: exact between events, by kept matrices.
 *
 *   engine.c          from event to event              advance.c         from one event to the next
 *   mode_cache.c      modes met, with their matrices   mode_kernel.c     the matrices of one mode (E1), (E2)
 *   step_map.c        steps of one length, as matrices output_map.c      x, lambda of a point
 *   event_location.c  where a guard first breaks       guard_sign.c      whether a mode holds
 *   mode_selection.c  from one mode to the next        mode_entry.c      what jumps where a mode is entered
 *   guard_values.c    guards at a point, and their rounding
 *   periodic_map.c    a period of the sources, recorded and kept; periodic_replay.c: taken again
 */
#ifndef NS_EXACT_INTERNAL_H
#define NS_EXACT_INTERNAL_H

#include "exact.h"
#include "inputs/time_events.h"
#include "mode_kernel.h"
#include "periodic_map.h"
#include "reinit/impulse.h"

#include <float.h>
#include <math.h>
#include <stdint.h>

/* Samples of the guards in a leg, its longest length with guards and without, in h 2^k; legs of recurring
 * lengths that a level keeps; levels of a mode; modes that follow one. */
enum { NS_SAMPLES = 8, NS_GUARDED = 5, NS_UNGUARDED = 40, NS_KEPT = 16, NS_LEVELS = 4, NS_SUCCESSORS = 8 };
/* Where a stage is looked at. */
enum { NS_PIECES = 4 };

/* A step of one length inside a mode: P takes X to w, `advance` takes v to v, `sample` gives the guards at
 * 0, h/samples, ..., h. */
struct ns_step_map {
    double h;
    int samples;
    double *P;       /* r*q */
    double *advance; /* nv*nv */
    double *sample;  /* ((samples+1) rows)*q; NULL: it was not flown yet */
    size_t bytes;
};

/* A length that was asked for; its leg is made when it is asked for again. */
typedef struct ns_cached_step {
    double h;
    ns_step_map *leg;
    long used;
} ns_cached_step;

/* What is slow enough for the steps of one stage; good from `from` seconds after a discontinuity on. */
struct ns_time_scale {
    double h, from;
    ns_mode_kernel *stage;               /* NULL: never reached yet */
    double looked;                       /* so many stages, one by one */
    ns_step_map *rung[NS_UNGUARDED + 1]; /* h 2^k */
    ns_cached_step kept[NS_KEPT];
    int recent; /* the one asked for last */
};

/* A mode that followed, and the guards (bits, of the first 64) that nothing told of while somebody said that
 * it holds. */
typedef struct ns_successor {
    ns_exact_mode *mode;
    uint64_t untold;
} ns_successor;

struct ns_exact_mode {
    ns_mode *mode; /* m */
    long used;     /* by the clock */
    int status;    /* SINGULAR: it contradicts itself, and need not be tried again */
    int levels;    /* the first resolves what is fastest */
    int instant;   /* something in it dies out at once: what it is entered with may jump */
    ns_time_scale level[NS_LEVELS];
    ns_successor follower[NS_SUCCESSORS]; /* most recent first; NULL: no more */
    ns_exact_mode *chain;
};

/* What one step of ns_exact_advance() did. */
typedef struct ns_exact_step {
    const ns_time_scale *level; /* NULL: X did not move */
    const ns_step_map *leg;     /* it was this kept step as a whole; NULL: it was not */
    int broke;                  /* 1: a guard breaks at its end */
} ns_exact_step;

enum { NS_EXACT_BUCKETS = 256 };

/* What a exact remembers besides the stepper's past. */
typedef struct ns_exact_past {
    double grounded; /* not before this time again, */
    double rest;     /* which is this much after it was stuck, */
    int stuck;       /* so often */
    int crowd;       /* so many events in a row came at once after another, */
    double event_t;  /* the last one here */
    long patience;   /* steps that may be wasted */
} ns_exact_past;

struct ns_exact {
    const ns_system *system;
    ns_theta *s;
    ns_dense_point *point; /* of the run: where it is to go on from, and has come to */
    double h;              /* s: longest step of the scheme */
    long events;           /* passed so far */
    ns_input_states *exo;
    ns_time_events *schedule;
    double from, to_t; /* what the schedule is good for */
    ns_exact_mode *bucket[NS_EXACT_BUCKETS];
    size_t bytes, limit;
    long steps_dropped; /* so many kept steps were dropped: pointers to steps from before are void */
    long clock;
    double guess; /* h of the first level of the mode built last */
    /* where it is */
    ns_exact_mode *at;
    double t, since;                /* since: the last discontinuity */
    double time_lost;               /* what t lost in rounding: X is of t + time_lost */
    int broken;                     /* the guard that broke last, -1: not known, */
    double broken_t;                /* when */
    const ns_exact_mode *broken_at; /* and of what mode; all its levels have the same guards */
    int doubted; /* a guard that broke, which no other mode mended: it may be off by more, */
    const ns_exact_mode *doubted_at; /* in this mode; NULL: there is none */
    double slack;                    /* s: how well the instant of an event is known */
    long budget;                     /* steps that are left */
    double *X;                       /* q: w, v */
    double *most;                    /* r: the largest |w| so far */
    ns_period_record laps;
    ns_exact_past past, kept; /* now; as it was accepted */
    /* work */
    double *next;                           /* q */
    double *left;                           /* q */
    double *ahead;                          /* q */
    int status;                             /* of what was looked into beside */
    uint64_t untold;                        /* guards of the mode that was asked last of which nothing told */
    double *series, *gone;                  /* 8 r, r */
    double *coef;                           /* 8 (2 m + nc) */
    double *guards;                         /* (NS_SAMPLES+1) (2 m + nc) */
    double *rate;                           /* 2 m + nc */
    double *z, *slope;                      /* nz */
    double pieces[NS_PIECES + 1][NS_ORDER]; /* coefficients of (E1) in a whole stage */
    unsigned char *closed, *flip;           /* nc */
    unsigned char *turns;                   /* nc: how often a command changed in this event, */
    ns_mode *goal;                          /* nc: and to what it does next */
    int timed;                              /* no command changes where the state likes: nothing chatters */
    unsigned char *acting;                  /* nz: inputs that anything depends on */
    ns_mode *want;                          /* m */
    ns_impulse to;                          /* its arrays follow in one block */
    double *block;
};

/* Times this far apart are the same instant of a schedule. */
static inline double ns_exact_period_slack(const ns_exact *f) {
    return 8 * DBL_EPSILON * fabs(f->t);
}

/* mode_cache.c: the record of a mode, found or built (then the stepper's).  Errors: SINGULAR, MEMORY, NUMBER.
 */
int ns_exact_mode_find(ns_exact *f, const ns_mode *mode, ns_exact_mode **out);
void ns_exact_mode_forget_all(ns_exact *f);
/* Drops the modes that were not flown for longest until all fit into three quarters of the limit; never keep.
 */
void ns_exact_mode_trim(ns_exact *f, ns_exact_mode *keep);
/* The level to fly on, and (in *until) for how long after the discontinuity. */
ns_time_scale *ns_exact_mode_time_scale(ns_exact *f, double *until);
/* Level i of a mode with its stage; NULL: there is none to be had, what is before will do. */
ns_time_scale *ns_exact_mode_reach(ns_exact *f, ns_exact_mode *k, int i);

/* exact/step_map.c: the leg of h 2^k, without samples; the leg of a length that recurs, NULL (and OK) if it
 * does not seem to; the samples of one that is flown.  Errors: MEMORY. */
int ns_exact_step_of_length(ns_exact *f, ns_time_scale *level, int k, ns_step_map **out);
int ns_exact_step_sample(ns_exact *f, ns_time_scale *level, ns_step_map *leg);
int ns_exact_step_recurring(ns_exact *f, ns_time_scale *level, double h, ns_step_map **out);
/* By how much lengths from t on may differ that count as one. */
double ns_exact_step_slack(const ns_exact *f, double h);
void ns_exact_step_free(ns_step_map *leg);
/* X moves on by tau, unwatched.  Errors: MEMORY. */
int ns_exact_step_advance(ns_exact *f, ns_time_scale *level, double tau);
/* What X comes to by a leg; X moves there. */
void ns_exact_step_apply(const ns_mode_kernel *k, const ns_step_map *leg, const double *X, double *then);
void ns_exact_step_commit(ns_exact *f, const ns_time_scale *level, const ns_step_map *leg);

/* exact/event_location.c: the first interval between samples of a leg from X in which a guard may break, -1:
 * none; the part of that interval, from its begin, in which none does. */
int ns_exact_watch_step(ns_exact *f, const ns_time_scale *level, const ns_step_map *leg, double *clear);
/* Whether a guard breaks within tau <= h from X: 1, and *when; else 0.  Leaves series and coef. */
int ns_exact_watch_near(ns_exact *f, const ns_time_scale *level, double tau, double *when);
/* 1 if all guards (rows) hold at and between all samples ((samples+1) rows), with room to spare. */
int ns_exact_watch_clear(const double *s, int rows, int samples);
/* c: the coefficients of (E1) at i/NS_PIECES of a way of s Euler steps. */
void ns_exact_watch_pieces(double s, double (*c)[NS_ORDER]);

/* guard_values.c */
/* One of the matrices of guards (mode_kernel.h) at X: guard g. */
static inline double ns_exact_guard_of(const ns_mode_kernel *k, const double *rows, int g, const double *X) {
    double sum = 0;
    for (int j = 0; j < k->q; j++)
        sum += rows[j + g * k->q] * X[j];
    return sum;
}

/* What guard g may be off by at X; where its rate is known. */
double ns_exact_guard_rounding(const ns_exact *f, const ns_mode_kernel *k, int g);
double ns_exact_guard_rounding_at(const ns_exact *f, const ns_mode_kernel *k, int g, double rate);
/* All guards at X, and what they may be off by, their instant being known to f->slack: value (2 rows), behind
 * them their rates; tol (rows).  Uses f->ahead. */
void ns_exact_guard_values(ns_exact *f, const ns_mode_kernel *k, const double *X, double *value, double *tol);

/* engine.c: to the point, in the stepper's mode, as it is.  Errors: SINGULAR, MEMORY, NUMBER.  x, lambda
 * (n+m) at X, with the inputs of t on this side, which stay in f->z.  Errors: MEMORY. */
int ns_exact_place(ns_exact *f);
int ns_exact_output_at(ns_exact *f, double t, ns_side side, double *X, double *x);

/* advance.c: one step, to t at the latest.  Errors: MEMORY; LIMIT: no budget. */
int ns_exact_advance(ns_exact *f, double t, ns_exact_step *step);

/* mode_selection.c: the mode from here on, where a guard broke (natural), or commands in point->flip (nc)
 * changed and inputs jumped or turned; X moves if the state jumps.  point->flip is cleared.  OK, GUARD: found
 * none, nothing is changed; MEMORY. */
int ns_exact_select_mode(ns_exact *f, int natural);
/* mode_selection.c: the first mode, from X at t with commands as in f->s; X moves if the state jumps.
 * Errors: those of the impulse problem. */
int ns_exact_select_start(ns_exact *f);
/* mode_entry.c: X freed of what the constraints of its mode do not allow: rounding. */
void ns_exact_enter_consistent(ns_exact *f);
/* mode_selection.c: inputs at t+ into z, their slopes into slope. */
void ns_exact_select_inputs(ns_exact *f);

#endif
