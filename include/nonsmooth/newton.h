/* nonsmooth/newton.h - one theta-gamma step of a general complementarity system: Newton around (P1).
 *
 *   (T1)  W      = M - h theta A - h gamma K
 *   (T2)  R_free = M(x - x_k) - h theta f(x,t_k+1) - h(1-theta) f(x_k,t_k)
 *   (T3)  x_p    = x - W^-1 [ R_free - h(1-gamma) r_k - h gamma ( g(x,lambda) - B lambda ) ]
 *   (T4)  x+     = x_p + h gamma W^-1 B lambda+
 *   (T5)  y+     = h(x,lambda) + C (x_p - x) - D lambda + (D + h gamma C W^-1 B) lambda+
 *   (P1)  -y+ in N_[l,u](lambda+)
 *
 * Algebraic rows (those of ns_system_split()) hold at t_k+1 whatever theta and gamma are.  (y, lambda) of
 * every iterate obey (S4); the loop stops when both residuals, that of (S1) over the step and that of (S3),
 * are down to rounding.  Corrections that do not reduce them, or leave the domain of a function, are
 * shortened along the path on which (S4) holds; the loop is bounded.  It begins at (x_k, lambda_k) with the
 * inputs of t_k+1, where the functions must be defined: an exponential that may overflow there is better
 * continued by its tangent.  For linear f, g, h one iteration is exact.  Inputs are seen from the right at
 * t_k and from the left at t_k+1: end a step where an input jumps, and call ns_newton_jump() there, for a
 * state that stays consistent too: r_k and lambda_k are otherwise those from before the jump, and the order
 * falls to 1.
 */
#ifndef NONSMOOTH_NEWTON_H
#define NONSMOOTH_NEWTON_H

#include "nonsmooth/model.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ns_newton ns_newton;

/* Where in the step (S2) and (S3) are taken. */
typedef enum ns_relation {
    NS_RELATION_END,  /* at t_k+1;  r of the step is gamma r_k+1 + (1-gamma) r_k */
    NS_RELATION_GAMMA /* (T8): at t_k+gamma, x_gamma = gamma x_k+1 + (1-gamma) x_k;  r of the step is
                         r_k+gamma. lambda, y and r that are read are those of t_k+gamma, and algebraic rows
                         hold there: unknowns without a derivative ring where they jump */
} ns_relation;

typedef struct ns_newton_options {
    double theta; /* in [0,1] */
    double gamma; /* in (0,1]; from 1/2 on for use: below, an error of lambda (of x with NS_RELATION_GAMMA)
                     grows by (1-gamma)/gamma a step unless D outweighs h (1-2 gamma) C W^-1 B */
    ns_relation relation;
    double tolerance; /* on both residuals, relative to the terms they are summed from; 0: 1e-12 */
    int iterations;   /* bound on Newton iterations of a step that do not halve the residuals; 0: 50.  Those
                         that do, as when an exponential falls by 1/e in each: 20 times as many */
    int halvings;     /* bound on halvings of one Newton correction; 0: 10 */
} ns_newton_options;

/* What the steps of an object cost so far. */
typedef struct ns_newton_counts {
    long steps;      /* accepted */
    long trials;     /* tried */
    long iterations; /* of Newton */
    long halvings;   /* corrections shortened */
    long problems;   /* (P1) solved */
    long pivots;     /* inside them */
    long factors;    /* factorisations, those of the MLCP solver included */
    long calls;      /* of f */
} ns_newton_counts;

/* Makes a stepper for a model, which with its arrays must outlive it and not change.  On failure *out is NULL
 * and fault (may be NULL) says where.  Errors: those of ns_model_check(), RANGE (an option), MEMORY. */
int ns_newton_create(const ns_model *model, const ns_newton_options *o, ns_newton **out, ns_fault *fault);

/* Frees a stepper; NULL is allowed. */
void ns_newton_free(ns_newton *s);

/* Makes (x, lambda) (n, m; lambda NULL: 0 put into its bounds) the accepted point at t0.  It need not be
 * consistent: see ns_newton_jump().  Errors: NULL, NUMBER, or a callback that refuses the point (RANGE). */
int ns_newton_start(ns_newton *s, double t0, const double *x, const double *lambda);

/* Tries a step of length h > 0 from the accepted point, which is left alone: try again with any h.  The
 * step integrated is the rounded t + h minus t; an h too small to change t is RANGE.
 * NS_DIVERGED: Newton's loop met its bound or left the domain of a function; a shorter step may do.
 * Errors: NULL, STATE (not started), RANGE (h), those of ns_mlcp_solve(); *fault of ns_newton_fault(). */
int ns_newton_try(ns_newton *s, double h);

/* Tries the jump at the accepted time: the impulse problem  M (x+ - x-) = h gamma B lambda, h -> 0, with the
 * constraints of (S3), (S4) and the algebraic rows of (S1) at x+ and with the inputs just after.  A state
 * that is consistent already does not change.  Charges and fluxes are accurate to some eps; lambda, which
 * depends on M x', to some 1e-8 if the time constants are of similar size.  Slopes of inputs count at any t;
 * the t of the callbacks does not advance if its last bit is longer than 2^-18 of the fastest time constant.
 * Errors: as ns_newton_try(). */
int ns_newton_jump(ns_newton *s);

/* Makes the last successful trial the accepted point; cannot fail for numerical reasons.  Errors: STATE. */
int ns_newton_accept(ns_newton *s);

/* Integrates from the accepted point to time t by steps of at most h (at least t's last bit), each accepted;
 * a step that does not converge is tried again at half its length, at most 20 times; steps grow again
 * afterwards.  On failure the accepted point is the last that was reached.  Errors: NULL, STATE, RANGE, those
 * of ns_newton_try(). */
int ns_newton_advance(ns_newton *s, double t, double h);

/* The accepted point: *t, x (n), lambda (m), y (m), r (n); any may be NULL.  Errors: STATE (not started). */
int ns_newton_read(const ns_newton *s, double *t, double *x, double *lambda, double *y, double *r);

const ns_newton_counts *ns_newton_counts_of(const ns_newton *s);
const ns_fault *ns_newton_fault(const ns_newton *s); /* of the last call that failed */

#ifdef __cplusplus
}
#endif
#endif
