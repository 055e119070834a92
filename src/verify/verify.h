/* src/verify/verify.h - judges what an engine answers, by the system's own equations alone.
 *
 * Nothing here is shared with an engine: matrices are those of the system, row by row; inputs are evaluated
 * at the time itself; a pair is judged by its law (S4), not by the mode that the engine believes in.
 *
 * Every error is measured as a multiple of what rounding and the error control of the engines leave, of the
 * largest values of all points seen so far.
 */
#ifndef NS_VERIFY_H
#define NS_VERIFY_H

#include "nonsmooth/system.h"

typedef struct ns_verify ns_verify;

/* What is wrong. */
typedef enum ns_verify_cause {
    NS_VERIFY_RIGHT,   /* nothing, or what may be rounding */
    NS_VERIFY_NUMBER,  /* a number that is not finite, or so large that no digit of others is left */
    NS_VERIFY_ROW,     /* an algebraic row of (S1): a law of Kirchhoff or of an element */
    NS_VERIFY_OUTPUT,  /* y is not that of (S3) */
    NS_VERIFY_LAW,     /* (S4) of a pair */
    NS_VERIFY_COMMAND, /* a switch is open or closed against its control */
    NS_VERIFY_JUMP,    /* charges or fluxes jump, and no impulse explains it (J1), (J2) */
    NS_VERIFY_IMPULSE, /* the impulse of a pair is not one that it can carry (J4) */
    NS_VERIFY_ENERGY,  /* energy grows in a jump that no source has a part in */
    NS_VERIFY_CHATTER, /* a switch slides, and another device changes with it (found by its caller) */
    NS_VERIFY_FLOW     /* charges or fluxes are not the integral of what charges them, a row of (S1) */
} ns_verify_cause;

/* Of an error: above 1 it is more than a right answer should have, and may be rounding; above this many it is
 * wrong.
 */
static const double ns_verify_wrong = 10;

/* Instants so many units of eps apart can be told apart. */
static const double ns_verify_roundings = 64;

/* The worst that was found. */
typedef struct ns_verify_finding {
    ns_verify_cause cause;
    int pair, unknown; /* which; -1: none; unknown: also the row of that index */
    double t;          /* s */
    double error;      /* of what is allowed */
} ns_verify_finding;

/* What decays has died out after so many times as long. */
static const double ns_verify_dies_out = 40;

/* What engines may be off by. */
typedef struct ns_verify_options {
    double reltol;    /* errors of a step, of charges and fluxes */
    double instant;   /* s: the time that an event may take whose two sides have different times */
    double transient; /* s: what decays as fast as this is part of a jump */
} ns_verify_options;

/* A point: x (n), lambda (m), y (m; NULL: not shown).  is_some: 1: of x only the unknowns that charges and
 * devices depend on. */
typedef struct ns_verify_state {
    double t;
    ns_side side; /* of the inputs */
    const double *x, *lambda, *y;
    int is_some;
} ns_verify_state;

/* For s, which must outlive it.  Errors: MEMORY. */
int ns_verify_create(const ns_system *s, const ns_verify_options *o, ns_verify **out);
void ns_verify_free(ns_verify *v); /* NULL is allowed */

/* No point was seen yet. */
void ns_verify_reset(ns_verify *v);
/* An input of the system was replaced. */
void ns_verify_renew(ns_verify *v);

/* All may be off by so many times as much, 1 at first; an event may take so long, a jump holds what decays so
 * fast (s). */
void ns_verify_scale(ns_verify *v, double times, double instant, double transient);
/* For how long, s, lambda of a pair carries less than what the charges and fluxes that it flows into may be
 * off by, and no longer than 64 times what an event may take; 0: it flows into none. */
double ns_verify_excusable(ns_verify *v, int pair, const ns_verify_state *at);
/* At t this pair is not judged by (S4): how far it is off lasts no longer than that, or than the rounding of
 * the time. */
void ns_verify_excuse(ns_verify *v, double t, int pair);
/* 1: lambda and y of a pair have gone, at the second of three points, up to half their way from the first to
 * the third. */
int ns_verify_is_gradual(ns_verify *v, int pair, const ns_verify_state at[3]);
/* From now on what was found may be off by ns_verify_wrong times as much. */
void ns_verify_allow(ns_verify *v, const ns_verify_finding *f);

