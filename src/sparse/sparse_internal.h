/* src/sparse/sparse_internal.h - the marcher for large circuits from inside.
 *
 * Between events it goes by (E1), (E2) (laguerre.h): a leg is NS_ORDER solves with one sparse factor of (P2),
 * and gives every unknown and guard at any time in it.  Legs have the lengths h 2^-k, so that factors recur,
 * and end where a guard breaks, an input turns or a command changes.
 */
#ifndef NS_SPARSE_INTERNAL_H
#define NS_SPARSE_INTERNAL_H

#include <math.h>

#include "factor_cache.h"
#include "inputs/input_stages.h"
#include "modes/laguerre.h"
#include "modes/shared_branch.h"
#include "output_only.h"
#include "sparse.h"
#include "theta_step.h"

enum { NS_STAGES = NS_ORDER + 1 }; /* the last one only where a leg is looked into */
enum {
    NS_SHORT_RUNG = 16,
    NS_LEAST_RUNG = 28,
    NS_EVENT_LEAST = 26,
    NS_CROWD_OF_PAIR = 1000, /* flips of a pair in the time of a leg that are chatter, */
    NS_MOST_EULERS = 64,     /* or Euler steps */
    NS_STUCK = 6,
    NS_FINER = 12,  /* steps in which a transient lasts that is gone after longer ones, */
    NS_FINEST = 26, /* down to which it is one */
    NS_MOST_FINER = 6,
    NS_RUNGS = NS_LEAST_RUNG + NS_MOST_FINER + 1,
    NS_CAPTURE_FIRST = 14
};

typedef enum ns_leg_end { NS_LEG_GOES_ON, NS_LEG_EVENT } ns_leg_end;

typedef struct ns_dense_step {
    double t, end_t;     /* it holds from t to end_t, */
    double end;          /* which is so much later */
    double time_lost;    /* what t lost in rounding: w is of t + time_lost */
    double g;            /* Euler steps of its stages */
    int rung, next_rung; /* of its length; to try after it */
    int stages;          /* of xi that are known */
    int calm;            /* D^i w vanish: nothing jumps, nothing stiff is there */
    ns_leg_end why;
    int pair, command; /* what breaks at the end, -1: none */
    int upper;         /* the upper bound of that pair's lambda did */
    double usual;      /* how long legs were of late */
    int stuck;         /* legs in a row that ended at once */
    int euler;         /* an implicit Euler step; only its end is known, by stage 0 */
    int smooth;        /* of the scheme: the rates of the step before are known too */
    double *xi;        /* NS_STAGES (n+m) */
    double *dw;        /* (NS_STAGES+1) n: D^i w */
    double *z;         /* NS_STAGES nz */
    ns_mode *mode;     /* m */
} ns_dense_step;

enum { NS_GUESS_PAIRS = 6, NS_NO_GUESS = 0, NS_FIRST_GUESS, NS_LEARNT_GUESS };

/* What else changed when it did the last time. */
typedef struct ns_mode_prediction {
    unsigned long long key;  /* of what changed by itself */
    int count, sure, failed; /* -1: too many; it is to be tried; it was in vain so often */
    int pair[NS_GUESS_PAIRS];
    ns_mode mode[NS_GUESS_PAIRS];
} ns_mode_prediction;

struct ns_sparse {
    ns_engine engine;   /* table.c */
    const ns_system *s; /* what stays of the whole */
    ns_output_only *aside;
    ns_sparse_options o;
    ns_form *f;
    ns_mode_factors *q;
    ns_input_stages *in;
    ns_dense_step leg[3], *live, *kept;
    double live_tau, kept_tau;                      /* how far into them, */
    double live_t, kept_t;                          /* at which times */
    double *l, *u;                                  /* m, commanded pairs as commanded */
    ns_mode *mode;                                  /* m: of what comes next */
    unsigned char *flip;                            /* m */
    unsigned char *touched;                         /* m: pairs that changed while a mode is looked for */
    unsigned char *changed;                         /* nc: commands that changed at this event */
    unsigned char *event_changed;                   /* nc: at the left of an event */
    double *w, *next_w;                             /* n */
    double *before_w, *right_w, *gone, *finer_gone; /* n: while a jump is looked for */
    double *event_w;                                /* n: at the left of an event */
    ns_mode *event_mode;                            /* m: asked for there, before anything is settled */
    double *scale, *unit; /* 3 n: the largest w there were, and work; n: of one M alone, the square root */
    double *share;        /* n: 1 / scale of a leg, 0 where nothing is */
    double most_lambda, most_y; /* the largest there were: of legs as long as this one or longer, */
    double lambda_of[NS_RUNGS], y_of[NS_RUNGS];             /* of legs that were gone, by rung */
    ns_mode *old_mode, *shown;                              /* m; m: what slides counts as closed */
    ns_mode *own_mode;                                      /* m: after what an event changes by itself */
    ns_mode_prediction *guess;                              /* by a hash: */
    size_t guesses;                                         /* so many places */
    int guessing, alone;                                    /* NS_..._GUESS is tried; first ones pay */
    int sought;                                             /* above zero: looking for them pays, too */
    double *kept_scale, kept_most[2], kept_of[2][NS_RUNGS]; /* n: before it */
    double *crowd_t;                                        /* 2 m: since when flips of a pair are counted, */
    int *crowd;                   /* 2 m: how many there were; then both as they were accepted */
    double euler_t, kept_euler_t; /* since when Euler steps are counted, */
    int eulers, kept_eulers;      /* how many there were; and as accepted */
    int crowd_moved;              /* they are no longer as accepted */
    int contradicted;             /* at an event: the pair of a switch that has no state to be in; -1 */
    double *v, *r, *rate;         /* size, size, n */
    double *next_v, *rest;        /* size */
    long double *fine;            /* size */
    double *fine_v;               /* size */
    double *z, *z_none;           /* nz */
    ns_shared_branch *twin;       /* pairs across switches, */
    int twins;                    /* so many */
    ns_sparse_theta scheme;
    int started, has_trial;
    double asked;
    ns_until until;
    long budget;
    ns_counts counts;
    ns_fault fault;
};

