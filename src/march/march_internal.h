/* src/march/march_internal.h - the marcher from inside: shared by march.c, ladder.c, event.c, jump.c,
 * control.c, run_start.c. */
#ifndef NS_MARCH_INTERNAL_H
#define NS_MARCH_INTERNAL_H

#include "theta/theta_internal.h"

#include "nonsmooth/march.h"

/* The ladder: steps of h 2^-k.  Events are located to h 2^-20, far below the error of the scheme, and the
 * step that resolves them has that length.  Shorter steps would add noise: a voltage L (i - i_k)/h loses what
 * i has lost.  On the way to a given instant the ladder is used down to h 2^-4, and the tail is one step of
 * its own length; less than h 2^-40 is left undone. */
enum { NS_EVENT_RUNG = 20, NS_TAIL_RUNG = 4, NS_LAST_RUNG = 40 };
/* A guard that broke for the scheme and holds for (P1) is followed no longer than by a step of h 2^-this. */
enum { NS_SPURIOUS_RUNG = 10 };
/* After an event rates are read off implicit steps of h 2^-this and twice that. */
enum { NS_RATE_RUNG = 10 };
/* More events than this within one h: event-capturing steps of h 2^-NS_CAPTURE_RUNG until h has passed. */
enum { NS_CROWD = 16, NS_CAPTURE_RUNG = 2 };

/* Where the way has come to, besides the stepper's past. */
typedef struct ns_run_point {
    double t;
    double time_lost; /* what t lost in rounding: the steps have come to t + time_lost */
    int at_event;     /* the left side of an event that is still to be resolved */
    int jump;         /* that event is a jump of an input */
    double crowd_t;   /* since when events are counted, */
    int crowd;        /* and how many there were */
    double since;     /* the last discontinuity that exact/engine.c came to */
} ns_run_point;

/* What short steps began from and came to, and where it would have been at once. */
typedef struct ns_jump {
    double *left, *right;             /* the stepper's past: before them, after them */
    double left_t, left_past, last_t; /* left_past: time_lost of left_t */
    double *w, *rate;                 /* r: before them, with its rates (absolute) */
    double *last;                     /* r: w before the last of them, at last_t */
    double *x;                        /* n+m: x, lambda after them */
    double *z, *slope;                /* nz: inputs at left_t */
    ns_impulse to;                    /* x, lambda, X, Lambda, mode */
    ns_mode *mode;                    /* m */
} ns_jump;

struct ns_march {
    const ns_system *s;
    ns_system *own;                 /* that, where it is a copy of a large one; else NULL */
    struct ns_partition_run *fleet; /* NULL, or who goes all the way; then all below is unused */
    struct ns_sparse *sparse;       /* likewise */
    ns_theta *step;
    struct ns_exact *exact; /* NULL: all steps are the scheme's */
    ns_march_options options;
    double h;
    int tired;          /* the way that was tried gets stuck too often */
    double back, pause; /* when the sparse engine may be asked again, s; how long that was put off */
    ns_counts before;   /* of engines that handed over */
    long seen_events, seen_modes;    /* when it was last looked whether modes recur */
    ns_run_point live, kept;         /* of the trial; of the accepted point */
    double *past;                    /* the stepper's, at the accepted point */
    unsigned char *flip, *kept_flip; /* nc: commands that change at the event */
    double corner;                   /* first corner of the inputs after live.t */
    double limit;                    /* the next thing known to happen: no step of an event goes beyond */
    double *z, *z_left;              /* nz */
    unsigned char *due;              /* nc: commands that change where the walk stops */
    unsigned char *crossed;          /* nc: commands that the last try crossed */
    unsigned char *closed;           /* nc */
    ns_jump jump;
    int started, has_trial;
    int moved;    /* live, the stepper and flip are not as they were accepted */
    double asked; /* what the last trial was asked for */
    ns_until until;
    long budget; /* tries left in this call */
    long events;
    ns_counts counts, sum; /* of the engines that there are; with those before */
    ns_fault fault;
};

/* march.c: the first corner of the inputs after live.t; and a failure: keeps the status, its time and the
 * stepper's fault; returns the status. */
