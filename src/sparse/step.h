/* src/sparse/step.h - one step of high order; m: the engine, step: one of its steps, t, g, room: s.
 *
 *   step_control.c  how long it is    step_error.c  its stages, its error    step_kernel.c  a solve, dense
 * output
 */
#ifndef NS_SPARSE_STEP_H
#define NS_SPARSE_STEP_H

#include "sparse_internal.h"

#include <math.h>

/* step_control.c: a step from m->w, m->mode at t until limit at most, ended by the first event in it. */
int ns_sparse_control_step(ns_sparse *m, ns_dense_step *step, double t, double limit);
static inline double ns_sparse_step_length(const ns_sparse *m, int length_exponent) { /* s */
    return ldexp(m->o.h, -length_exponent);
}

/* The error of a step, as multiples of what is allowed. */
typedef struct ns_step_error {
    double whole;      /* over its full length */
    double until_room; /* if it ends after so many s */
    double ratio;      /* the part of D^7 w that is left in D^8 w, at most 1 */
    double jump, time; /* by how much it would be larger with what contradicts the algebraic equations where
                          the step begins; how long that lasts, in g */
} ns_step_error;

/* step_error.c: as many stages as are needed until room, at most NS_ORDER.  Errors: LIMIT (a prediction is
 * tried, and w jumps), those of a stage. */
int ns_sparse_step_stages(ns_sparse *m, ns_dense_step *step, double room);
/* Its error; stages that lost digits are solved once more, and what is rounding counts as none.  Errors:
 * those of a stage. */
int ns_sparse_step_measure(ns_sparse *m, ns_dense_step *step, double room, ns_step_error *e);
/* The error of inputs, on which guards depend more than the state, as a multiple of what is allowed. */
double ns_sparse_step_inputs_error(const ns_sparse *m, int length_exponent);
/* How many times, at most `most`, a step with this error may be doubled: with its length the ratio d of D
 * grows from d < 1 to 2 d / (1 + d). */
int ns_sparse_step_doublings(double error, double d, int most);

/* step_kernel.c: the right-hand side of (P2) from w (n; NULL: zero) and inputs z (any: not all are zero), to
 * m->r; constants: 1 with what is constant. */
void ns_sparse_step_rhs(ns_sparse *m, double g, const double *w, const double *z, int any, int constants);
/* Stage i of steps of length g from t: v (n+m) from D^i w, inputs z (nz) and a factor of m->mode, and by (n)
 * = D^(i+1) w.  Its right-hand side stays in m->r. */
int ns_sparse_step_solve(ns_sparse *m, const ns_cached_factors *k, double t, double g, int i, const double *w,
                         double *z, double *v, double *by);
/* One implicit Euler step of length g from w (n) in m->mode at t to v (n+m); by (n, or NULL) = D w. */
int ns_sparse_step_euler(ns_sparse *m, double t, double g, const double *w, int brief, double *v, double *by);
/* Stage i of a step; the next one, if it has not all of them. */
int ns_sparse_step_stage(ns_sparse *m, ns_dense_step *step, const ns_cached_factors *k, int i);
int ns_sparse_step_more(ns_sparse *m, ns_dense_step *step);
/* 1 if the last stage leaves more of (P2) than rounding of its terms; then all stages again, each solution
 * corrected once. */
int ns_sparse_step_digits_lost(ns_sparse *m, const ns_dense_step *step);
int ns_sparse_step_refine(ns_sparse *m, ns_dense_step *step);
/* g halved until it is negligible beside room, s, too, or not above least. */
double ns_sparse_step_negligible(double g, double least, double room);
/* Dense output at tau, s: w (n) by (E2); v = (x, lambda) by (E1), with factors c (NS_STAGES) of images. */
void ns_sparse_step_state(const ns_sparse *m, const ns_dense_step *step, double tau, double *w);
void ns_sparse_step_point(const ns_sparse *m, const ns_dense_step *step, double tau, double *v);
void ns_sparse_step_series(const ns_dense_step *step, double tau, double *c);
/* The same with one more stage, which the step goes on without.  Errors: those of a stage. */
int ns_sparse_step_shown(ns_sparse *m, ns_dense_step *step, double tau, double *v);
/* time_lost at the end of a step.  Steps of one length round t alike each time, which would add up. */
double ns_sparse_step_time_lost(const ns_dense_step *step);
/* sum (n+m) += K^-1 of what the stages leave of (P2): what rounding may have done to them. */
int ns_sparse_step_residue(ns_sparse *m, const ns_dense_step *step, double *sum);

#endif
