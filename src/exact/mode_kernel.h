/* src/exact/mode_kernel.h - one mode as matrices, made from an implicit Euler step of length g: all that
 * steps up to h = g/gamma, outputs and guards in that mode are computed from (laguerre.h).
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

/* What follows when a guard breaks. */
typedef struct ns_guard_row {
    int pair;    /* this pair changes */
    ns_mode to;  /* to this mode */
    int command; /* or this command flips; -1: none */
} ns_guard_row;

/* (P2) of a mode as x and lambda are read from it; output_solve.c's. */
typedef struct ns_output_rows ns_output_rows;

typedef struct ns_mode_kernel {
    /* sizes */
    double g, h;                /* s: length of the Euler step; longest step, g/gamma */
    int r, nv, q;               /* charges and fluxes; inputs as states; r + nv */
    int rows, pair_rows;        /* guards; those of pairs come first */
    ns_guard_row *row;          /* rows: what each guard stands for */
    ns_mode *mode;              /* m: the mode */
    unsigned char *always_zero; /* rows: 1: zero for all X, as the guard of a diode across a closed switch */
    size_t bytes;               /* of all of it */

    /* matrices that act on X, column by column */
    double *step_x_lambda;   /* (n+m)*(q+output_only_inputs): x, lambda of the Euler step; last by inputs of
                                outputs only */
    double *x_lambda_now;    /* (n+m)*(q+output_only_inputs): x, lambda at tau = 0; NULL until needed */
    int output_cancels;      /* 1: its columns are so large that M x differs from w by their rounding */
    double *output_sizes;    /* q: the largest entry of each of its columns */
    double *laguerre_powers; /* (8 r)*q: D^1 ... D^8, the part that acts on w */
    double *D8;              /* r*q: D^8 again */
    double *step;            /* r*q: X -> w after h */
    double *guard_powers;    /* (8 rows)*q: guards of the images D^0 ... D^7 */
    double *guard_values;    /* (2 rows)*q: guards at tau = 0 (E1), and their rates */
    double *rounding;        /* rows*q: rounding of the guards, in units of eps */

    /* the guards again, row by row */
    double *value;       /* q*rows: at tau = 0 */
    double *rate;        /* q*rows: their rates */
    double *second_rate; /* q*rows: the rates of those */

    /* flows.c: flows that the charges are summed from; NULL: step and D are used as they are */
    int flows;           /* how many */
    double *flow_powers; /* (8 flows)*q: of the Euler steps from the images D^0 ... D^7 */
    double *flow_into;   /* r*flows: what each adds to the charges over the Euler step */

    /* output_map.c: where the columns of x_lambda_now cancel */
    int output_asked;            /* 1: these were asked for; */
    ns_output_rows *output_rows; /* NULL: there are none */
    int solves;                  /* states solved by them one by one; -1: unit vectors cannot be */
    double *solved; /* (n+m)*(q+output_only_inputs): of unit vectors, then the largest entry of each column;
                       NULL: none */
} ns_mode_kernel;

/* Builds it for a mode (m) whose commanded pairs have their bounds in s.  Errors: SINGULAR, MEMORY, NUMBER.
 */
int ns_exact_kernel_build(ns_theta *s, const ns_input_states *e, double g, const ns_mode *mode,
                          ns_mode_kernel **out);
/* charge_rates.c: D w of an Euler step by the inputs of its map: rates, and size: of the terms they are
 * summed from (r*q of the map, each). */
void ns_exact_kernel_charge_rates(const ns_theta *s, const ns_map *map, double *rates, double *size);
/* output_map.c: makes `x_lambda_now`.  Errors: MEMORY. */
int ns_exact_output_map(const ns_theta *s, const ns_input_states *e, ns_mode_kernel *k);
/* x_lambda (n+m): x, lambda at X, by it; residual: r, work.  Errors: MEMORY. */
int ns_exact_output_map_apply(ns_theta *s, const ns_input_states *e, ns_mode_kernel *k, const double *X,
                              double *x_lambda, double *residual);
/* output_solve.c.  sum (q): of (-1)^i D^i, i < 8, of unit vector j: its part in w, and those of inputs. room:
 * 2 nv. */
void ns_exact_output_images(const ns_mode_kernel *k, const ns_input_states *e, int j, double *sum,
                            double *room);
/* Makes `output_rows`, if they can be.  Errors: MEMORY. */
int ns_exact_output_rows(ns_theta *s, const ns_input_states *e, ns_mode_kernel *k);
void ns_exact_output_rows_free(ns_output_rows *o); /* NULL is allowed */
/* x_lambda (n+m): x, lambda at X, by them; lambda of pairs at bounds is known.  0: it is left as it was.
 * Constants count X[r] times, which is 1 but for unit vectors. */
int ns_exact_output_solve(const ns_theta *s, const ns_input_states *e, const ns_mode_kernel *k,
                          const double *X, double *x_lambda);
/* output_columns.c: makes `solved`, once it was called for as many states as it has columns. Errors: MEMORY.
 */
int ns_exact_output_columns(const ns_theta *s, const ns_input_states *e, ns_mode_kernel *k);
/* x_lambda (n+m): x, lambda at X, by `solved`.  0: there is none, or its columns cancel there. */
int ns_exact_output_columns_apply(const ns_theta *s, const ns_input_states *e, const ns_mode_kernel *k,
                                  const double *X, double *x_lambda);
void ns_exact_kernel_free(ns_mode_kernel *kernel); /* NULL is allowed */

/* P (r*q): X -> w after tau <= h. */
void ns_exact_kernel_step(const ns_mode_kernel *k, double tau, double *P);

/* P <- P2 after P1, both r*q; advance (nv*nv): exp(h1 S), h1 the time of P1.  P may be neither. */
void ns_exact_kernel_compose(const ns_mode_kernel *k, const double *P2, const double *P1,
                             const double *advance, double *P);

/* input_series.c: 1 if e + D^8 e in place of input e makes good what (E1) leaves off of it; 0: it leaves
 * nothing off, or what it charges is damped or constrained.  room: r. */
int ns_exact_kernel_leaves_off(const ns_theta *s, const ns_mode_kernel *k, int j, double *room);
/* Guards of inputs with what (E1) leaves off of them, where that is more than their rounding.  room: r. */
void ns_exact_kernel_add_left_off(const ns_theta *s, ns_mode_kernel *k, double *room);

/* flows.c.  The flows of a kernel, unless they are much larger than what they move.  Errors: MEMORY. */
int ns_exact_kernel_flows(const ns_theta *s, const ns_input_states *e, ns_mode_kernel *k);
/* As ns_exact_kernel_step() and _compose(), by flows: P (r*q) is X -> what is added to w, and behind it
 * stands X -> the flows that this is (flows*q), flow_powers summed over the step. */
void ns_exact_kernel_flows_step(const ns_mode_kernel *k, double tau, double *P);
void ns_exact_kernel_flows_compose(const ns_mode_kernel *k, const double *P2, const double *P1,
                                   const double *advance, double *P);

/* exp(h S), nv*nv. */
void ns_exact_input_matrix(const ns_input_states *e, double h, double *out);

/* Longest step of a kernel for rates (1/s) up to this: h, the ladder's, times a power of two. */
double ns_exact_kernel_length(double h, double rate);

/* The rates of the mode, 1/s: re, im (r each); infinite ones are -INFINITY, 0; those larger than this kernel
 * tells -INFINITY, 1.  Errors: MEMORY, NUMBER. */
int ns_exact_kernel_rates(const ns_mode_kernel *k, double *re, double *im);

#endif
