/* src/exact/exact_internal.h - the exact engine from inside.
 *
 *   engine.c          from event to event              advance.c         one step, to a guard that breaks
 *   mode_cache.c      modes met, with their matrices   mode_kernel.c     the matrices of one mode (E1), (E2)
 *   step_map.c        steps of one length, as matrices output_map.c      x, lambda of a point
 *   event_location.c  where a guard first breaks       guard_sign.c      whether a mode holds
 *   guard_values.c    guards and their rounding        mode_entry.c      what jumps where a mode is entered
 *   mode_selection.c  which mode follows               periodic_map.c    records a period of the sources
 *   periodic_replay.c repeats that period              sliding.c         modes in which a switch slides
 *   sample.c          a point on the way of a trial    create.c          this struct
 *   charge_rates.c    what an Euler step adds to the charges
 *   output_solve.c    x, lambda of a point by (P2), where the map of output_map.c cancels
 *   flows.c           charges summed from flows        input_series.c    what a step leaves off of inputs
 *   command_flips.c   which switches of the state change at an event
 *   command_order.c   in which order, where one follows from another
 *   kernel.c          answers engine/kernel.h
 *   fallback.c        for how long the ladder goes on instead
 *   fast_parts.c      what rings, as parts of X   long_steps.c      steps longer than a ring
 */
#ifndef NS_EXACT_INTERNAL_H
#define NS_EXACT_INTERNAL_H

#include "exact.h"
#include "fast_parts.h"
#include "inputs/time_events.h"
#include "mode_kernel.h"
#include "periodic_map.h"
#include "reinit/impulse.h"

#include <float.h>
#include <math.h>
#include <stdint.h>

enum {
    NS_SAMPLES = 8,              /* samples of the guards in a step, at most */
    NS_MAX_GUARDED_EXPONENT = 5, /* longest step with guards: h 2^5 */
    NS_LONG_EXPONENT = 10, /* where what is fast rings, steps above h are made for a span of h 2^10 or more */
    NS_DYING_EXPONENT = 6, /* and where it dies, of h 2^7 or more */
    NS_MAX_EXPONENT = 40,  /* longest step without guards: h 2^40 */
    NS_PREFIXES = 12,      /* points that are kept on the way to an anchor */
    NS_CACHED_STEPS = 16,  /* steps of recurring lengths that a time scale keeps */
    NS_TIME_SCALES = 4,    /* of one mode, at most */
    NS_SUCCESSORS = 8,     /* modes remembered as followers of one mode */
    NS_INTERVALS = 4,      /* a guard over a short step is evaluated at the ends of so many intervals */
    NS_EXACT_BUCKETS = 256
};

/* A step of one length inside a mode: P takes X to w, `advance` takes v to v, `sample` gives the guards at
 * 0, h/samples, ..., h; J gives the flows, of which w is summed. */
struct ns_step_map {
    double h;        /* s */
    int samples;     /* 0: no guards, or too long */
    double *P;       /* r*q; with J: what is added to w */
    double *J;       /* flows*q, behind P; NULL: the kernel has no flows */
    double *advance; /* nv*nv */
    double *sample;  /* ((samples+1) rows)*q; NULL: not needed yet */
    size_t bytes;    /* of all of it */
};

/* A length that was asked for; its step is made when it is asked for again. */
typedef struct ns_cached_step {
    double h;         /* s */
    ns_step_map *map; /* NULL: asked for once */
    long last_used;   /* by cache.clock */
} ns_cached_step;

/* Steps short enough for what has not died out `from` seconds after a discontinuity. */
struct ns_time_scale {
    double h, from;         /* s */
    int rings;              /* 1: what is fast rings; 0: it dies */
    ns_mode_kernel *kernel; /* NULL: not needed yet */
    double searched_steps;  /* short steps searched for events one by one */
    double kept_steps;      /* steps by matrices with samples */
    long pays_after;        /* trials: then these cost more than eigenvectors; 0: not yet */
    ns_step_map *doubled[NS_MAX_EXPONENT + 1]; /* steps of h 2^k */
    ns_cached_step cached[NS_CACHED_STEPS];    /* steps of other lengths */
    int recent;                                /* the place in `cached` asked for last */
    ns_fast_parts *fast;                       /* NULL: not needed yet */
};

