/* src/ladder/ladder.h - the theta scheme by steps h, h/2, h/4, ...: locates what breaks, and resolves it.
 *
 * It works on the point and the stepper of a dense run (engine/dense_point.h), which outlive it.
 */
#ifndef NS_LADDER_H
#define NS_LADDER_H

#include "engine/dense_point.h"
#include "nonsmooth/march.h"

typedef struct ns_ladder ns_ladder;

/* h: longest step, s.  Errors: MEMORY. */
int ns_ladder_create(ns_theta *step, ns_dense_point *point, double h, ns_ladder **out);
void ns_ladder_free(ns_ladder *l);

/* An input of the system was replaced at the point, where that begins to count.  If it jumps there, or
 * switches a command, the point is the left side of an event.  Errors: MEMORY. */
int ns_ladder_set_input(ns_ladder *l, int input);

/* A trial begins, which may take as many steps as its length dt (s) allows; it is accepted; it is dropped. */
void ns_ladder_begin_trial(ns_ladder *l, double dt);
void ns_ladder_accept(ns_ladder *l);
void ns_ladder_drop(ns_ladder *l);

/* What ends a part of a trial. */
typedef struct ns_ladder_stop {
    double t;          /* the trial: not beyond this, s, */
    ns_until until;    /* nor beyond an event, */
    int from_event;    /* which it began at; */
    double accepted_t; /* and where it began, s */
    double interrupt;  /* another engine takes over here if that is later than now, s */
} ns_ladder_stop;

/* From the point to the next thing that happens: a corner of an input, an event, its right side if the point
 * is the left side of one, or stop.  *done: the trial ends here.  Errors: those of ns_theta_try(), LIMIT. */
int ns_ladder_go(ns_ladder *l, const ns_ladder_stop *stop, int *done);

/* A start at t0 from charges and fluxes w0 (n): commanded switches as in closed (nc; NULL: open) but for
 * those that a function of time changes.  Errors: NULL, NUMBER. */
int ns_ladder_start(ns_ladder *l, double t0, const double *w0, const unsigned char *closed);
/* The same start again, with the switches as ns_ladder_toggle() left them, in the mode guess (m; NULL: none)
 * but for these. */
int ns_ladder_restart(ns_ladder *l, double t0, const double *w0, ns_mode *guess);
/* The consistent point there, by short steps and the impulse problem. */
int ns_ladder_find_consistent(ns_ladder *l);
/* Switches that the state contradicts change; returns how many. */
int ns_ladder_toggle(ns_ladder *l);
/* 0 if a switch with hysteresis contradicts itself: LIMIT.  Else rates are found, and no switch is about to
 * change. */
int ns_ladder_end_start(ns_ladder *l);
/* The operating point at t0, x (n) and mode (m): see ns_march_start_dc(). */
int ns_ladder_operating_point(ns_ladder *l, double t0, int nhold, const int *hold, const double *hold_x,
                              double *x, ns_mode *mode);

/* The pair whose switch contradicted itself when the last call failed with LIMIT, else -1. */
int ns_ladder_contradiction(const ns_ladder *l);
/* Adds to counts: events resolved, jumps taken, and jumps that the impulse problem had no answer for, so far.
 */
void ns_ladder_counts(const ns_ladder *l, ns_counts *counts);

#endif
