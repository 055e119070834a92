/* src/sparse/sparse_internal.h - the engine for large circuits from inside.
 *
 * Between events it takes steps by (E1), (E2) (laguerre.h): a step is at most NS_ORDER solves (one more where
 * an event is located) with one sparse factor of (P2), and gives every unknown and every guard at any time in
 * it.  Steps have the lengths h 2^-k, so that the same factors serve again, and end where a guard breaks, an
 * input has a corner or a command changes.
 */
#ifndef NS_SPARSE_INTERNAL_H
#define NS_SPARSE_INTERNAL_H

#include <math.h>

#include "engine/engine.h"
#include "engine/instant.h"
#include "events/crowd.h"
#include "factor_cache.h"
#include "inputs/input_stages.h"
#include "modes/laguerre.h"
#include "modes/shared_branch.h"
#include "output_only.h"
#include "sparse.h"
#include "theta_step.h"

enum { NS_STAGES = NS_ORDER + 1 }; /* the last one only where an event is located in the step */
/* Exponents k of lengths h 2^-k; those marked + count from h 2^-o.finer. */
enum {
    NS_SHORT_EXPONENT = 16, /* of the length of a step, shorter by this: negligible, for events */
    NS_LEAST_EXPONENT = 28, /* + the shortest step, */
    NS_STEEPEST = 16, /* + but for transients that are not over in it, and not so short that they jump */
    NS_EVENT_LEAST_EXPONENT = 26, /* + the shortest step that resolves an event */
    NS_FINER = 12,      /* of the step that makes w consistent: what lasts that short is a transient, */
    NS_FINEST = 26,     /* + unless it is shorter than this: then it jumps */
    NS_MOST_FINER = 24, /* the largest o.finer */
    NS_EXPONENTS = NS_LEAST_EXPONENT + NS_STEEPEST + NS_MOST_FINER + 1
};

/* How far from where it breaks an event may be located, in errors of a step: of w, and of guards. */
enum { NS_LOCATION_ERROR = 16 };

/* --- one step --- */

typedef struct ns_dense_step {
    /* time */
    double t, end_t;     /* it begins at t and ends at end_t, s */
    double length;       /* end_t - t before rounding, s */
    double time_lost;    /* what rounding took from t: powers[0] is w at t + time_lost, s */
    double g;            /* length of the Euler steps of its stages, s */
    int length_exponent; /* of its full length, h 2^-length_exponent */
    int next_exponent;   /* to be tried for the next step */
    double usual_length; /* a mean of the lengths of the last steps, s */
    /* what it is */
    int is_euler;    /* one implicit Euler step: only its end is known, by stage 0; of two stages: several of
                        them, stage 1 is where x, lambda come from on straight lines */
    int is_smooth;   /* of the theta scheme: the rates of the step before are known too */
    int after_event; /* it begins at an event */
    int stages;      /* how many are known */
    int shown;       /* and how many for points on the way of a trial: one more, once there was one */
    int converged;   /* D^i w vanish: nothing jumps, nothing stiff is excited */
    int resolved;    /* its error was found to be no more than allowed: nothing jumps */
    /* what ends it */
    int at_event;      /* an event ends it: */
    int pair, command; /* of this guard; -1: not of a pair, not of a command by the state */
    int guard;         /* which one of the pair's, as ns_mode_guards() has them */
    int failures;      /* steps in a row that ended where they began */
    int unchanged;     /* events in a row at the end of which no pair changed, up to where it begins */
    /* its polynomials */
    double *images; /* NS_STAGES (n+m): x, lambda of stage i */
    double *powers; /* (NS_STAGES+1) n: D^i w */
    double *z;      /* NS_STAGES nz: inputs of stage i */
    ns_mode *mode;  /* m */
} ns_dense_step;

/* A point in a step. */
typedef struct ns_sparse_point {
    ns_dense_step *step; /* one of the three */
    double tau;          /* how far into it, s */
    double t;            /* at which time, s */
} ns_sparse_point;

/* --- what is saved and restored together --- */

/* The largest charges, fluxes, lambda and y so far: rounding and errors are judged against them. */
typedef struct ns_sparse_largest {
    double *w;                      /* n */
    double lambda, y;               /* of steps as long as the present one, or longer */
    double lambda_of[NS_EXPONENTS]; /* of accepted steps, by their length exponent */
    double y_of[NS_EXPONENTS];      /* the same */
} ns_sparse_largest;

