/* src/exact/guards.h - guards at a state, and the first one that breaks in a step.
 *
 *   guard_values.c  their values and what these may be off by    event_location.c  which breaks first, and
 * when
 */
#ifndef NS_EXACT_GUARDS_H
#define NS_EXACT_GUARDS_H

#include "exact_internal.h"

/* event_location.c: the first interval between samples of a step from X in which a guard may break, -1: none;
 * *clear: the fraction of that interval, from its begin, in which none does. */
int ns_exact_event_in_step(ns_exact *f, const ns_time_scale *scale, const ns_step_map *map, double *clear);
/* The guard that breaks first within tau <= h from X, *when after X; NS_GUARD_NONE. */
int ns_exact_event_within(ns_exact *f, const ns_time_scale *scale, double tau, double *when);
/* 1 if all guards (rows) surely hold at and between all samples ((samples+1) rows). */
int ns_exact_event_samples_hold(const double *s, int rows, int samples);
/* 1 if all guards but those that are always zero stay above a bound (rows) of each. */
int ns_exact_event_samples_above(const ns_mode_kernel *k, const double *s, int samples, const double *bound);
/* Right after an event: guards of the new mode that (P1) holds right, though they seem to break soon, have
 * errors larger than they are.  They break where they are below zero by their rounding and not where they
 * pass zero: there the two modes on either side would take turns. */
void ns_exact_event_quiet(ns_exact *f);
/* The event of guard (NS_GUARD_NONE: of none) in mode `was` is resolved: notes whether only rounding decided.
 */
void ns_exact_event_note_mended(ns_exact *f, const ns_exact_mode *was, int guard);
/* c: the coefficients of (E1) at i/NS_INTERVALS of s Euler steps. */
void ns_exact_event_intervals(double s, double (*c)[NS_ORDER]);

/* guard_values.c: one of the matrices of guards (mode_kernel.h) at X: guard g. */
static inline double ns_exact_guard_of(const ns_mode_kernel *k, const double *rows, int g, const double *X) {
    double sum = 0;
    for (int j = 0; j < k->q; j++)
        sum += rows[j + g * k->q] * X[j];
    return sum;
}

/* Term i of (E1) of guard g, by the first `entries` of X: of term 0 alone, its value after the Euler step. */
static inline double ns_exact_guard_term(const ns_mode_kernel *k, int g, int i, int entries,
                                         const double *X) {
    const double *rows = k->guard_powers + (size_t)i * (size_t)k->rows + (size_t)g;
    double sum = 0;
    for (int j = 0; j < entries; j++)
        sum += rows[(size_t)j * (size_t)(NS_ORDER * k->rows)] * X[j];
    return sum;
}

/* What guard g may be off by at f->X; at any X, its rate being known. */
double ns_exact_guard_rounding(const ns_exact *f, const ns_mode_kernel *k, int g);
double ns_exact_guard_rounding_at(const ns_exact *f, const ns_mode_kernel *k, int g, const double *X,
                                  double rate);
/* The rounding of the time, s: a guard may be off by what it changes by in that, where its rate lasts as
 * long: it lasts while the second rate changes a sixteenth of it, for ever where that is rounding. */
double ns_exact_rounding_of_time(const ns_exact *f);
double ns_exact_guard_lasts(const ns_exact *f, const ns_mode_kernel *k, int g, const double *X, double rate);
double ns_exact_guard_time_rounding(const ns_exact *f, const ns_mode_kernel *k, int g, const double *X,
                                    double rate);
/* 1 if a mode that is resolved can be read there: voltages of open pairs are known to 1e-3 of the highest so
 * far or at f->X, currents of others to 1e-3 of the largest at f->X or in mode `of`, the same one not
 * resolved. */
int ns_exact_guards_are_readable(const ns_exact *f, const ns_exact_mode *resolved, const ns_exact_mode *of);
/* All guards at X: value (2 rows), behind them their rates; tol (rows): what they may be off by, with the
 * error of the event's time. */
void ns_exact_guard_values(ns_exact *f, const ns_mode_kernel *k, const double *X, double *value, double *tol);

#endif
