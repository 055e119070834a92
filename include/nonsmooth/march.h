/* nonsmooth/march.h - many theta steps: the way from one output time to the next.
 *
 * Steps have the lengths h, h/2, h/4, ... (a ladder), so that their maps recur.  A natural commutation
 * (a guard that breaks, a control that crosses) is located by walking down the ladder; the instants of
 * commands that depend on time only and the corners of the inputs are hit exactly.  At an event (P1) is
 * solved once over a step of negligible length with theta = gamma = 1; where the state jumps, the impulse
 * problem (impulse.h) in no time at all.
 * Where events crowd, plain event-capturing steps take over for a while.
 */
#ifndef NONSMOOTH_MARCH_H
#define NONSMOOTH_MARCH_H

#include "nonsmooth/theta.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ns_march ns_march;

/* What goes the way between events. */
typedef enum ns_method {
    NS_AUTO,  /* exact or sparse, by size and by what was seen; the scheme where events crowd */
    NS_THETA, /* steps of the scheme, the documents' own, of one length; see also `capture` */
    NS_EXACT, /* exact, by matrices of each mode that are kept; the scheme where events crowd */
    NS_SPARSE /* exact to reltol, by one sparse factor a mode; for thousands of unknowns */
} ns_method;

typedef struct ns_march_options {
    double theta, gamma; /* theta in [0,1], gamma in (0,1] */
    double h;            /* longest step of the scheme, s, > 0 */
    size_t map_bytes;    /* bound on what is kept of modes; 0: some default */
    ns_method method;
    double reltol; /* of NS_SPARSE: error of a step beside the largest charges and fluxes so far; 0: 1e-9 */
    int capture;   /* of NS_THETA with theta = gamma > 0: 1: no event is located, what breaks in a step is
                      resolved in it; so are systems of more than 1500 unknowns and pairs always */
    int whole;     /* 1: islands (parts that share nothing but stiff sources) are not taken apart; nor are
                      they with NS_THETA, or where there are more than 64 of them */
} ns_march_options;

/* Makes a marcher for s, which must outlive it and not change.  On failure *out is NULL and fault (may
 * be NULL) says where.  NS_AUTO takes NS_SPARSE for a system that is large (system.h).  Errors: those of
 * ns_theta_create(), RANGE (h, reltol), SIZE (more than 1500 unknowns and pairs, and another method). */
int ns_march_create(const ns_system *s, const ns_march_options *o, ns_march **out, ns_fault *fault);
void ns_march_free(ns_march *m);

/* Puts the accepted point at t0: from w0 = M x(t0-) (n) the consistent state at t0 is found, jumps
 * resolved (charge and flux conserved; if nothing jumps, that is some steps of h/2^20 later), commands set by
 * their controls (between off and on: open).  Errors: NULL, NUMBER, those of ns_theta_try(), LIMIT (controls
 * that contradict their switches). */
int ns_march_start(ns_march *m, double t0, const double *w0);

/* The DC operating point at t0: M x' = 0, inputs at t0; then as ns_march_start() with its charges.
 * hold (nhold indices of x, values hold_x): unknowns forced, by whatever current it takes, while the
 * operating point is found (SPICE's .ic without uic: node voltages only).  x (n) may be NULL.
 * Errors: as ns_march_start(), SIZE, SINGULAR / INFEASIBLE (there is no operating point). */
int ns_march_start_dc(ns_march *m, double t0, int nhold, const int *hold, const double *hold_x, double *x);

/* Where a trial may end. */
typedef enum ns_until {
    NS_TO_TIME, /* at the time asked for, through all events before it */
    NS_TO_EVENT /* at the left side of the first event if one comes before; if the accepted point is the left
                   side of an event, at its right side */
} ns_until;

/* Tries the way from the accepted point to time t (> the accepted time).  *reached gets where the trial
 * ended: later than the accepted time (at that time: the right side of a jump), and at most some steps of
 * h/2^20 beyond t (two for each switch that an event at t makes switch).  The accepted point is left alone:
 * try again with any t.  A second call that asks for the end of the last trial costs nothing.  Errors: NULL,
 * RANGE (t), those of ns_theta_try(), LIMIT. */
int ns_march_try(ns_march *m, double t, ns_until until, double *reached);

/* Makes the last successful trial the accepted point.  Errors: STATE. */
int ns_march_accept(ns_march *m);

/* The point of the last successful trial, or the accepted one if none was made since: time, x (n),
 * lambda (m), y (m); any may be NULL.  Errors: STATE (not started), those of ns_theta_read(). */
int ns_march_read(ns_march *m, double *t, double *x, double *lambda, double *y);

/* The mode of the same point (m); library-owned.  A switch that slides (holds its control at the threshold)
 * is inside, or 2 or 3 by the sign of its current. */
const ns_mode *ns_march_mode(const ns_march *m);

/* 1 if the point of the last trial is the left side of an event. */
int ns_march_at_event(const ns_march *m);

/* The engine that the marcher was made with or, of NS_AUTO, that went the last way: never NS_AUTO itself. */
ns_method ns_march_engine(const ns_march *m);

const ns_counts *ns_march_counts(ns_march *m);
const ns_fault *ns_march_fault(const ns_march *m); /* of the last call that failed; its t is set */

/* The problem at which the last call failed, as ns_theta_problem(); *h gets 0 where that was the operating
 * point, whose problem has one more row for each unknown that is held, for the current that does it.  To be
 * asked for right after the failure.  Errors: NULL, STATE (it did not fail, or not at a problem). */
int ns_march_problem(const ns_march *m, ns_mlcp *p, double *h);

#ifdef __cplusplus
}
#endif
#endif