/* Changes counted to find chatter. */
typedef struct ns_sparse_chatter {
    ns_event_window *flips; /* m: changes of each pair */
    ns_event_window eulers; /* Euler steps */
} ns_sparse_chatter;

/* Where the resolution of an event begins. */
typedef struct ns_before_event {
    double *w;              /* n */
    ns_mode *mode;          /* m */
    unsigned char *changed; /* nc */
    ns_instant instant;
} ns_before_event;

/* --- predictions of modes (mode_prediction.c) --- */

enum { NS_PREDICTED_PAIRS = 6 };

/* Which other pairs changed when the same ones did before. */
typedef struct ns_mode_prediction {
    unsigned long long key;           /* of the pairs that the event changed itself; 0: empty */
    int count;                        /* other pairs that changed with them, -1: too many */
    int sure;                         /* it is to be tried */
    int failed;                       /* how often it was wrong */
    int pair[NS_PREDICTED_PAIRS];     /* which */
    ns_mode mode[NS_PREDICTED_PAIRS]; /* and to what */
} ns_mode_prediction;

typedef enum ns_prediction_kind {
    NS_NO_PREDICTION,
    NS_FIRST_PREDICTION,
    NS_LEARNT_PREDICTION
} ns_prediction_kind;

typedef struct ns_mode_predictions {
    ns_mode_prediction *table; /* by a hash */
    size_t places;             /* entries of table */
    ns_prediction_kind trying; /* a step is tried for a prediction: it stops when that turns out wrong */
    int has_tried; /* one was made to its end, and did not prove its mode: it may be the right one */
    int alone;     /* above zero: most often no other pair changed */
    int sought;    /* above zero: searches by long Euler steps succeed */
} ns_mode_predictions;

/* --- a transient that is passed (transient.c) --- */

typedef struct ns_sparse_transient {
    int runs;             /* Euler steps are those of a stretch: inputs are those at their ends */
    double *w[4];         /* n each: T11, T21, T31, T33 */
    double *v;            /* n+m: x, lambda of an Euler step, */
    double *middle, *end; /* of the middle of the last G, of its end */
    ns_mode *mode;        /* m: where the next G begins, */
    ns_mode *mode_middle; /* and in its middle */
} ns_sparse_transient;

/* --- the engine --- */