double ns_march_next_corner(ns_march *m);
void ns_march_drop(ns_march *m); /* the trial, if there is one */
int ns_march_fail(ns_march *m, int status);

/* select.c: makes the engines that the options ask for; whether what another engine failed with is worth a
 * try by the dense ones; they instead of the sparse one: before a start, or from its accepted point on. */
int ns_march_make_engines(ns_march *m, ns_fault *fault);
int ns_march_leaves_sparse(const ns_march *m, int status);
int ns_march_use_dense(ns_march *m, double t);
int ns_march_leave_sparse(ns_march *m);
/* From the accepted point of the dense engines on the sparse one goes, if it left long enough ago, or if most
 * events come to modes never seen. */
void ns_march_return_to_sparse(ns_march *m);
/* 1 if that is due because the way that is tried gets stuck often, and no switch chatters. */
int ns_march_hands_over(const ns_march *m);
/* Of all that went before, and of this. */
void ns_march_sum_counts(const ns_march *m, ns_counts *counts);
/* What only the dense engines have. */
void ns_march_free_dense(ns_march *m);

/* run_start.c: ns_march_start() of the dense engines, with switches as in closed (nc; NULL: open) where their
 * controls allow it. */
int ns_march_start_as(ns_march *m, double t0, const double *w0, const unsigned char *closed);

/* control.c */
/* Which time-only commands, at inputs z, contradict their switch: fills flip (nc), returns how many. */
int ns_ladder_switch_by_time(ns_march *m, const double *z, unsigned char *flip);
/* The same for commands that depend on the state, as the stepper's last trial has it. */
int ns_ladder_switch_by_state(ns_march *m, const double *z, unsigned char *flip);
/* The first instant in [m->live.t, t] at which one of the time-only commands in flip crosses; leaves in flip
 * those that cross at that instant. */
double ns_ladder_switch_instant(ns_march *m, double t, unsigned char *flip);
/* The first instant after t at which a sine that commands a switch turns round: between two of them it
 * crosses a threshold at most once, so that looking at step ends misses nothing.  INFINITY if there is none.
 */
double ns_ladder_switch_next_crest(const ns_march *m, double t);
void ns_ladder_switch_apply(ns_march *m, const unsigned char *flip);
/* What the state adds to the controls at x, where ns_theta_controls() finds it. */
void ns_ladder_switch_set(ns_march *m, const double *x);

/* ladder.c: from live.t towards stop (no corner of an input in between), to stop or to the left side of an
 * event; live.at_event is set then. */
int ns_ladder_walk(ns_march *m, double stop);
/* A step of length h has been taken; its end counts as t. */
void ns_march_arrive(ns_march *m, double t, double h);
/* The length of the steps at an event: h 2^-NS_EVENT_RUNG, or the next on the ladder that is visible in t. */
double ns_ladder_short_step(const ns_march *m);

/* jump.c: short steps begin here; the last of them does; if they showed a jump it is taken here instead,
 * where they began, at that time.  Errors: MEMORY. */
int ns_reinit_jump_create(const ns_theta *s, ns_jump *j);
void ns_reinit_jump_free(ns_jump *j);
void ns_reinit_jump_begin(ns_march *m);
void ns_reinit_jump_last_step(ns_march *m);
int ns_reinit_jump_commit(ns_march *m);
/* The square root of the energy, or some such, that a charge or a flux alone is. */
double ns_reinit_jump_amount(const ns_theta *s, int i, double w);

/* event.c: one implicit step of length h that resolves whatever breaks; such steps until the mode has
 * settled; rates freed of their rounding (0: something happens right here); the event at live.t resolved, to
 * its right side. */
int ns_ladder_short_try(ns_march *m, double h);
int ns_ladder_short_settle(ns_march *m, double h);
int ns_ladder_short_rates(ns_march *m);
int ns_ladder_event_resolve(ns_march *m);

/* event.c: 1 if a switch that changed twice at an instant (m->crossed) and wants to again (m->flip)
 * contradicts itself: it is named in the fault, LIMIT. */
int ns_ladder_event_contradicts(ns_march *m);

#endif
