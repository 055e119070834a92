/* nonsmooth/impulse.h - the impulse problem: the state after a jump.
 *
 *   (J1)  M (x+ - x-) = A X + B Lambda,  M X = 0  differential rows; X, Lambda: the impulses of x and lambda
 *   (J2)  0 = A X + B Lambda,  Y = C X + D Lambda  algebraic rows; pairs
 *   (J3)  (S3) and the algebraic rows of (S1) hold at t+ for x+, lambda+, y+
 *   (J4)  (Lambda, lambda+, lambda'+) and (Y, y+, y'+), each in lexicographic order, obey (S4)
 *
 * It is the limit h -> 0 of the step with theta = gamma = 1, where x = X/h + x+, lambda = Lambda/h + lambda+.
 * Resistors carry no impulse: they are part of (J2) and (J3) only.  Units: Lambda of a device is a charge (C)
 * or, where lambda is a voltage, a flux (Wb); X of a source's current a charge, of a node's voltage a flux.
 */
#ifndef NONSMOOTH_IMPULSE_H
#define NONSMOOTH_IMPULSE_H

#include "nonsmooth/theta.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The solution.  The arrays belong to the caller; any of them may be NULL. */
typedef struct ns_impulse {
    double *w;              /* n: M x+, ready for ns_theta_start() and ns_march_start() */
    double *x, *lambda, *y; /* n, m, m: at t+ */
    double *X, *Lambda, *Y; /* n, m, m: impulses; zero where nothing jumps */
    ns_mode *mode;          /* m: at t+ */
    double *h;              /* s: the step that proposed the mode; the solution does not depend on it */
} ns_impulse;

/* Solves the impulse problem at the accepted point of a stepper: w- = M x(t-), mode and commands are those of
 * ns_theta_start(), ns_theta_command() or of the last accepted step, and stay as they are.  z: inputs at t+
 * (nz); slope: their slopes dz/dt at t+ (nz; NULL: all zero), which currents of voltage sources across
 * capacitors depend on.  What the laws do not determine (two closed switches in parallel) gets least norm.
 * On failure *out is left alone.  Errors: NULL, NUMBER, MEMORY, those of ns_mlcp_solve(): INFEASIBLE (sources
 * that contradict each other); SINGULAR also where impulses would have to be derivatives of impulses.
 * *fault of ns_theta_fault(). */
int ns_theta_impulse(ns_theta *s, const double *z, const double *slope, const ns_impulse *out);

#ifdef __cplusplus
}
#endif
#endif