typedef struct ns_sparse {
    ns_engine engine;

    /* the system */
    const ns_system *s;          /* without the unknowns of output_only */
    ns_output_only *output_only; /* unknowns that are solved for only when read */
    ns_sparse_options o;         /* as given, defaults filled in */
    ns_form *f;                  /* its matrices */
    ns_mode_factors *q;          /* and their factors, by mode */
    ns_input_stages *in;         /* its inputs and commands of time */
    ns_shared_branch *shared;    /* pairs across switches */
    int shared_count;            /* entries of shared */
    int usual_finer;        /* o.finer, but right after a start, and after some jumps: of the finest then, */
    double finest_until;    /* until this, s */
    double inputs_shortest; /* s: ns_sparse_shortest() of inputs that no step looks at */
    double *unit;           /* n: the square root of the largest entry of row i of M */

    /* steps and points in them */
    ns_dense_step steps[3];   /* of the accepted point, of the trial, and one that is being made */
    ns_sparse_point accepted; /* the accepted point */
    ns_sparse_point trial;    /* the trial */
    int started, has_trial;   /* 1: there is an accepted point; there is a trial beyond it */
    double asked_t;           /* to where that trial was asked for, s */
    ns_until until;           /* and up to what */
    long steps_left;          /* until it is given up */
    ns_sparse_theta theta;    /* steps of the theta scheme */

    /* the state that the next step begins with */
    double *w;     /* n: charges and fluxes */
    ns_mode *mode; /* m; with it follow, by ns_sparse_mode_set_all(): */
    double *l, *u; /* m: bounds, of commanded pairs as commanded */

    /* an event */
    const ns_watch *watch;   /* who looks at it; NULL: nobody */
    unsigned char *touched;  /* m: pairs that changed in the search for a mode */
    unsigned char *flip;     /* m: 1 + which guard of a pair is broken; 0: none is */
    unsigned char *changed;  /* nc: 1 commands that changed at this event, 2 that begin to slide */
    double *apart;           /* nc: so far from its threshold one changed with the event */
    ns_mode *commanded_mode; /* m: after what the event itself changes, and nothing that follows from it */
    int is_near;             /* guards that are broken by what events are located to hold */
    double longest_g;        /* s: the first steps that were to resolve it; 0: no shorter ones are tried */
    double inputs_from;      /* s: an input was replaced then; -INFINITY: none was */
    int steep_steps;         /* so many in a row were shorter than h 2^-NS_LEAST_EXPONENT */
    int digits_lost;         /* 1: by the last step: solutions of the next one are corrected */
    int contradicting_pair;  /* the pair of a switch that can be neither open nor closed; -1: none */
    unsigned char *due;      /* nc: command_order.c */
    ns_before_event before_event;  /* where its resolution began */
    ns_instant instant;            /* what jumped in the trial, or in the start */
    ns_mode_predictions predict;   /* of its mode */
    ns_sparse_transient transient; /* after it */

    /* what errors and chatter are judged by */
    ns_sparse_largest largest, saved_largest;    /* so far; before a prediction was tried, */
    ns_sparse_largest tried_largest;             /* and after it */
    double *inverse_scale;                       /* n: 1 / scale of w_i in this step; 0: no charge, no flux */
    ns_sparse_chatter chatter, accepted_chatter; /* so far; at the accepted point */
    int chatter_changed;                         /* these two differ */

    /* right-hand sides, solutions: valid from the call that fills them to the next solve */
    double *r;    /* n+m: right-hand side of (P2) */
    double *rate; /* n: T (b + E z) of it */
    double *v;    /* n+m: x, lambda */
    double *z;    /* nz: inputs that v was solved with */

    /* scratch: nothing is kept there between calls of different files */
    struct {
        double *w, *rates;               /* n each */
        double *move;                    /* n: by how much a step moves w */
        double *before_w, *right_w;      /* n each: w before a jump, and after it */
        double *removed, *finer_removed; /* n each: what a jump takes from w; and by a shorter step */
        double *v, *residual;            /* n+m each */
        double *projected;               /* n+m: a solution that is refined, */
        long double *exact;              /* n+m: in more digits */
        double *no_inputs;               /* nz: zero */
        ns_mode *mode;                   /* m */
        ns_mode *lone_mode, *wanted;     /* m each: command_order.c */
        ns_mode *tried_mode;             /* m: where a search for a mode began */
        ns_mode *lcp_mode;               /* m: what (P1) answered */
        ns_mode *lasting_mode;           /* m: of a step that is longer than a transient */
    } work;

    /* watch.c: a point that is read while a trial is made, when the above is not to be touched */
    struct {
        double *v, *z; /* n+m; nz */
    } inside;

    /* what the caller sees */
    double searched;     /* instructions that (P1) took beside its pivots, as ns_mlcp_limit() counts them */
    ns_mode *shown_mode; /* m: of the trial, switches that slide count as closed */
    ns_counts counts;
    ns_fault fault;
} ns_sparse;

/* --- functions, by file; m: the engine, step: one of its steps, t, g: s --- */

/* What the table of the engine holds, as engine/engine.h says: create.c, start.c, engine.c, read.c,
 * instant.c, watch.c. */
void ns_sparse_free(ns_engine *e);
int ns_sparse_start(ns_engine *e, double t0, const double *w0, const unsigned char *closed);
int ns_sparse_start_dc(ns_engine *e, double t0, int nhold, const int *hold, const double *hold_x, double *x);
int ns_sparse_try(ns_engine *e, double t, ns_until until, double *reached);
void ns_sparse_drop(ns_engine *e);
int ns_sparse_accept(ns_engine *e);
int ns_sparse_at_event(const ns_engine *e);
int ns_sparse_set_input(ns_engine *e, int input, const ns_signal *signal);
int ns_sparse_read(ns_engine *e, double *t, double *x, double *lambda, double *y);
int ns_sparse_sample(ns_engine *e, double t, double *x, double *lambda);
double ns_sparse_shortest(ns_engine *e, double t, double *until);
double ns_sparse_bend(const ns_engine *e, int unknown);
const ns_mode *ns_sparse_mode(ns_engine *e);
const ns_counts *ns_sparse_counts(ns_engine *e);
ns_work ns_sparse_work(ns_engine *e);
const ns_fault *ns_sparse_fault(const ns_engine *e);
int ns_sparse_impulse(ns_engine *e, double *x, double *lambda);
int ns_sparse_peek(ns_engine *e, double *x, double *lambda);
void ns_sparse_watch(ns_engine *e, const ns_watch *w);

