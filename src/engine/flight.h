/* src/engine/flight.h - the flight engine from inside: exact between events, by kept matrices.
 *
 *   flight_mode.c  modes met, their levels, kept       leg.c    steps inside a mode, as matrices
 *   watch.c        where a guard first breaks          turn.c   from one mode to the next (turn.h)
 *   way.c          by which of them to the next event
 *   lap.c          whole periods of them (lap.h)
 *   flight.c       the way from event to event
 */
#ifndef NS_FLIGHT_H
#define NS_FLIGHT_H

#include "lap.h"
#include "marcher.h"
#include "schedule.h"
#include "stage.h"

#include <stdint.h>

/* Samples of the guards in a leg, its longest length with guards and without, in h 2^k; legs of recurring
 * lengths that a level keeps; levels of a mode; modes that follow one. */
enum { NS_SAMPLES = 8, NS_GUARDED = 5, NS_UNGUARDED = 40, NS_KEPT = 16, NS_LEVELS = 4, NS_FOLLOWERS = 8 };
/* Where a stage is looked at. */
enum { NS_PIECES = 4 };

/* A step of one length inside a mode: P takes X to w, `advance` takes v to v, `sample` gives the guards at
 * 0, h/samples, ..., h. */
struct ns_leg {
    double h;
    int samples;
    double *P;       /* r*q */
    double *advance; /* nv*nv */
    double *sample;  /* ((samples+1) rows)*q; NULL: it was not flown yet */
    size_t bytes;
};

/* A length that was asked for; its leg is made when it is asked for again. */
typedef struct ns_kept {
    double h;
    ns_leg *leg;
    long used;
} ns_kept;

/* What is slow enough for the steps of one stage; good from `from` seconds after a discontinuity on. */
struct ns_level {
    double h, from;
    ns_stage *stage;                /* NULL: never reached yet */
    double looked;                  /* so many stages, one by one */
    ns_leg *rung[NS_UNGUARDED + 1]; /* h 2^k */
    ns_kept kept[NS_KEPT];
    int recent; /* the one asked for last */
};

/* A mode that followed, and the guards (bits, of the first 64) that nothing told of while somebody said that
 * it holds. */
typedef struct ns_follower {
    ns_flight_mode *mode;
    uint64_t untold;
} ns_follower;

struct ns_flight_mode {
    ns_mode *mode; /* m */
    long used;     /* by the clock */
    int status;    /* SINGULAR: it contradicts itself, and need not be tried again */
    int levels;    /* the first resolves what is fastest */
    int instant;   /* something in it dies out at once: what it is entered with may jump */
    ns_level level[NS_LEVELS];
    ns_follower follower[NS_FOLLOWERS]; /* most recent first; NULL: no more */
    ns_flight_mode *chain;
};

enum { NS_FLIGHT_BUCKETS = 256 };

/* The goal of a command that just changes. */
enum { NS_TOGGLES = 9 };

/* What a flight remembers besides the stepper's past. */
typedef struct ns_flight_past {
    double grounded; /* not before this time again, */
    double rest;     /* which is this much after it was stuck, */
    int stuck;       /* so often */
    int crowd;       /* so many events in a row came at once after another, */
    double event_t;  /* the last one here */
    long patience;   /* steps that may be wasted */
} ns_flight_past;