/* What one point takes, in numbers multiplied. */
double ns_verify_effort(const ns_verify *v);

/* What is wrong, as a constant string. */
const char *ns_verify_text(ns_verify_cause cause);

/* Each of the following returns 0 if something is wrong, which *worst says. */

/* (S1), algebraic rows; (S2) to (S4); commands. */
int ns_verify_point(ns_verify *v, const ns_verify_state *at, ns_verify_finding *worst);

/* Of the point that was judged last: 1 if pair j is a switch without hysteresis that is neither open nor
 * closed: it slides.  How many do.  What lambda or y of pair j, or its control, may be off by. */
int ns_verify_slides(const ns_verify *v, int j);
int ns_verify_slidings(const ns_verify *v);
double ns_verify_off_lambda(const ns_verify *v, int j);
double ns_verify_off_y(const ns_verify *v, int j);
double ns_verify_off_control(const ns_verify *v, int j);

/* The largest terms that charge or flux i had. */
double ns_verify_most_charge(const ns_verify *v, int i);

/* The same in a hurry, by what was learnt from points before; nothing is learnt.  x: at least the unknowns
 * that devices and charges depend on.  0: it may be wrong, or not. */
int ns_verify_quick_point(ns_verify *v, const ns_verify_state *at);
/* The left side of an event, which is not judged; */
void ns_verify_quick_left(ns_verify *v, const ns_verify_state *at);
/* and from there to the last point nothing jumps, and no switch with hysteresis changes beside its threshold.
 */
int ns_verify_quick_stays(ns_verify *v);
/* 1 if what jumped by Lambda (m) less `before` (m, or NULL) goes through no diode backwards. */
int ns_verify_quick_directions(const ns_verify *v, const double *Lambda, const double *before);
/* 1 if no diode has an impulse of the wrong sign in X (n), Lambda (m), by more than 1e-6 of the energy at the
 * last point: the charge through it and the flux across it are at least zero.  That holds for sums over
 * several jumps, too: no left side is needed. */
int ns_verify_quick_impulses(ns_verify *v, const double *X, const double *Lambda);
/* That left side in full, as the left side of an event. */
int ns_verify_left_in_full(ns_verify *v, ns_verify_finding *worst);

/* The point judged last is the left side of an event. */
void ns_verify_left(ns_verify *v);
/* A start: in place of a left side, charges and fluxes w (n) at t (s). */
void ns_verify_left_charges(ns_verify *v, double t, const double *w);
/* and switches that are closed before (nc; NULL: as their commands say). */
void ns_verify_start_switches(ns_verify *v, double t, const unsigned char *closed);
/* Judges the event from that left side to the point judged last, with impulses X (n), Lambda (m) as
 * ns_march_impulse(). */
int ns_verify_event(ns_verify *v, const double *X, const double *Lambda, ns_verify_finding *worst);

/* The point judged last, in a step that takes no time after that left side (at most 1024 roundings of it;
 * else 1).  0: its numbers are so much larger that no digit is left of what was there. */
int ns_verify_keeps_digits(ns_verify *v, ns_verify_finding *worst);

/* A step of the theta scheme, from one point to the other, neither of which is judged. */
int ns_verify_step(ns_verify *v, const ns_verify_state *from, const ns_verify_state *to,
                   ns_verify_finding *worst);

/* An operating point x (n), from whose charges the point that was judged last started: it has what unknowns
 * were to be held at; where none was, no source moves and
 * no switch depends on the state, nothing charges anything at that point. */
int ns_verify_operating_point(ns_verify *v, const double *x, int nhold, const int *hold, const double *hold_x,
                              ns_verify_finding *worst);

/* Points at which a way between events is looked at: times from a to b, the first is a, the last b. */
enum { NS_VERIFY_NODES = 5 };
void ns_verify_flow_times(double a, double b, double *t);
/* The points at these times, which are judged as points too, and the integrals between.  xl: NS_VERIFY_NODES
 * times x (n), lambda (m). */
int ns_verify_flow(ns_verify *v, const double *t, const double *xl, ns_verify_finding *worst);

#endif
