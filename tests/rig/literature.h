/* tests/rig/literature.h - circuits by which the literature judges nonsmooth simulators, as hand-written
 * systems. */
#ifndef NONSMOOTH_TESTS_LITERATURE_H
#define NONSMOOTH_TESTS_LITERATURE_H

#include "nonsmooth.h"

/* The synchronous buck converter in closed loop: 3 V in, 1.8 V out, 600 kHz. */
typedef enum lit_set {
    LIT_STANDARD,
    LIT_SLIDING,
    LIT_SLIDING_SLOW /* the sliding set, its ramp a sawtooth of LIT_BUCK_SLOW without a fall */
} lit_set;
#define LIT_BUCK_SLOW 3.2e-6
typedef enum lit_comparator {
    LIT_GAIN_15, /* v(G) = clamp(1.5 + 15 s, 0, 3),  s = Vramp - v(err): two hinges */
    LIT_RELAY    /* zero width: v(G) = 0 where s < 0, 3 where s > 0: one box [0,3] */
} lit_comparator;

/* x = (i_L, v_out, v_C11, v_C21, v_err),  z = (Vramp, Vref);  all x are 0 at the start.
 * lambda: the comparator's pairs (2, or 1 for a relay), whose sum or difference is v(G);
 *         the hinges of f(vSG-2), f(vDG-2), f(vGS-2), f(vGD-2), each with as many pairs as hinges;
 *         i(DP);  v(D) + 0.8.  The last y is i(DN).
 * hinges: 2 (12 pairs) or 5 (24 pairs).  n = 5, M diagonal, M - h A nonsingular. */
ns_system *lit_buck(int hinges, lit_set set, lit_comparator comparator);
enum { LIT_BUCK_IL, LIT_BUCK_VOUT, LIT_BUCK_VC11, LIT_BUCK_VC21, LIT_BUCK_ERR, LIT_BUCK_N };
double lit_buck_gate(lit_comparator comparator, const double *lambda); /* v(G) */

/* (P1) of a step of theta = gamma = 1, reduced to lambda (M - h A must be nonsingular, no command):
 * W (m*m) = D + h C (M - h A)^-1 B;   q (m) = C x_free + F z + e,  x_free = (M - h A)^-1 (M x + h (b + E z)),
 * x at the start of the step, z at its end. */
void lit_reduced_matrix(const ns_system *s, double h, double *W);
void lit_reduced_vector(const ns_system *s, double h, const double *x, const double *z, double *q);
/* x at the end of that step. */
void lit_reduced_state(const ns_system *s, double h, const double *x, const double *z, const double *lambda,
                       double *next);

#endif