/* sparse/engine.c: keeps status and time in the fault; returns the status. */
int ns_sparse_fail(ns_sparse *m, double t, int status);
/* next_step.c: a leg from m->w, m->mode at t, after one (NULL: the first) that ended there; the same where no
 * mode is found in no time: an implicit Euler step that takes a while may find one. */
int ns_sparse_capture(ns_sparse *m, double t, const ns_dense_step *before, ns_dense_step *leg);
int ns_sparse_next_step(ns_sparse *m, double t, const ns_dense_step *before, ns_dense_step *leg);

/* step_control.c: a leg from w, mode at t, no later than limit, with the first event in it. */
int ns_sparse_step_begin(ns_sparse *m, ns_dense_step *leg, double t, double limit);

/* step_kernel.c: stage i of a leg; one stage more, if it has not all yet; E2 and E1 at tau. */
int ns_sparse_step_stage(ns_sparse *m, ns_dense_step *leg, const ns_kept_factors *k, int i);
int ns_sparse_step_more(ns_sparse *m, ns_dense_step *leg);
/* time_lost at the end of a leg: legs of one length round t off in the same way each time, which would add
 * up.
 */
double ns_sparse_step_past(const ns_dense_step *leg);
/* sum (size) += what the stages there are leave of (P2), solved for: what rounding did to them, or may. */
int ns_sparse_step_residue(ns_sparse *m, const ns_dense_step *leg, double *sum);
void ns_sparse_step_state(const ns_sparse *m, const ns_dense_step *leg, double tau, double *w);
void ns_sparse_step_point(const ns_sparse *m, const ns_dense_step *leg, double tau, double *v);

/* One implicit Euler step of length g from w (n) in m->mode at t to v (size); by (n, or NULL) gets what w
 * moves. */
int ns_sparse_euler(ns_sparse *m, double t, double g, const double *w, int brief, double *v, double *by);

/* Stage i of steps of length g from t: v (size) from D^i w, inputs z (nz) and a factor of m->mode, and by (n)
 * = D^(i+1) w.  Its right-hand side stays in m->r. */
int ns_sparse_step_solve(ns_sparse *m, const ns_kept_factors *k, double t, double g, int i, const double *w,
                         double *z, double *v, double *by);

static inline int ns_sparse_least_length(const ns_sparse *m) {
    return NS_LEAST_RUNG + m->o.finer;
}

/* The right-hand side of (P2) from w (n; NULL: zero) and inputs z (any: not all are zero), to m->r;
 * constants: 1 with what is constant. */
void ns_sparse_step_rhs(ns_sparse *m, double g, const double *w, const double *z, int any, int constants);

/* theta_step.c: what its steps need; steps from m->w, m->mode at t until `until`, the last one to leg; x,
 * lambda at tau in a leg of them. */
int ns_sparse_theta_create(ns_sparse *m);
void ns_sparse_theta_free(ns_sparse *m);
int ns_sparse_theta_go(ns_sparse *m, double t, double until, ns_dense_step *leg);
int ns_sparse_theta_point(ns_sparse *m, const ns_dense_step *leg, double tau, double *v);

static inline double ns_sparse_finest(const ns_sparse *m) {
    return ldexp(m->o.h, -NS_FINEST - m->o.finer);
}

