/* nonsmooth/march.h - integrates a system from one output time to the next: a marcher.
 *
 * An event is an instant at which a guard breaks, a control crosses its threshold, or a source commands a
 * switch.  Events of the first two kinds are located; instants of commands that depend on time only, and
 * corners of the inputs, are hit exactly.  At an event the mode that follows is found and the state made
 * consistent with it: charges and fluxes jump at the instant itself.  How, depends on the engine (Method, in
 * src/README.md).  Where events follow each other too closely, event-capturing steps of the scheme are taken
 * for a while.
 */
#ifndef NONSMOOTH_MARCH_H
#define NONSMOOTH_MARCH_H

#include "nonsmooth/theta.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ns_march ns_march;

/* The engine that integrates between events. */
typedef enum ns_method {
    NS_AUTO,  /* NS_SPARSE if the system is large or modes hardly recur, else NS_EXACT; another if it fails */
    NS_THETA, /* steps of the theta scheme, of at most h; see also `capture` */
    NS_EXACT, /* exact to rounding between events, by dense matrices kept for each mode */
    NS_SPARSE /* error of a step below reltol, by one sparse factorisation per mode; for large systems */
} ns_method;

typedef struct ns_march_options {
    double theta, gamma; /* theta in [0,1], gamma in (0,1] */
    double h;            /* longest step of the scheme, s, > 0 */
    size_t map_bytes;    /* bound on the memory of matrices and factors kept for modes; 0: a default */
    ns_method method;
    double reltol; /* NS_SPARSE: error of a step, relative to the largest charges and fluxes; 0: 1e-9 */
    /* NS_THETA with theta = gamma > 0: 1: no event is located; a guard that breaks in a step is resolved in
     * that step.  Systems of more than 1500 unknowns and pairs are always integrated like this. */
    int capture;
    /* 1: parts that share nothing but stiff sources are not integrated separately (with NS_THETA, and if
     * there are more than 64 of them, they never are). */
    int whole;
} ns_march_options;

/* Makes a marcher for s, which must outlive it and must not change.  On failure *out is NULL and *fault (may
 * be NULL; written on failure alone) has the status and, where one is known, the place.  Errors: those of
 * ns_theta_create(), RANGE (h, reltol), SIZE (more than 1500 unknowns and pairs with NS_EXACT, or with
 * NS_THETA where theta = 0 or theta differs from gamma). */
int ns_march_create(const ns_system *s, const ns_march_options *o, ns_march **out, ns_fault *fault);
void ns_march_free(ns_march *m); /* NULL is allowed */

/* Puts the accepted point at t0 (s).  w0 (n): M x(t0-), the charges and fluxes before.  Finds the consistent
 * state at t0: jumps are resolved with charge and flux conserved (if nothing jumps, the state is the one some
 * steps of h/2^20 later), and commands are set by their controls (between off and on: as their `closed`
 * says).  Errors: NULL, NUMBER, those of ns_theta_try(), LIMIT (controls that contradict their switches). */
int ns_march_start(ns_march *m, double t0, const double *w0);

/* The same where another marcher was: commanded switches that its mode (m, as ns_march_mode(); NULL: none)
 * has closed stay closed if their control is between off and on.  Errors: as ns_march_start(). */
int ns_march_start_as(ns_march *m, double t0, const double *w0, const ns_mode *mode);

/* Starts at the DC operating point at t0: M x' = 0, inputs at t0; then as ns_march_start() with its charges.
 * hold (nhold indices of x, values hold_x): unknowns forced, by whatever current it takes, while the
 * operating point is found (SPICE's .ic without uic: node voltages only).  x (n) may be NULL.
 * Errors: as ns_march_start(), SIZE, SINGULAR / INFEASIBLE (there is no operating point). */
int ns_march_start_dc(ns_march *m, double t0, int nhold, const int *hold, const double *hold_x, double *x);

/* Where a trial may end. */
typedef enum ns_until {
    NS_TO_TIME,  /* at the time asked for, through all events before it */
    NS_TO_EVENT, /* at the left side of the first event if one comes before; if the accepted point is the left
                    side of an event, at its right side */
    NS_TO_STEP   /* as NS_TO_EVENT, but it may end earlier: ns_march_sample() knows all between the accepted
                    point and its end.  There no input that is looked at (ns_march_look_at()) has a corner,
                    no event lies between. */
} ns_until;

/* Tries to integrate from the accepted point to time t (s, later than the accepted time).  *reached gets the
 * time at which the trial ended: later than the accepted time (equal to it: the right side of a jump), and at
 * most some steps of h/2^20 after t (two for each switch that changes at t).  The accepted point is
 * unchanged: try again with any t.  A second call that asks for the end of the last trial costs nothing.
 * Errors: NULL, RANGE (t), those of ns_theta_try(), LIMIT, CHATTER (not with NS_THETA: a switch without
 * hysteresis stays at its threshold, and another device changes with each of its switchings). */
int ns_march_try(ns_march *m, double t, ns_until until, double *reached);

/* What is looked at between events: looked (n+m: x, lambda) is not 0 there; NULL: all, as at first.  Trials
 * with NS_TO_STEP end at the corners of no input that only other unknowns follow, such as the gate of a
 * switch. Errors: NULL, MEMORY (inputs are as before, or all count). */