static inline ns_sparse *ns_sparse_of(ns_engine *e) {
    return (ns_sparse *)(void *)e;
}

/* engine.c */
int ns_sparse_fail(ns_sparse *m, double t, int status); /* keeps both in the fault; returns the status */
void ns_sparse_rewind(ns_sparse *m, double t0);         /* not started; all points at t0, */
int ns_sparse_first_step(ns_sparse *m); /* the step from there, by m->w and m->mode: started */

/* watch.c: the point of the trial while it is made, to m->watch if it wants it.  Errors: those of that. */
int ns_sparse_watch_show(ns_sparse *m, ns_watch_side side);

/* next_step.c: a step from m->w, m->mode at t, after the step `before` (NULL: the first). */
int ns_sparse_next_step(ns_sparse *m, double t, const ns_dense_step *before, ns_dense_step *step);
/* The same, where no mode was found: an implicit Euler step of a good part of the length. */
int ns_sparse_next_captured(ns_sparse *m, double t, const ns_dense_step *before, ns_dense_step *step);

/* The first corner, or change of a command by time, after t. */
double ns_sparse_next_limit(ns_sparse *m, double t);

/* transient.c: what it needs; 1 if a step resolves a fast transient, an event ends it, and the transient is
 * to be passed; the step that does so in place of that one, from m->w, m->mode at t, after the step `before`
 * (NULL: the first); 0: it stays. */
int ns_sparse_transient_create(ns_sparse *m); /* Errors: MEMORY */
void ns_sparse_transient_free(ns_sparse *m);
int ns_sparse_transient_is_due(const ns_sparse *m, const ns_dense_step *step);
/* 1 if it is to be passed because a step over it ends with currents of the wrong sign. */
int ns_sparse_transient_is_left(const ns_sparse *m, const ns_dense_step *step);
int ns_sparse_transient_pass(ns_sparse *m, double t, const ns_dense_step *before, ns_dense_step *step);

static inline int ns_sparse_least_exponent(const ns_sparse *m) {
    return NS_LEAST_EXPONENT + m->o.finer;
}

/* theta_step.c: what these steps need; steps from m->w, m->mode at t until `until`, of which `step` is the
 * last; x, lambda at tau in it. */
int ns_sparse_theta_create(ns_sparse *m);
void ns_sparse_theta_free(ns_sparse *m);
void ns_sparse_theta_stop(ns_sparse *m); /* the next one begins from m->w, m->mode anew */
int ns_sparse_theta_go(ns_sparse *m, double t, double until, ns_dense_step *step);
int ns_sparse_theta_point(ns_sparse *m, const ns_dense_step *step, double tau, double *v);

/* What making w consistent did: nothing but rounding; charges or fluxes jumped; nothing, because a transient
 * that lasts would be lost. */
typedef enum ns_jump_kind { NS_NO_JUMP, NS_JUMPS, NS_LASTS } ns_jump_kind;

/* project.c: m->w made consistent with m->mode by steps of length g; first (n): D w of the first one, if
 * known, else NULL. Errors: RESIDUAL (digits are lost). */
int ns_sparse_project_consistent(ns_sparse *m, double t, double g, const double *first, ns_jump_kind *jump);
/* 1 if charges and fluxes of this size are what rounding makes of rates in the time g, with v: a bridge that
 * carries nothing. */
int ns_sparse_project_is_rounding(const ns_sparse *m, double g, const double *v, double size);
static inline double ns_sparse_finest(const ns_sparse *m) {
    return ldexp(m->o.h, -NS_FINEST - m->o.finer);
}
/* 1 if the mode does not hold at the end of an Euler step of length g from w (n) at t. */
int ns_sparse_project_breaks(ns_sparse *m, double t, double g, const double *w);
/* The shortest steps are as short as they get, at t and for the usual shortest one after it. */
static inline void ns_sparse_be_finest(ns_sparse *m, double t) {
    m->o.finer = NS_MOST_FINER;
    m->finest_until = t + ldexp(m->o.h, -NS_EVENT_LEAST_EXPONENT - m->usual_finer);
}

/* instant.c: adds to `to` (n+m) the integrals over the jump that ns_sparse_project_consistent() made with
 * steps of length g.  Overwrites work.w, work.v.  Errors: MEMORY. */
