/* src/inputs/input_stages.h - inputs between their corners, as what implicit Euler makes of them; and when
 * commands that depend on time only change.  Nothing is looked at again before it has a corner. */
#ifndef NS_INPUTS_INPUT_STAGES_H
#define NS_INPUTS_INPUT_STAGES_H

#include "sparse/assemble.h"

/* From `from` up to `until`: z(from+tau) = value + slope tau + sum of Re c exp(s tau). */
typedef struct ns_exp_sum {
    double from, until, value, slope;
    int count;
    double c[2][2], s[2][2]; /* real, imaginary */
} ns_exp_sum;

typedef struct ns_input_stages {
    const ns_system *s;
    const ns_form *f;
    ns_exp_sum *wave; /* nz */
    double corner;    /* the first after the last t, of those that enter (P2) or controls of the state */
    double *review;   /* nc: up to when the instant is known; -INFINITY: not */
    double *instant;  /* nc: when it changes, INFINITY: not before review */
    double first;     /* of instants and reviews */
    int *curved;      /* those that enter and have exponentials or slopes */
    int ncurved;
    unsigned char *enters; /* nz */
    double *most;          /* nz: how large it ever was */
} ns_input_stages;

int ns_inputs_stages_create(const ns_system *s, const ns_form *f, ns_input_stages **out); /* Errors: MEMORY */
void ns_inputs_stages_free(ns_input_stages *in); /* NULL is allowed */

/* Forgets what it knows of times; then everything is looked at again. */
void ns_inputs_stages_reset(ns_input_stages *in);

/* Waves at t, from its right side. */
void ns_inputs_stages_at(ns_input_stages *in, double t);

/* z (nz) of stage i of steps g that begin at t, the time of the last ns_inputs_stages_at(): D^i v put through
 * the Euler step.  Returns 0 if all are zero. */
int ns_inputs_stages_stage(const ns_input_stages *in, double t, double g, int i, double *z);

/* D^(order+1) of inputs in Euler steps g, relative to the largest each ever was: what is left out is of that
 * size. */
double ns_inputs_stages_error(const ns_input_stages *in, double g, int order);

/* By how much time-only command c is beyond its threshold at inputs z, less a share tol of its terms. */
double ns_inputs_stages_excess(const ns_input_stages *in, int c, int closed, const double *z, double tol);

/* Looks for the instants of time-only commands after t; horizon: how far where nothing else bounds it. */
void ns_inputs_stages_bracket(ns_input_stages *in, double t, double horizon, const ns_mode *mode);

/* The next instant at which time-only command c changes, looked for as far as t at least; INFINITY: none. */
double ns_inputs_stages_change(ns_input_stages *in, int c, int closed, double t, double horizon);

#endif
