/* src/exact/exact.h - the exact engine: exact between events, by matrices of each mode that are kept (E1),
 * (E2).
 *
 * It works on the point and the stepper of a dense run (engine/dense_point.h), which outlive it.
 */
#ifndef NS_EXACT_H
#define NS_EXACT_H

#include "engine/dense_point.h"
#include "engine/engine.h"
#include "engine/kernel.h"
#include "engine/watch.h"

typedef struct ns_exact ns_exact;

/* h: longest step of the ladder, s; times below h/2^20 count as simultaneous.  Kept matrices may take as much
 * memory as the stepper's maps.  Errors: MEMORY. */
int ns_exact_create(ns_theta *step, ns_dense_point *point, double h, ns_exact **out);
void ns_exact_free(ns_exact *f);

/* From the point, accepted at accepted_t, to t, or with NS_TO_EVENT to the left side of the first event, with
 * NS_TO_STEP to that of the first instant known ahead too, as far as it can: it stops before what it cannot
 * resolve, and another engine has to go on until ns_exact_fallback_until().  Errors: MEMORY, LIMIT (of work,
 * ns_exact_bound_by()). */
int ns_exact_go(ns_exact *f, double accepted_t, double t, ns_until until);
/* An input of the system was replaced at the accepted point, where that begins to count.  Errors: RANGE (it
 * has ramps, the one before had none), MEMORY. */
int ns_exact_set_input(ns_exact *f, int input);
/* 1 if the way goes another way with it: it is more than shown, and more than a command of time. */
int ns_exact_input_matters(const ns_exact *f, int input);
/* The stepper has just been started: its point becomes consistent, by jumps where needed; guess: 1: in the
 * stepper's mode, if that holds.  Errors: those of the impulse problem. */
int ns_exact_find_consistent(ns_exact *f, int guess);
/* Events and periods are shown to w; NULL: to nobody. */
void ns_exact_watch(ns_exact *f, const ns_watch *w);
/* ns_exact_go() fails with LIMIT where e, which outlives f, has passed its bound. */
void ns_exact_bound_by(ns_exact *f, ns_engine *e);
/* After ns_exact_go() with NS_TO_STEP that came later than where it began: x, lambda (n+m) at t, from there
 * to where it came; valid until the next call.  Errors: STATE (any other trial), MEMORY. */
int ns_exact_sample(ns_exact *f, double t, const double **x_lambda);
/* As ns_march_shortest(), of the same. */
double ns_exact_shortest(ns_exact *f, double t, double *until);
/* The trial is accepted, or dropped. */
void ns_exact_accept(ns_exact *f);
void ns_exact_drop(ns_exact *f);

/* 1 if another engine has to go on from the point; until when, s; a measure of how often that happened
 * lately. */
int ns_exact_in_fallback(const ns_exact *f);
double ns_exact_fallback_until(const ns_exact *f);
int ns_exact_failures(const ns_exact *f);
/* 1 if that is because the mode that the last ns_exact_go() began in cannot be built: it may last. */
int ns_exact_has_no_matrices(const ns_exact *f);
/* 1 if every command is a function of time: no switch can chatter. */
int ns_exact_timed(const ns_exact *f);
const ns_counts *ns_exact_counts(const ns_exact *f); /* what it cost so far; events: passed by it */
long ns_exact_replayed(const ns_exact *f);           /* events of them, in periods that were repeated */

/* kernel.c: the engine's matrices as a kernel.  h: as above.  Errors: MEMORY, those of ns_theta_create(). */
int ns_exact_kernel_create(const ns_system *s, double h, ns_kernel **out);

#endif
