/* src/engine/exo.h - the inputs as states of their own: z = Z v, v' = S v between corners.
 *
 * v_0 = 1.  A broken line that enters the circuit adds its value and, if it has ramps, its slope; a sine a
 * pair exp((-theta + i omega)(t - td)), which all sines of that frequency, damping and delay share; an
 * exponential one state each way.  Inputs that only drive commands as functions of time add nothing.
 */
#ifndef NS_EXO_H
#define NS_EXO_H

#include "nonsmooth/system.h"

typedef enum ns_exo_kind {
    NS_EXO_ONE,
    NS_EXO_VALUE,
    NS_EXO_SLOPE,
    NS_EXO_DECAY,
    NS_EXO_COS,
    NS_EXO_SIN
} ns_exo_kind;

typedef struct ns_exo_state {
    ns_exo_kind kind;
    int input;           /* VALUE, SLOPE: of this one */
    double decay, omega; /* DECAY, COS, SIN: 1/s, */
    double from;         /* which are zero before */
} ns_exo_state;

typedef struct ns_exo {
    const ns_system *s;
    int nv;
    ns_exo_state *state; /* nv */
    double *Z;           /* nz*nv */
    double from;         /* holds from this time on */
    int mutes;           /* inputs that unknowns follow and nothing else, */
    int *mute;           /* which */
} ns_exo;

/* input (entering): the inputs that enter.  Errors: MEMORY. */
int ns_exo_create(const ns_system *s, int entering, const int *input, ns_exo **out);
void ns_exo_free(ns_exo *e); /* NULL is allowed */

/* v (nv) at t, from what ns_schedule_inputs() says there. */
void ns_exo_at(const ns_exo *e, double t, const double *z, const double *dz, double *v);

/* v becomes (1 - g S)^-1 v; v becomes exp(h S) v. */
void ns_exo_stage(const ns_exo *e, double g, double *v);
void ns_exo_advance(const ns_exo *e, double h, double *v);

/* Row i of S v. */
double ns_exo_slope(const ns_exo *e, int i, const double *v);

#endif