/* A mode that followed once; the guards (bits, of the first 64) that were undecided when it was accepted. */
typedef struct ns_successor {
    ns_exact_mode *mode;
    uint64_t undecided;
} ns_successor;

/* What is kept of a mode. */
struct ns_exact_mode {
    ns_mode *mode;   /* m */
    long last_used;  /* by cache.clock */
    int status;      /* SINGULAR: the mode contradicts itself */
    int scales;      /* how many time scales; the first resolves what is fastest */
    int rates;       /* how many are resolved */
    int has_instant; /* 1: a constraint or a rate beyond resolution: entering may jump */
    int hides;       /* 1: a rate dies out within an instant, or is so large that it may be rounding of an
                        infinite one */
    int resolves;    /* 1: these are resolved, as far as t tells them apart */
    double shortest; /* s: the first of what is resolved has died out after this */
    ns_exact_mode *other; /* the same mode, resolved if this is not, or else not; NULL: not needed yet */
    ns_time_scale scale[NS_TIME_SCALES];   /* fastest first */
    ns_successor successor[NS_SUCCESSORS]; /* most recent first; NULL: no more */
    ns_exact_mode *next_in_bucket;
};

/* What one step of ns_exact_advance() did. */
struct ns_exact_step {
    const ns_time_scale *scale; /* NULL: X did not move */
    const ns_step_map *map;     /* it was this kept step as a whole; NULL: it was not */
    int guard;                  /* the guard that breaks at its end; NS_GUARD_NONE */
};

/* In place of a guard. */
enum { NS_GUARD_NONE = -1, NS_GUARD_UNKNOWN = -2 };

/* The point between events: saved and restored together by periodic_replay.c. */
typedef struct ns_exact_state {
    ns_exact_mode *mode;       /* NULL: no mode was found yet */
    ns_clock now;              /* X is of now.t + now.lost */
    double last_event_t;       /* s */
    double event_time_error;   /* s: what the instant of that event may be off by, for guards of pairs, */
    double command_time_error; /* and for controls: a switch whose control is met so much later changes too */
    long steps_left;           /* before the ladder has the rest */
} ns_exact_state;

/* Guards within their rounding of zero that were looked at h 2^8 ahead: until then they stay about as close.
 */
typedef struct ns_exact_quiet {
    const ns_exact_mode *mode; /* in this mode; NULL: none were */
    double event_t;            /* s: entered here */
    double from, until;        /* s */
    uint64_t guards;           /* bits, of the first 64 */
} ns_exact_quiet;

/* Steps longer than their samples (long_steps.c): which to try next. */
typedef struct ns_exact_long {
    const ns_time_scale *scale; /* on this time scale; NULL: on none yet */
    double event_t;             /* s: since this event */
    int exponent;               /* of the step to try next */
    int wait, misses;           /* so many steps not to try; in a row */
} ns_exact_long;

/* What a trial changes, restored when it is dropped. */
typedef struct ns_exact_past {
    ns_exact_quiet quiet;    /* nobody looks ahead again where this holds */
    ns_exact_long longer[2]; /* steps longer than their samples; beside wider parts */
    double guard_t;          /* s: when a guard broke last; -INFINITY: none did */
    long trials;             /* that were accepted */
    double period;           /* s: of the sources, as it is known then; 0: not known */
    double fallback_until;   /* s: the ladder steps up to there */
    double fallback_length;  /* s: of that stretch */
    int has_no_matrices;     /* 1: the mode of the point cannot be built */
    int failures;            /* events handed to the ladder, halved while all goes well */
    int event_count;         /* events in a row, closer together than counts as simultaneous */
    double previous_event_t; /* s: the last of them */
    long extra_steps;        /* steps that a trial may take beyond what the ladder would */
} ns_exact_past;

/* A point on the way to an anchor. */
typedef struct ns_exact_prefix {
    double count; /* steps of the kernel after the base */
    double last;  /* how many of these were the last step: no more may follow */
} ns_exact_prefix;

/* Of a way: whether all of x and lambda are straight lines. */
typedef enum ns_way_line { NS_LINE_UNASKED, NS_LINE_NONE, NS_LINE_KNOWN } ns_way_line;

/* From the accepted point to the end of a trial in one mode, between corners of all inputs.  Points on it are
 * series (E2) from an anchor: whole steps of the kernel after where its time scale comes into force. */