int ns_march_look_at(ns_march *m, const unsigned char *looked);

/* x (n), lambda (m) (either may be NULL) at time t, s: on the way of the last trial, which was made with
 * NS_TO_STEP and ended after the accepted time; accepted time <= t <= its end (at the accepted time: what
 * follows it, e.g. the right side of a corner; at the end: the left side of what is there).  The trial stays
 * as it is, ns_march_read() still reads its end.  Errors: NULL, STATE, RANGE, MEMORY, OVERFLOW. */
int ns_march_sample(ns_march *m, double t, double *x, double *lambda);

/* s: of the same trial, from time t on: nothing changes in less time than this by more than a small part of
 * itself (the fastest thing that has not died out at t; of a polynomial its length / 16; of a straight line
 * INFINITY; NAN: there is no such trial, or t is not on its way).  *until (may be NULL): the time until which
 * that holds, later than t, INFINITY: to the end.  A caller that looks at t + shortest, t + 2 shortest,
 * t + 4 shortest, ... has seen all. */
double ns_march_shortest(ns_march *m, double t, double *until);

/* Makes the last successful trial the accepted point.  Errors: STATE. */
int ns_march_accept(ns_march *m);

/* Replaces an input from the accepted time on (E in (S1), F in (S3), gz of commands): the trial is dropped,
 * and the next one begins with what the signal does there: it may jump (then the accepted point is the left
 * side of an event) or turn.  Both signals are NS_PWL, in the unit of the input (V or A; times in s); the
 * left value of the new one at the accepted time is that of the old one.  If the new one has ramps, the one
 * that the marcher was made with has to have one too, if long past: the exact engine has a state for its
 * slope or none.  The input of the system itself is replaced too (copies are made of the arrays): every other
 * marcher of that system is to be told the same way, before it goes on.  After MEMORY it has to be started
 * anew. Errors: NULL, SIZE, RANGE (kind, left value, ramps), those of ns_signal_check(), STATE (not started;
 * steps with `capture`), MEMORY. */
int ns_march_set_input(ns_march *m, int input, const ns_signal *signal);

/* A threshold that is watched: of the control x[p] - x[n] (-1: ground, zero), V or A. */
typedef struct ns_threshold {
    int p, n;
    double value; /* in the unit of the control */
    int above;    /* 1: the control is above it, 0: below */
    int includes; /* 1: the value itself counts as above, 0: as below; but for rounding */
} ns_threshold;

/* Watches so many thresholds (0: none), in place of those before.  A trial then ends at the first instant at
 * which a control comes to the other side of its threshold, and others that do so within the rounding of that
 * time are crossed with it; it is located by samples of the trial, so all trials are as with NS_TO_STEP and
 * may end earlier.  Nothing changes there in the system; what may follow is the caller's: once that point is
 * accepted, ns_march_try() is refused (STATE) until this is called again.  A start ends the watch.  A control
 * that is beyond already crosses at the accepted point.  Errors: NULL, SIZE, NUMBER, STATE (not started),
 * MEMORY, those of ns_march_read(). */
int ns_march_watch(ns_march *m, int count, const ns_threshold *threshold);

/* Which of them (count) are crossed at the point of the last trial, or at the accepted one: 1 each; NULL:
 * none is. */
const unsigned char *ns_march_crossed(const ns_march *m);

/* The point of the last successful trial, or the accepted one if none was made since: time, x (n),
 * lambda (m), y (m); any may be NULL.  Errors: STATE (not started), those of ns_theta_read(). */
int ns_march_read(ns_march *m, double *t, double *x, double *lambda, double *y);

/* What jumped in the same trial, which went from the left side of an event to its right side, or in the start
 * if no trial was made since: the integrals of x (n: V s, A s) and lambda (m) over that instant, (J1); all
 * zero where nothing jumps; either may be NULL.  Where the event took some steps of h/2^20 (ns_march_try()),
 * over these.  Not meant for trials with NS_TO_TIME, which may pass events or not count them.  Errors: NULL,
 * STATE (not started). */
int ns_march_impulse(ns_march *m, double *x, double *lambda);

/* The mode of the same point (m); owned by the marcher.  A switch that slides (holds its control at the
 * threshold) is NS_INSIDE, or 2 or 3 by the sign of its current. */
const ns_mode *ns_march_mode(const ns_march *m);

/* 1 if the point of the last trial is the left side of an event. */
int ns_march_at_event(const ns_march *m);

/* The engine that the marcher was made with or, with NS_AUTO, the one that made the last trial. */
ns_method ns_march_engine(const ns_march *m);

/* What was done since ns_march_create(), and the last call that failed, with its time t; both owned by the
 * marcher. */
const ns_counts *ns_march_counts(ns_march *m);
const ns_fault *ns_march_fault(const ns_march *m);

/* The problem (P1) at which the last call failed, as ns_theta_problem().  *h gets the length of the step (s),
 * or 0 for an operating point, whose problem has one more row for each unknown held: the current that holds
 * it. Call it right after the failure.  Errors: NULL, STATE (it did not fail, or not at a problem). */
int ns_march_problem(const ns_march *m, ns_mlcp *p, double *h);

#ifdef __cplusplus
}
#endif
#endif
