/* nonsmooth/theta.h - one theta-gamma step of a linear complementarity system, tried and accepted.
 *
 *   (T1)  W      = M - h theta A
 *   (T6)  x_free = W^-1 ( M x_k + h(1-theta) A x_k + h [theta b_k+1 + (1-theta) b_k]
 *                         + h(1-gamma) B lambda_k )
 *   (T7)  q      = C x_free + F z + e
 *   (P1)  -y in N_[l,u](lambda),   y = W_mlcp lambda + q,   W_mlcp = D + h gamma C W^-1 B
 *
 * Algebraic rows (ns_system_split) hold at t_k+1 whatever theta and gamma are.  The past enters only
 * through w = M x (charges and fluxes) and, for theta or gamma below 1, the slope of w.
 *
 * Inside one mode and for one h the step is one small dense matrix; it is built when first needed and
 * kept, so a step whose guards hold costs one matrix-vector product: nothing is factored, nothing
 * pivoted.  (P1) is solved only where a guard breaks.
 */
#ifndef NONSMOOTH_THETA_H
#define NONSMOOTH_THETA_H

#include <stddef.h>

#include "nonsmooth/system.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ns_theta ns_theta;

typedef struct ns_theta_options {
    double theta, gamma; /* theta in [0,1], gamma in (0,1]: below 1/2 an error of lambda grows by
                            (1-gamma)/gamma a step */
    size_t map_bytes;    /* bound on the memory of kept maps; 0: 128 MiB */
} ns_theta_options;

/* What the work of an object cost so far. */
typedef struct ns_counts {
    /* every stepper and marcher */
    long steps;    /* accepted */
    long trials;   /* steps tried */
    long events;   /* a stepper: accepted steps that changed the mode; a marcher: events resolved */
    long problems; /* (P1) solved by the MLCP solver */
    long pivots;   /* inside these problems */
    long factors;  /* factorisations, those of the solver included */
    long maps;     /* step matrices built */
    long evicted;  /* step matrices dropped for the memory bound */

    /* a marcher's */
    long jumps;          /* of charges or fluxes, resolved in no time (NS_EXACT counts none) */
    long jumps_by_steps; /* resolved by short steps, because the impulse problem gave no answer */
    long islands;        /* parts that share nothing but stiff sources and are stepped apart; 0: one whole */
    long checks;         /* points, events and ways between that were judged by the circuit's laws alone */
    long retries;        /* of them wrong, and gone again by another engine */
    long looks;          /* points at which thresholds that are watched were looked at; 0: none ever was */

    /* a marcher's, with NS_EXACT or NS_SPARSE */
    long modes;        /* modes that matrices or factors were made for */
    long searches;     /* intervals in which a guard that may break was looked for */
    long input_states; /* states carried for the inputs: one constant, slopes, exponentials, two a sine */
    long periods;      /* whole periods of the inputs, by one matrix product each */
    long predicted;    /* events at which a mode seen before was proved right, so that (P1) was not solved */
} ns_counts;

/* What a trial may do when a guard breaks. */
typedef enum ns_policy {
    NS_HOLD,   /* answer NS_GUARD: the caller wants to locate the event */
    NS_RESOLVE /* solve (P1) at the end of the step: event-capturing */
} ns_policy;

/* Makes a stepper for s, which must outlive it and not change.  On failure *out is NULL and fault (may
 * be NULL) says where.  Errors: those of ns_system_check(), RANGE (theta, gamma), MEMORY. */
int ns_theta_create(const ns_system *s, const ns_theta_options *o, ns_theta **out, ns_fault *fault);

/* Frees a stepper; NULL is allowed. */
void ns_theta_free(ns_theta *s);

/* Forgets the past: now w = M x is w0 (n values, one for each row of M: charges and fluxes just before
 * the start) and all slopes are zero.  closed (nc) gives the state of each command (0 open, 1 closed).
 * x, lambda, y are unknown until the first step is accepted.  Errors: NULL, NUMBER. */
int ns_theta_start(ns_theta *s, const double *w0, const unsigned char *closed);

/* Opens or closes commanded pairs from the next trial on.  closed: nc.  Errors: NULL. */
int ns_theta_command(ns_theta *s, const unsigned char *closed);

/* Tries a step of length h > 0 from the accepted point to inputs z (nz, at t_k+1).  implicit != 0: with
 * theta = gamma = 1 for this step (for jumps and starts).  The past is left alone: try again with any h.
 * NS_GUARD: policy NS_HOLD and a guard broke; or the commands changed and the old mode does not fit.
 * Errors: NULL, RANGE (h), those of ns_mlcp_solve(), OVERFLOW; *fault of ns_theta_fault(). */
int ns_theta_try(ns_theta *s, double h, const double *z, int implicit, ns_policy policy);

/* Makes the last successful trial the accepted point; cannot fail for numerical reasons.
 * Errors: STATE (no trial to accept). */
int ns_theta_accept(ns_theta *s);

/* The past as one block of ns_theta_past_size() doubles, to return to it later.  Includes the mode. */
size_t ns_theta_past_size(const ns_theta *s);
void ns_theta_save(const ns_theta *s, double *past);
void ns_theta_restore(ns_theta *s, const double *past);

/* The accepted point: x (n), lambda (m), y (m), any of which may be NULL.  Errors:
 * STATE (no step was accepted since the start), MEMORY, OVERFLOW (written, but not all of it is finite: the
 * fault names what is not). */
int ns_theta_read(ns_theta *s, double *x, double *lambda, double *y);

/* gx x of every command at the last successful trial (nc; 0 where gx is NULL); library-owned. */
const double *ns_theta_controls(const ns_theta *s);

/* The mode of the accepted point (m); library-owned. */
const ns_mode *ns_theta_mode(const ns_theta *s);

const ns_counts *ns_theta_counts(const ns_theta *s);
/* Bounds branch and bound in the problems (P1) to come, all together, by so many instructions, as
 * ns_mlcp_limit() counts them; INFINITY, as until then: no bound.  What is left of that: 0 as soon as a
 * search was cut off; what it took so far. */
void ns_theta_bound_search(ns_theta *s, double most);
double ns_theta_search_left(const ns_theta *s);
double ns_theta_searched(const ns_theta *s);
/* Estimates, in instructions: to make s, c->factors factors of its size, but those of (P1), and c->maps
 * matrices of steps, all of which are kept (c may also count what others made of s, such as the exact
 * engine); to solve the problems of events, of which nothing is kept. */
double ns_theta_matrix_work(const ns_theta *s, const ns_counts *c);
double ns_theta_problem_work(const ns_theta *s);
const ns_fault *ns_theta_fault(const ns_theta *s); /* of the last call that failed */

/* The problem at which the last ns_theta_try() failed, unreduced: n rows of equalities with the unknowns x
 * (bounds -inf, inf), then the m pairs.  *p gets arrays that are s's and hold until its next call; *h (may
 * be NULL) the length of the step.  Errors: NULL, STATE (it did not fail, or not at its problem). */
int ns_theta_problem(const ns_theta *s, ns_mlcp *p, double *h);

#ifdef __cplusplus
}
#endif
#endif
