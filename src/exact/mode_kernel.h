/* src/exact/mode_kernel.h - one mode seen through an implicit Euler step of length g: all that steps,
 * readings and events of up to h = g/gamma inside that mode are made of (laguerre.h).
 *
 * X = (w (r), v (nv)) is the state: charges and fluxes, and the inputs as states (input_states.h); q = r +
 * nv.  Guards are rows that must not be negative: those of the pairs, then those of commands by the state (on
 * - g while open, g - off while closed).
 */
#ifndef NS_EXACT_MODE_KERNEL_H
#define NS_EXACT_MODE_KERNEL_H

#include "inputs/input_states.h"
#include "modes/laguerre.h"
#include "theta/theta_internal.h"

/* What it means that a guard breaks. */
typedef struct ns_guard_row {
    int pair;    /* this pair goes */
    ns_mode to;  /* there, */
    int command; /* or (-1: none) this command changes */
} ns_guard_row;

typedef struct ns_mode_kernel {
    double g, h;
    int r, nv, q;
    int rows, pair_rows;
    ns_guard_row *row; /* rows */
    double *xi;  /* (n+m)*(q+mutes): x, lambda of the implicit step; by inputs that act on nothing else too */
    double *now; /* (n+m)*(q+mutes): x, lambda right here; NULL until asked for */
    double *series; /* (8 r)*q: D^1 ... D^8, the part that acts on w */
    double *coef;   /* (8 rows)*q: the guards of the images D^0 ... D^7 */
    double *value;  /* q*rows, guard by guard: they now, (E1) at tau = 0, */
    double *rate;   /* q*rows: their rates, */
    double *bend;   /* q*rows: and the rates of those */
    double *sight;  /* (2 rows)*q: values and rates of all guards again, input by input */
    double *noise;  /* rows*q: their rounding, by input, in units of eps */
    double *last;   /* r*q: D^8 again */
    double *step;   /* r*q: X -> w after h */
    unsigned char
        *idle; /* rows: guards that are zero whatever X is, as that of a diode across a closed switch */
    size_t bytes;
} ns_mode_kernel;

/* Builds it for a mode (m) whose commanded pairs have their bounds in s.  Errors: SINGULAR, MEMORY, NUMBER.
 */
int ns_exact_kernel_build(ns_theta *s, const ns_input_states *e, double g, const ns_mode *mode,
                          ns_mode_kernel **out);
/* output_map.c: makes `now`.  Errors: MEMORY. */
int ns_exact_output_map(const ns_theta *s, const ns_input_states *e, ns_mode_kernel *k);
void ns_exact_kernel_free(ns_mode_kernel *stage); /* NULL is allowed */

/* P (r*q): X -> w after tau <= h. */
void ns_exact_kernel_step(const ns_mode_kernel *k, double tau, double *P);

/* P <- P2 after P1, both r*q; advance (nv*nv): exp(h1 S), h1 the time of P1.  P may be neither. */
void ns_exact_kernel_compose(const ns_mode_kernel *k, const double *P2, const double *P1,
                             const double *advance, double *P);

/* exp(h S), nv*nv. */
void ns_exact_input_matrix(const ns_input_states *e, double h, double *out);

/* The rates of the mode, 1/s: re, im (r each); infinite ones are -INFINITY, 0.  Errors: MEMORY, NUMBER. */
int ns_exact_kernel_rates(const ns_mode_kernel *k, double *re, double *im);

#endif