/* What making charges and fluxes consistent has done to them: nothing but rounding; made them jump; nothing
 * yet, for it would take away what lasts, if shortly. */
typedef enum ns_jump_kind { NS_NO_JUMP, NS_JUMPS, NS_LASTS } ns_jump_kind;

/* project.c: the largest charge or flux there is or was, in units; m->w made consistent with m->mode by
 * steps of length g, of which first (n) is what the first one moves, if that is known (else NULL): what is
 * faster goes.  Errors: RESIDUAL (digits are lost). */
double ns_sparse_project_size(const ns_sparse *m);
int ns_sparse_project_consistent(ns_sparse *m, double t, double g, const double *first, ns_jump_kind *jump);
/* All charges and fluxes, of this size, are what rounding makes of rates in the time g, with v: a bridge at
 * rest. */
int ns_sparse_project_is_rounding(const ns_sparse *m, double g, const double *v, double size);

/* sparse/shared_branch.c: as ns_modes_shared_find() (shared_branch.h). */
int ns_sparse_shared_find(const ns_system *s, const ns_form *f, ns_shared_branch **out, int *count);

/* sparse/guards.c: bounds of commanded pairs, and of their twins, as m->mode has them; the first event of a
 * leg; which guards are broken at v after a step g from w: flips them in m->mode and marks them touched,
 * returns how many; state-dependent commands that v contradicts: flips them, or, those that had changed at
 * this event already (changed, nc, or NULL), lets them slide, from the mode of the leg before it. */
void ns_sparse_guard_bounds(ns_sparse *m);
/* How large lambda and y are at v, into what they were at most, which stays once the leg is gone; whether
 * those of the last of p stages are so small beside that, that no further ones are needed. */
void ns_sparse_guard_sizes(ns_sparse *m, const double *v, int rung);
void ns_sparse_guard_keep_sizes(ns_sparse *m, int rung);
int ns_sparse_guard_enough(const ns_sparse *m, const ns_dense_step *leg, int p);
int ns_sparse_guard_first(ns_sparse *m, ns_dense_step *leg);
int ns_sparse_guard_broken(ns_sparse *m, const double *v, const double *w, double g,
                           int brief); /* only marks them in m->flip */
int ns_sparse_guard_flip(ns_sparse *m, const double *v, const double *w, double g, int brief);
int ns_sparse_guard_commands(ns_sparse *m, const double *v, const ns_dense_step *leg, unsigned char *changed);
void ns_sparse_guard_set(ns_sparse *m, int j, int upper); /* flips one pair */
int ns_sparse_guard_holds(const ns_sparse *m, int j,
                          const double *v); /* pair j keeps its law to the last bit */

/* Whether all guards hold at the start of a leg, but for rounding, what later stages would add, and share of
 * the largest lambda and y. */
int ns_sparse_guard_starts(ns_sparse *m, const ns_dense_step *leg, double share);

/* mode_prediction.c: after ns_sparse_event_own(), a leg from t in the mode that events like this led to
 * before, or that a step of its length finds; 0: none that holds, the mode is as it was.  From an event that
 * was resolved. */
int ns_sparse_predict_step(ns_sparse *m, double t, const ns_dense_step *before, ns_dense_step *leg);
void ns_sparse_predict_learn(ns_sparse *m, const ns_dense_step *leg);

/* sparse/event.c: commands of time change that do so at t, or have to; m->mode such that an Euler step of
 * length g from w holds; v gets its end. */
int ns_sparse_event_consistent(ns_sparse *m, double t, double g, const double *w, double *v, double *by);
/* local_lcp.c: the same by (P1) of the pairs touched so far, and of those that it breaks. */
int ns_sparse_event_local(ns_sparse *m, double t, double g, const double *w, double *v, double *by);
/* The same, and commands of the state settled with it. */
int ns_sparse_event_consistent_all(ns_sparse *m, double t, double g, const ns_dense_step *leg, double *by);
void ns_sparse_event_command(ns_sparse *m, double t);
/* An input jumps at t, or a command of time changes. */
int ns_sparse_event_at(const ns_sparse *m, double t);
/* What is counted of flips is accepted (keep), or goes back to what was. */
void ns_sparse_event_crowd(ns_sparse *m, int keep);
/* A pair that changes all the time in the time of a leg chatters: LIMIT. */
int ns_sparse_event_count(ns_sparse *m, const ns_dense_step *leg, double t);
/* What the leg that ended (NULL: a start) ended for, and commands of time, change. */
void ns_sparse_event_own(ns_sparse *m, const ns_dense_step *leg, double t);
/* The event at the end of a leg, from m->w, after ns_sparse_event_own(): m->mode and m->w to its right.  leg
 * NULL: a start. */
int ns_sparse_resolve(ns_sparse *m, const ns_dense_step *leg, double t);

#endif