typedef struct ns_exact_way {
    int known;            /* 1: there is one */
    double end_t;         /* s */
    ns_exact_state from;  /* at its begin */
    ns_exact_state base;  /* where the time scale in use comes into force */
    ns_time_scale *scale; /* that one; NULL: nothing was looked at yet */
    double room;          /* s from there: it is in force for so long */
    double anchor;        /* how many steps of the kernel after that the anchor is; -1: there is none */
    int prefixes;         /* on the way to it by steps of h 2^k, longest first: points that are kept */
    ns_exact_prefix prefix[NS_PREFIXES];
    double *X_from, *X_base; /* q: X there */
    double *X_prefix;        /* NS_PREFIXES rows of q */
    double *powers;          /* 8 r: D^i w at the anchor */
    double *X;               /* q, and inputs that only outputs follow: what was looked at last */
    ns_way_line line;
    double *x_lambda[2]; /* n+m: x, lambda at both ends, if they are */
} ns_exact_way;

struct ns_exact {
    /* what it works on */
    const ns_system *system;
    ns_theta *s;                   /* charges, mode and reading of the point; (P1) over a short step */
    ns_dense_point *point;         /* of the run: where to start from, and what was reached */
    double h;                      /* s: longest step of the ladder */
    int timed;                     /* 1: every command is a function of time */
    ns_input_states *inputs;       /* inputs as states of a linear system */
    ns_time_events *events;        /* instants known ahead */
    double events_from, events_to; /* s: no known instant in between */
    unsigned char *acting;         /* nz: inputs that anything depends on */
    double output_only_shortest;   /* s: ns_exact_shortest() of inputs that only outputs follow */

    /* modes met */
    struct {
        ns_exact_mode *bucket[NS_EXACT_BUCKETS]; /* chains of modes with the same hash */
        size_t bytes, limit;                     /* of all that is kept; at most */
        long clock;                              /* counts uses */
        long steps_dropped; /* kept steps dropped so far: pointers to steps from before are void */
        double first_h;     /* s: h of the first time scale of the mode built last */
    } cache;

    /* the point */
    ns_exact_state state; /* mode, time, last event */
    double *X;            /* q: charges and fluxes w, then inputs v; not the impulse X of (J1) */
    double *max_abs;      /* r: the largest |w| so far */
    double highest;       /* V: the largest voltage of a pair that was open as a mode began */
    double *ohm;          /* m: what a pair's current drops, 1 A; 0 where lambda is a signal: a kink */
    ns_exact_past past, accepted; /* of the trial; of the accepted point */
    ns_counts counts;             /* what it cost so far */
    long replayed;                /* events in periods that were repeated */
    int failed;                   /* MEMORY, met where no status is returned */
    ns_engine *bound;             /* its bound of work holds; NULL: there is none */
    unsigned looks;               /* at that, every so many steps */

    /* the event */
    const ns_watch *watch; /* who looks at it; NULL: nobody */
    struct {
        int guard;                 /* guard that broke last */
        double t;                  /* s: when */
        const ns_exact_mode *mode; /* in which mode; NULL: none did */
        int at_once;               /* 1: it was below zero where it was looked at first */
    } broken;
    struct {
        int guard;                 /* guard that broke, and the same mode was selected again */
        const ns_exact_mode *mode; /* that mode; NULL: none */
        double times;              /* so often the guard's rounding counts there */
    } unmended, left;              /* left: guard that broke at once, in the mode left by the last event */
    int event_guard;               /* guard whose break is this event; NS_GUARD_NONE */
    int event_pair;                /* its pair, until another mode is taken; -1: none */
    uint64_t undecided;            /* guards of the mode asked last whose sign is not known, */
    uint64_t overruled;      /* and those that seem to break soon, though other evidence holds it right */
    ns_mode *wanted;         /* m: the mode to be tried */
    ns_mode *command_target; /* nc: mode a flipped command goes to */
    unsigned char *flips;    /* nc: 1: this command by the state flipped in this event */
    int jumped;              /* 1: something did in this event */
    double late;             /* s: until guards of the mode asked last, below zero, have reached it */
    int resolves;            /* 1: in this event each mode that is tried is resolved */
    struct {
        unsigned char *first, *first_flips; /* nc: point->flip and flips as the event began, */
        ns_mode *first_target;              /* nc: and command_target */
        unsigned char *due, *changed;       /* nc: commands that are to change, and that did */
        ns_mode *target;                    /* nc: to what */
        double *X;                          /* q: before the last one did */
        double *instant;                    /* n+m: integrals of the trial as the event began, */
        int any;                            /* if there were any */
    } order;                                /* command_order.c */
    ns_impulse impulse;                     /* of the impulse problem */
    const ns_mode_kernel *entered; /* of the mode entered last, if work.gone jumps; NULL: nothing does */

