/* src/engine/kernel.h - what a kernel answers: the linear circuit inside one mode, from a point on.
 *
 * An engine keeps for each mode what its steps are made of: the exact engine matrices, the sparse engine one
 * factor.  Event logic (where a guard breaks, which mode follows, what jumps) can be written over the answers
 * below alone, for both; so far each engine has its own.  A kernel is asked at one point at a time: time,
 * charges and mode.
 *
 *   place: sets the point, in a mode.
 *   make_consistent: takes away at once the charges and fluxes that the mode's constraints do not allow.
 *   prepare: computes the circuit from the point on, for some time ahead, while the mode stands.
 *   state, outputs, guards: answer at any instant in that time, in any order.
 */
#ifndef NS_ENGINE_KERNEL_H
#define NS_ENGINE_KERNEL_H

#include "events/guard.h"
#include "nonsmooth/march.h"

typedef struct ns_kernel ns_kernel;

typedef struct ns_kernel_table {
    void (*free)(ns_kernel *k);
    /* The point: t (s), w = M x (n), commanded switches as mode (m) says.  Errors: NUMBER, MEMORY, SINGULAR
     * (the mode contradicts itself). */
    int (*place)(ns_kernel *k, double t, const double *w, const ns_mode *mode);
    /* w of the point gets to be what the algebraic equations of the mode allow.  moved (n): w after less w
     * before; impulse (m): of lambda, with what it takes (J1): A s or V s.  *jumps: 0 if that is rounding.
     * Errors: RESIDUAL (digits are lost), MEMORY. */
    int (*make_consistent)(ns_kernel *k, double *moved, double *impulse, int *jumps);
    /* From the point on for h (s) at most; *ahead: for how long the answers below hold.  Errors: MEMORY,
     * OVERFLOW. */
    int (*prepare)(ns_kernel *k, double h, double *ahead);
    /* tau (s) after the point, 0 <= tau <= *ahead: w = M x (n); x (n) and lambda (m); all guards (2m + nc).
     * Guard 2j is the lower one of pair j: y_j at the lower bound, lambda_j - l_j inside; guard 2j+1 the
     * upper one: -y_j at the upper bound, u_j - lambda_j inside; guard 2m+c that of command c by the state:
     * on - g while it is open, g - off while it is closed.  Those that the mode has not are INFINITY.
     * Errors: MEMORY. */
    int (*state)(ns_kernel *k, double tau, double *w);
    int (*outputs)(ns_kernel *k, double tau, double *x, double *lambda);
    int (*guards)(ns_kernel *k, double tau, ns_guard *guard);
    /* What it cost so far. */
    const ns_counts *(*cost)(ns_kernel *k);
} ns_kernel_table;

/* The first member of every kernel's struct. */
struct ns_kernel {
    const ns_kernel_table *table;
    const ns_system *s;
};

/* The integrals of x (n) and lambda (m) from `from` to `to` (s after the point): charges, fluxes and their
 * likes.  By Gauss' rule with eight points, exact where outputs are of degree 15 in time or less.  Errors:
 * MEMORY. */
int ns_engine_kernel_integrals(ns_kernel *k, double from, double to, double *x, double *lambda);

#endif