int ns_sparse_instant_add(ns_sparse *m, double g, ns_instant *to);
/* The pair that could carry the impulse of that jump least, and by which of its guards; -1: all can (J4).
 * Overwrites work.v, work.projected, m->z.  Errors: MEMORY. */
int ns_sparse_instant_misfit(ns_sparse *m, double t, double g, int *pair, int *broken);
/* m->instant is kept with the event; is as kept. */
void ns_sparse_instant_save(ns_sparse *m);
void ns_sparse_instant_restore(ns_sparse *m);

/* chatter.c: counts from zero; counts as accepted, or back to the accepted ones. */
void ns_sparse_chatter_reset(ns_sparse *m);
void ns_sparse_chatter_accept(ns_sparse *m);
void ns_sparse_chatter_drop(ns_sparse *m);
/* The event at the end of a step, an Euler step of it.  Errors: LIMIT (too many within its length). */
int ns_sparse_chatter_event(ns_sparse *m, const ns_dense_step *step, double t);
int ns_sparse_chatter_euler(ns_sparse *m, const ns_dense_step *step, double t);

/* event_location.c: the first guard that breaks in a step ends it. */
int ns_sparse_location_first(ns_sparse *m, ns_dense_step *step);
/* 1 if the step does not resolve the guard of the pair that ends it: that is below zero there, by more than
 * all stages may leave. */
int ns_sparse_location_is_rough(const ns_sparse *m, const ns_dense_step *step);
/* 1 if, at the end of a step, command c has fallen to its threshold as well, but for what the instant may be
 * off by; *apart: how far it is from it. */
int ns_sparse_location_meets(const ns_sparse *m, const ns_dense_step *step, int c, double *apart);
/* 1 if the control of c is that of the command whose guard ended the step, all along it, but for a factor.
 * *apart: how far it is from its threshold there, where that is another one by rounding, as of a sign that
 * passes zero; 0 if the control may not go on to it within what counts as one instant. */
int ns_sparse_location_is_same(const ns_sparse *m, const ns_dense_step *step, int c, double *apart);

/* mode_prediction.c: the table, empty; nothing learnt. */
int ns_sparse_predict_create(ns_sparse *m); /* Errors: MEMORY */
void ns_sparse_predict_free(ns_sparse *m);
void ns_sparse_predict_reset(ns_sparse *m);
/* After ns_sparse_event_own_changes(): a step from t in the mode that events like this one led to before, or
 * that an Euler step as long as the last one finds.  0: none that holds, the mode is as it was. */
int ns_sparse_predict_step(ns_sparse *m, double t, const ns_dense_step *before, ns_dense_step *step);
/* 1 if that tried step is the one from m->w in m->mode after all: it need not be made again. */
int ns_sparse_predict_take(ns_sparse *m, double t, const ns_dense_step *step);
/* m->mode is what the event at the end of `step` led to. */
void ns_sparse_predict_learn(ns_sparse *m, const ns_dense_step *step);

/* event.c: 1 if an input jumps at t, or a command of time changes. */
int ns_sparse_event_at(const ns_sparse *m, double t);
/* Commands of time that change at t, or have to, do so. */
void ns_sparse_event_time_commands(ns_sparse *m, double t);
/* Keeps m->w, m->mode and the commands that changed; they are again as kept. */
void ns_sparse_event_save(ns_sparse *m);
void ns_sparse_event_restore(ns_sparse *m);
/* The guard that ended the step (NULL: a start) and commands of time change. */
void ns_sparse_event_own_changes(ns_sparse *m, const ns_dense_step *step, double t);
/* m->mode such that an Euler step of length g from w breaks no guard; v gets its end, by (n, or NULL) D w. */
int ns_sparse_event_consistent(ns_sparse *m, double t, double g, const double *w, double *v, double *by);
/* The same, and commands of the state with it. */
int ns_sparse_event_consistent_all(ns_sparse *m, double t, double g, const ns_dense_step *step, double *by);
/* command_order.c: after ns_sparse_event_own_changes(), from m->w: m->mode and m->w right of the event. */
int ns_sparse_event_resolve(ns_sparse *m, const ns_dense_step *step, double t);

/* local_lcp.c: as ns_sparse_event_consistent(), by (P1) of the pairs touched so far and those it breaks. */
int ns_sparse_local_lcp(ns_sparse *m, double t, double g, const double *w, double *v, double *by);

#endif
