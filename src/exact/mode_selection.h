/* src/exact/mode_selection.h - from one mode to the next.
 *
 *   mode_entry.c  what jumps where a mode is entered       guard_sign.c  whether a mode holds from here on
 *   command_flips.c  which switches of the state change   mode_selection.c   which modes are tried
 */
#ifndef NS_EXACT_MODE_SELECTION_H
#define NS_EXACT_MODE_SELECTION_H

#include "events/guard.h"
#include "exact_internal.h"

/* mode_entry.c: X_next = X, as the mode is entered with it; 1 if it jumps.  Then: 1 if its pairs can carry
 * that; the guard whose impulse violates that most. */
int ns_exact_enter(ns_exact *f, const ns_exact_mode *k);
/* change (q), of an X before the jump, becomes that of X after it. */
void ns_exact_enter_less(ns_exact *f, const ns_mode_kernel *k, double *change);
int ns_exact_enter_fits(ns_exact *f, const ns_mode_kernel *k);
int ns_exact_enter_worst(const ns_exact *f, const ns_mode_kernel *k);
/* Then: 1 if guard g has an impulse above zero, so that after it the guard may be below zero: a diode that
 * carries charge and then blocks.  A guard without one breaks on the way: the jump does not end there. */
int ns_exact_enter_carries(const ns_exact *f, const ns_mode_kernel *k, int g);
/* What jumps counts among the integrals of the trial. */
void ns_exact_enter_count(ns_exact *f);

/* guard_sign.c */
/* What guard g is about to do.  SEEMS_TO: by its value some steps ahead, which grown rounding, or another
 * event in between, may have changed. */
enum { NS_SOON_EXPONENT = 8 }; /* a guard is looked at up to h 2^8 ahead */
ns_guard_sign ns_exact_guard_sign(ns_exact *f, ns_exact_mode *mode, int g, const double *X);
/* How long after the event guard g breaks, s: 0 if it is that of the event but for a factor; above 0 if its
 * threshold differs from that one's only by rounding (a sign at zero), and the control goes on as it does.
 * INFINITY: it is another guard, or breaks more than h 2^-10 later. */
double ns_exact_guard_delay(ns_exact *f, const ns_mode_kernel *k, int g);

/* command_flips.c: point->flip.  No command; those that are beyond their thresholds, or about to be; that of
 * guard event_guard, if it is one of a command, or of a switch that slides; those that change with the guard
 * that breaks, or with what is known ahead (ties.h): the event is known no better than these are apart.
 * How many. */
void ns_exact_flips_clear(ns_exact *f);
int ns_exact_flip_contradicted(ns_exact *f);
int ns_exact_flip_of_guard(ns_exact *f);
int ns_exact_flip_met(ns_exact *f);

/* mode_selection.c: to the mode that follows with the commands in point->flip changed.  by_guard: 1: a pair's
 * guard broke, number `broken` of the present mode if that is known, or the mode held for its jump only, so
 * that another mode must follow; 0: inputs or commands changed. */
int ns_exact_mode_after(ns_exact *f, int by_guard, int broken, int *goes_on);

/* Sets event_guard, of the present mode, and event_pair. */
void ns_exact_event_is_of(ns_exact *f, int guard);
/* How well the instant is known at which guard event_guard broke, s: its rounding divided by its rate. */
double ns_exact_event_time_error(ns_exact *f);
/* Sets event_time_error (error, s) and command_time_error, which is h 2^-NS_EVENT_EXPONENT at most: a current
 * at rest, 1e-22 A, may take longer than that to cross zero, but no control counts as met for so long. */
void ns_exact_event_known_to(ns_exact *f, double error);
/* The one of the two that is for guard g, s. */
static inline double ns_exact_time_error_of(const ns_exact *f, const ns_mode_kernel *k, int g) {
    return g < k->pair_rows ? f->state.event_time_error : f->state.command_time_error;
}

/* How a mode was proposed: among likely ones, by (P1) over a short step or by the guard that broke in the
 * step before, by the impulse problem. */
typedef enum ns_evidence { NS_EVIDENCE_NONE, NS_EVIDENCE_STEP, NS_EVIDENCE_IMPULSES } ns_evidence;

typedef enum ns_mode_verdict {
    NS_VERDICT_NO,
    NS_VERDICT_HOLDS,
    NS_VERDICT_JUMPS
} ns_mode_verdict; /* JUMPS: only for the jump at this instant */

/* Whether the mode holds from here on.  A guard that is undecided holds if there is evidence for the mode, or
 * there was when the same guard was undecided before (bits in undecided). */
ns_mode_verdict ns_exact_mode_holds(ns_exact *f, ns_exact_mode *k, ns_evidence evidence, uint64_t undecided);
/* 1 if nothing jumps and all guards are above zero by more than their rounding. */
int ns_exact_mode_holds_clearly(ns_exact *f, ns_exact_mode *k);

/* mode_selection.c: as ns_exact_select_mode(), to a mode that followed before, if it holds: 1; no command
 * depends on the state.  Else X and mode stay. */
int ns_exact_select_known(ns_exact *f, ns_exact_mode *to, int guard);

#endif