struct ns_flight {
    ns_march *m;
    ns_theta *s;
    ns_exo *exo;
    ns_schedule *schedule;
    double from, to_t; /* what the schedule is good for */
    ns_flight_mode *bucket[NS_FLIGHT_BUCKETS];
    size_t bytes, limit;
    long clock;
    double guess; /* h of the first level of the mode built last */
    /* where it is */
    ns_flight_mode *at;
    double t, since;                 /* since: the last discontinuity */
    double past_t;                   /* what t lost in rounding: X is of t + past_t */
    int broken;                      /* the guard that broke last, -1: not known, */
    double broken_t;                 /* when */
    const ns_flight_mode *broken_at; /* and of what mode; all its levels have the same guards */
    int doubted; /* a guard that broke, which no other mode mended: it may be off by more, */
    const ns_flight_mode *doubted_at; /* in this mode; NULL: there is none */
    double slack;                     /* s: how well the instant of an event is known */
    long budget;                      /* steps that are left */
    double *X;                        /* q: w, v */
    double *most;                     /* r: the largest |w| so far */
    ns_laps laps;
    ns_flight_past past, kept; /* now; as it was accepted */
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

/* flight_mode.c: the record of a mode, found or built (then shown).  Errors: SINGULAR, MEMORY, NUMBER. */
int ns_flight_find(ns_flight *f, const ns_mode *mode, ns_flight_mode **out);
void ns_flight_forget(ns_flight *f);
/* The stepper's mode, and the bounds of commanded pairs, are those of this mode. */
void ns_flight_show(ns_flight *f, const ns_mode *mode);
/* Drops the modes that were not flown for longest until all fit into three quarters of the limit; never keep.
 */
void ns_flight_trim(ns_flight *f, ns_flight_mode *keep);
/* The level to fly on, and (in *until) for how long after the discontinuity. */
ns_level *ns_flight_level(ns_flight *f, double *until);
/* Level i of a mode with its stage; NULL: there is none to be had, what is before will do. */
ns_level *ns_flight_reach(ns_flight *f, ns_flight_mode *k, int i);

/* leg.c: the leg of h 2^k, without samples; the leg of a length that recurs, NULL (and OK) if it does not
 * seem to; the samples of one that is flown.  Errors: MEMORY. */
int ns_leg_rung(ns_flight *f, ns_level *level, int k, ns_leg **out);
int ns_leg_sample(ns_flight *f, ns_level *level, ns_leg *leg);
int ns_leg_recurring(ns_flight *f, ns_level *level, double h, ns_leg **out);
/* By how much lengths from t on may differ that count as one. */
double ns_leg_slack(const ns_flight *f, double h);
void ns_leg_free(ns_leg *leg);
/* X moves on by tau, unwatched.  Errors: MEMORY. */
int ns_leg_advance(ns_flight *f, ns_level *level, double tau);
/* What X comes to by a leg; X moves there. */
void ns_leg_apply(const ns_stage *k, const ns_leg *leg, const double *X, double *then);
void ns_leg_take(ns_flight *f, const ns_level *level, const ns_leg *leg);

/* watch.c: the first interval between samples of a leg from X in which a guard may break, -1: none; the part
 * of that interval, from its begin, in which none does. */
int ns_watch_leg(ns_flight *f, const ns_level *level, const ns_leg *leg, double *clear);
/* Whether a guard breaks within tau <= h from X: 1, and *when; else 0.  Leaves series and coef. */
int ns_watch_near(ns_flight *f, const ns_level *level, double tau, double *when);
/* 1 if all guards (rows) hold at and between all samples ((samples+1) rows), with room to spare. */
int ns_watch_calm(const double *s, int rows, int samples);
/* c: the coefficients of (E1) at i/NS_PIECES of a way of s Euler steps. */
void ns_watch_pieces(double s, double (*c)[NS_ORDER]);
/* What guard g may be off by at X; where its rate is known. */
double ns_watch_noise(const ns_flight *f, const ns_stage *k, int g);
double ns_watch_noise_by(const ns_flight *f, const ns_stage *k, int g, double rate);
/* All guards at X, and what they may be off by, their instant being known to f->slack: value (2 rows), behind
 * them their rates; tol (rows).  Uses f->ahead. */
void ns_watch_sight(ns_flight *f, const ns_stage *k, const double *X, double *value, double *tol);

/* way.c: to t, unless a guard breaks before: *broke.  Errors: MEMORY; LIMIT: no budget. */
int ns_way_fly(ns_flight *f, double t, int *broke);

/* turn.c: the mode from here on, where a guard broke (natural), or commands in m->flip (nc) changed and
 * inputs jumped or turned; X moves if the state jumps.  m->flip is cleared.  OK, GUARD: found none, nothing
 * is changed; MEMORY. */
int ns_turn(ns_flight *f, int natural);
/* turn.c: the first mode, from X at t with commands as in m->step; X moves if the state jumps.  Errors: those
 * of the impulse problem. */
int ns_turn_start(ns_flight *f);
/* enter.c: X freed of what the constraints of its mode do not allow: rounding. */
void ns_enter_settle(ns_flight *f);
/* turn.c: inputs at t+ into z, their slopes into slope. */
void ns_turn_inputs(ns_flight *f);

/* flight.c: made, freed (NULL is allowed).  Errors: MEMORY. */
int ns_flight_create(ns_march *m, ns_flight **out);
void ns_flight_free(ns_flight *f);
/* From the accepted point of m->step at m->live on to t, or to the first event, as far as it can: it stops
 * before what it cannot resolve, and stays on the ground for a while.  Errors: MEMORY. */
int ns_flight_go(ns_flight *f, double t, ns_until until);
/* The consistent state at m->live.t, with m->step just started: in no time.  Errors: those of the impulse
 * problem. */
int ns_flight_settle(ns_flight *f);
/* The trial is accepted; it is dropped. */
void ns_flight_keep(ns_flight *f);
void ns_flight_drop(ns_flight *f);
/* 1 if it has nothing to say at m->live; when that will be over. */
int ns_flight_grounded(const ns_flight *f);
double ns_flight_back(const ns_flight *f);

#endif
