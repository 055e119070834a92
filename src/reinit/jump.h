/* src/reinit/jump.h - a jump found by the short steps that resolve an event or a start: taken in no time
 * instead. */
#ifndef NS_REINIT_JUMP_H
#define NS_REINIT_JUMP_H

#include "base/clock.h"
#include "theta/theta_internal.h"

/* One event or start: what the stepper was before the short steps, and after them. */
typedef struct ns_jump {
    double *block;          /* all arrays of numbers below */
    double *before, *after; /* the stepper's past before the short steps; after them */
    ns_clock left;          /* the time before them */
    double *w, *rate;       /* r: charges and fluxes before them; the absolute values of their rates */
    double *last, last_t;   /* r: w before the last short step; its time, s */
    double *x;              /* n+m: x, lambda after the short steps */
    double *z, *slope;      /* nz: inputs at left.t, and their slopes */
    ns_impulse to;          /* right side of the jump: x, lambda, X, Lambda, mode */
    ns_mode *mode;          /* m */
    long jumps,
        refused; /* taken so far; so often the impulse problem gave no answer, and the steps were kept */
} ns_jump;

/* Sizes are those of s.  Errors: MEMORY (then free it all the same). */
int ns_reinit_jump_create(const ns_theta *s, ns_jump *j);
void ns_reinit_jump_free(ns_jump *j);

/* The short steps of an event begin at this point of s; the last of them begins at t. */
void ns_reinit_jump_begin(ns_jump *j, const ns_theta *s, ns_clock now);
void ns_reinit_jump_last_step(ns_jump *j, const ns_theta *s, double t);

/* If the short steps from ns_reinit_jump_begin() to *now showed a jump, s is put to its right side (J1)-(J4),
 * *now to where they began, and z (nz) to the inputs there.  If the impulse problem has no answer the short
 * steps stay.  h: longest step, s.  Errors: MEMORY. */
int ns_reinit_jump_commit(ns_jump *j, ns_theta *s, double h, ns_clock *now, double *z);

#endif
