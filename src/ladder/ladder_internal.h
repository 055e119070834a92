/* src/ladder/ladder_internal.h - the ladder engine from inside.
 *
 *   engine.c           made, started, asked        ladder.c   steps to a time or to the left side of an event
 *   state_switching.c  when commands cross         event.c    the right side of an event
 *   mirrored.c         commands that change with another one
 *   command_order.c    commands that follow from another one
 */
#ifndef NS_LADDER_INTERNAL_H
#define NS_LADDER_INTERNAL_H

#include "events/crowd.h"
#include "inputs/time_events.h"
#include "ladder.h"
#include "reinit/jump.h"

/* Steps are h 2^-k.  Events are located to h 2^-NS_EVENT_EXPONENT, far below the error of the scheme, and the
 * step that resolves them has that length.  Shorter steps would add noise: a voltage L (i - i_k)/h loses what
 * i has lost.  Up to a given instant steps down to h 2^-4 are used, and the tail is one step of its own
 * length; less than h 2^-40 is left out. */
enum { NS_TAIL_EXPONENT = 4, NS_LAST_EXPONENT = 40 };
/* A guard that broke for the scheme and holds for (P1) is followed by steps of h 2^-this at most. */
enum { NS_SPURIOUS_EXPONENT = 10 };
/* Steps of h 2^-this and less: charges and fluxes get the exact integral of an edge of a source. */
enum { NS_EDGE_EXPONENT = 4 };
/* After an event rates are computed from implicit steps of h 2^-this and twice that. */
enum { NS_RATE_EXPONENT = 10 };
/* After more events than this within one h: event-capturing steps of h 2^-NS_CAPTURE_EXPONENT until h has
 * passed.
 */
enum { NS_CROWDING = 16, NS_CAPTURE_EXPONENT = 2 };

struct ns_ladder {
    /* what it integrates */
    const ns_system *s;
    ns_theta *step;
    double h;              /* longest step, s */
    ns_dense_point *point; /* of the run; at its time and its event */
    /* saved and restored together */
    ns_event_window window, accepted_window; /* of the trial; of the accepted point */
    double *apart, *accepted_apart; /* nc: so far from its threshold one changed with one it mirrors */
    int any_apart;                  /* 1: some of these may not be 0 */
    /* bounds of what is tried */
    double corner;        /* s: the first corner of the inputs after point->now.t, if it is later than that */
    int corner_is_active; /* 1: it is one of an input of `active` */
    double limit;         /* s: the next event known ahead: no step of an event goes beyond */
    double until;         /* s: limit, or the time before it at which the exact engine is asked again */
    long budget;          /* steps that the trial may still take */
    int one_step;         /* the trial ends after one step */
    /* inputs and commands */
    ns_time_events *commands; /* when those flip that depend on time only */
    double *z, *z_left;       /* nz */
    double *fall;             /* nz: what inputs fall by in a short step */
    unsigned char *due;       /* nc: commands that change at the next stop */
    unsigned char *crossed; /* nc: commands that the last step crossed; at an event: how often each changed */
    unsigned char *closed;  /* nc: switches as commanded last */
    unsigned char *active;  /* nz: 1: a state, a pair or a command by the state may depend on it */
    /* events */
    struct {
        double *past, *lone;        /* the stepper's as the event began; before one command changed alone */
        double *instant;            /* n+m: integrals of the trial as the event began, */
        int any;                    /* if there were any */
        ns_clock now;               /* when it began, */
        long jumps, refused;        /* after so many, */
        unsigned char *first, *due; /* nc: with which commands; those that are to change, or did */
    } order;                        /* command_order.c */
    ns_jump jump;
    double *instant;   /* n+m: integrals of the trial before the short steps */
    int contradiction; /* the pair of a switch that contradicts itself, -1: none */
    long events;       /* resolved so far */
};

/* state_switching.c: the first instant from the right side of the point on, up to `until`, at which commands
 * that depend on time only change: marks them in flip (nc); INFINITY: none does. */
double ns_ladder_switch_by_time(ns_ladder *l, double until, unsigned char *flip);
/* Which commands that depend on the state contradict their switch, at inputs z, as the stepper's last trial
 * has it: marks them in flip (nc), returns how many. */
int ns_ladder_switch_by_state(ns_ladder *l, const double *z, unsigned char *flip);
/* The same at a start, where a control that is zero may be off by the rounding of the largest of x (n). */
int ns_ladder_switch_at_start(ns_ladder *l, const double *x, const double *z, unsigned char *flip);
void ns_ladder_switch_apply(ns_ladder *l, const unsigned char *flip);
/* By how much (> 0) command c, which depends on the state, contradicts its switch at l->z in the last trial.
 */
double ns_ladder_switch_excess(const ns_ladder *l, int c);
/* mirrored.c: at the left side of an event, marks in point->flip what changes with what is marked there.
 * After a step: those that have come to their own thresholds are as others are. */
int ns_ladder_switch_mirrored(ns_ladder *l);
void ns_ladder_switch_passed(ns_ladder *l);

/* ladder.c: from the point to stop (no corner of an input in between), or to the left side of an event:
 * point->at_event is set then.  If l->one_step is set: by one step at most, or by shorter ones to an event in
 * it. */
int ns_ladder_walk(ns_ladder *l, double stop);
/* 1 if the state commands a switch. */
int ns_ladder_any_by_state(const ns_ladder *l);

/* event.c: 1 if an input has two values at the point's time: l->z_left, l->z; the step of length h to t that
 * is tried next, if it is short, charges with the mean of inputs. */
int ns_ladder_inputs_jump(ns_ladder *l);
void ns_ladder_mean_inputs(ns_ladder *l, double h, double t);

/* event.c: the first corner of the inputs after the point, s. */
double ns_ladder_next_corner(ns_ladder *l);
/* The length of the steps at an event: h 2^-NS_EVENT_EXPONENT, or the next longer one that is visible in t.
 */
double ns_ladder_short_step(const ns_ladder *l);
/* The short steps of an event, or a start, begin; end, and if they showed a jump it is taken in their place.
 */
void ns_ladder_short_begin(ns_ladder *l);
int ns_ladder_short_commit(ns_ladder *l);
/* One implicit step of length h that resolves whatever breaks; such steps until the mode stays; rates freed
 * of their rounding (0: something happens right here); the event at the point resolved, to its right side. */
int ns_ladder_short_try(ns_ladder *l, double h);
int ns_ladder_short_settle(ns_ladder *l, double h);
int ns_ladder_short_rates(ns_ladder *l);
/* Short steps with the commands in point->flip changed, and the jump that they show.  *h: their length, which
 * may become longer; 0: it is chosen; changed: 0: no command and no input is, a guard broke. */
int ns_ladder_short_change(ns_ladder *l, double *h, int changed);
int ns_ladder_event_resolve(ns_ladder *l);
/* 1 if a switch with hysteresis that changed twice at an instant (crossed) and has to again (point->flip)
 * contradicts itself: l->contradiction is its pair. */
int ns_ladder_event_contradicts(ns_ladder *l);

#endif