    /* a period of the sources */
    ns_period_record record;

    /* the trial */
    ns_exact_way way;

    /* work: contents are nobody's between two calls */
    double *X_next;   /* q: X after the step or the jump that is tried */
    double *X_before; /* q: X before the event */
    struct {
        double *block;                               /* all arrays of numbers, X and max_abs too */
        double *x_lambda;                            /* n+m: engine.c, sample.c, a point as it is read */
        double *z, *slope;                           /* nz: engine.c, inputs and slopes */
        unsigned char *closed, *flip;                /* nc: engine.c */
        double *powers, *sum;                        /* 8 r, r: step_map.c, D^i w and what a step adds */
        double *flows;                               /* 9 (n+m+nz+1): step_map.c, flows and their sum */
        double interval[NS_INTERVALS + 1][NS_ORDER]; /* event_location.c: (E1) over a whole kernel step */
        double *coef;                                /* 8 rows: event_location.c, guards as series (E1) */
        double *guards;                              /* (NS_SAMPLES+1) rows: event_location.c */
        double *max_abs;                             /* q: guard_values.c, largest |X| */
        double *X_ahead;                             /* q: guard_sign.c */
        double *values;                              /* 3 rows: guard_sign.c, values, rates, tolerances */
        double *jump_powers, *by,
            *gone; /* 8 r, r, r: mode_entry.c, D^i w, w that one round and all take away */
        double *impulse, *jump_x_lambda; /* rows, n+m: mode_entry.c */
        ns_mode *mode;                   /* m: engine.c */
        double *z_after, *slope_after;   /* nz: mode_selection.c, inputs and slopes right after the event */
    } work;
};

/* Times closer together than this are the same instant of a schedule. */
static inline double ns_exact_same_instant(const ns_exact *f) {
    return 8 * DBL_EPSILON * fabs(f->state.now.t);
}

/* X becomes X_next; and counts among the largest. */
static inline void ns_exact_take_next(ns_exact *f) {
    double *X = f->X;
    f->X = f->X_next;
    f->X_next = X;
}

static inline void ns_exact_note_size(ns_exact *f) {
    for (int i = 0; i < f->s->r; i++)
        f->max_abs[i] = f->max_abs[i] > fabs(f->X[i]) ? f->max_abs[i] : fabs(f->X[i]);
}

/* mode_cache.c: what is kept of a mode, found or built (then it is the stepper's mode).  Errors: SINGULAR,
 * MEMORY, NUMBER. */
int ns_exact_mode_find(ns_exact *f, const ns_mode *mode, ns_exact_mode **out);
void ns_exact_mode_forget_all(ns_exact *f);
/* Mode k with those finite rates resolved that it takes as instantaneous: k owns it; NULL: there are none
 * that the time tells apart.  And: 1: they are resolved from now on: its kernels are others; 0: there are
 * none, or their guards would be rounding. */
ns_exact_mode *ns_exact_mode_fine(ns_exact *f, ns_exact_mode *k);
/* What mode k resolves dies out within the rounding of the present time, or its guards are rounding: as if in
 * an instant again.  Not of the mode at work. */
void ns_exact_mode_coarsen(ns_exact *f, ns_exact_mode *k);
int ns_exact_mode_resolve(ns_exact *f, ns_exact_mode *k);
/* Drops the modes not used for longest until all fit into three quarters of the limit; never `keep`. */
void ns_exact_mode_trim(ns_exact *f, ns_exact_mode *keep);
/* The time scale to step on; *until: for how long after the discontinuity. */
ns_time_scale *ns_exact_mode_time_scale(ns_exact *f, double *until);
/* The one that led to here: what floats depends on it. */
ns_time_scale *ns_exact_mode_scale_before(ns_exact *f);
/* Time scale i of a mode with its kernel; NULL: it cannot be built, the one before will do. */
ns_time_scale *ns_exact_mode_reach(ns_exact *f, ns_exact_mode *k, int i);

/* step_map.c: the step of h 2^k, without samples; the kept step of a length that recurs, NULL (and OK) if it
 * was never asked for; adds samples to a step.  Errors: MEMORY. */
int ns_exact_step_of_length(ns_exact *f, ns_time_scale *scale, int k, ns_step_map **out);
/* The step of h 2^k, with samples for kernel steps of `spacing`, anew. */
int ns_exact_step_spaced(ns_exact *f, ns_time_scale *scale, int k, double spacing, ns_step_map **out);
int ns_exact_step_recurring(ns_exact *f, ns_time_scale *scale, double h, ns_step_map **out);
int ns_exact_step_sample(ns_exact *f, ns_time_scale *scale, ns_step_map *map);
void ns_exact_step_free(ns_step_map *map);
/* Lengths of steps from now on that differ by less than this (s) are the same. */
double ns_exact_step_length_error(const ns_exact *f, double h);
/* X moves on by tau; guards are not looked at.  Errors: MEMORY. */
int ns_exact_step_advance(ns_exact *f, ns_time_scale *scale, double tau);
/* then (q): X after a step; X moves there. */
void ns_exact_step_apply(ns_exact *f, const ns_mode_kernel *k, const ns_step_map *map, const double *X,
                         double *then);
void ns_exact_step_commit(ns_exact *f, const ns_time_scale *scale, const ns_step_map *map);

/* A guard as one of a set of bits, of the first 64; 0: it is none of these. */
static inline uint64_t ns_exact_bit_of(int g) {
    return g < 64 ? (uint64_t)1 << g : 0;
}

/* sample.c: the way of a trial begins at the state; ends at it, and is known. */
void ns_exact_way_begin(ns_exact *f);
void ns_exact_way_end(ns_exact *f);
/* x_lambda (n+m): x, lambda at X (q, and inputs that only outputs follow).  Errors: MEMORY. */
int ns_exact_output_of(ns_exact *f, ns_mode_kernel *k, const double *X, double *x_lambda);

/* engine.c: the state is that of the run's point, in the stepper's mode, as it is.  Errors: SINGULAR, MEMORY,
 * NUMBER.  x_lambda (n+m): x, lambda at X (q, and room for inputs that only outputs follow), with the inputs
 * of t on this side, which stay in work.z.  Errors: MEMORY. */
int ns_exact_place(ns_exact *f);
int ns_exact_output_at(ns_exact *f, double t, ns_side side, double *X, double *x_lambda);

/* fallback.c: the ladder has the next event, and what follows for some time. */
void ns_exact_fallback_start(ns_exact *f);

/* long_steps.c: a step of one time scale that rings or dies, longer than its samples, of at most *rest: *done
 * is how far X moved; 0: no such step is worth it, or guards come near zero; then *rest is how long others
 * may be.  Errors: MEMORY.  And: a step with samples was taken in place of it. */
int ns_exact_long_step(ns_exact *f, ns_time_scale *scale, double *rest, double *done);
void ns_exact_long_note_kept(const ns_exact *f, ns_time_scale *scale);

/* advance.c: one step, to t at the latest.  Errors: MEMORY; LIMIT: no steps are left, or it is over: 1 if the
 * bound of work is passed. */
int ns_exact_is_over(const ns_exact *f);
/* 1 from time to time, if a trial with NS_TO_STEP has taken enough work to end where it is. */
int ns_exact_is_to_pause(const ns_exact *f);
int ns_exact_advance(ns_exact *f, double t, ns_exact_step *step);

/* command_order.c: the mode from here on, where this guard broke (it may be unknown), or (NS_GUARD_NONE)
 * commands in point->flip (nc) changed and inputs jumped or turned; X moves if the state jumps.  point->flip
 * is cleared.  OK, GUARD: found none, nothing is changed; MEMORY. */
int ns_exact_select_mode(ns_exact *f, int guard);
/* mode_selection.c: the first mode, from X at t with commands as in the stepper; guess: 1: the stepper's, if
 * that holds; X moves if the state jumps.  Errors: those of the impulse problem. */
int ns_exact_select_start(ns_exact *f, int guess);
/* mode_entry.c: X freed of what the constraints of its mode do not allow: all of it; rounding alone, nothing
 * if there is more. */
void ns_exact_enter_consistent(ns_exact *f);
void ns_exact_enter_remove_drift(ns_exact *f);

#endif
