/* src/inputs/input_stages.h - inputs between their corners, as what implicit Euler makes of them; and when
 * commands that depend on time only change. */
#ifndef NS_INPUTS_INPUT_STAGES_H
#define NS_INPUTS_INPUT_STAGES_H

#include "time_events.h"

/* From `from` up to `until`: z(from+tau) = value + slope tau + sum of Re c exp(s tau). */
typedef struct ns_exp_sum {
    double from, until, value, slope;
    int count;
    double c[NS_TERMS][2], s[NS_TERMS][2]; /* real, imaginary */
} ns_exp_sum;

typedef struct ns_input_stages {
    const ns_system *s;
    /* inputs */
    int *terms;                     /* nz: how many terms each has (waves.h), */
    ns_wave_term (*term)[NS_TERMS]; /* nz: these, */
    ns_wave (*term_wave)[NS_TERMS]; /* nz: and the wave of each */
    unsigned char *enters;          /* nz: more than commands of time depend on it */
    double *max_abs;                /* nz: how large it ever was */
    /* where they were last expanded */
    ns_exp_sum *sum; /* nz */
    double late;     /* the steps begin so much later, s: what rounding took from that time */
    double corner;   /* the first after it, of those that enter */
    int *curved;     /* those that enter and have exponentials or slopes */
    int ncurved;
    /* commands that depend on time only */
    ns_time_events *commands; /* their instants */
    unsigned char *closed;    /* nc: work */
    double first;             /* the next of them; INFINITY: not soon; -INFINITY: to be looked for anew */
} ns_input_stages;

int ns_inputs_stages_create(const ns_system *s, ns_input_stages **out); /* Errors: MEMORY */
void ns_inputs_stages_free(ns_input_stages *in);                        /* NULL is allowed */

/* Expansions and instants are computed anew when next asked for: time goes back, or switches were set. */
void ns_inputs_stages_reset(ns_input_stages *in);

/* An input of the system was replaced by another broken line.  Errors: MEMORY. */
int ns_inputs_stages_renew(ns_input_stages *in, int input);

/* Expands the inputs at t, from its right side. */
void ns_inputs_stages_at(ns_input_stages *in, double t);
/* Steps begin this much after t, s: what rounding took from the time. */
static inline void ns_inputs_stages_late(ns_input_stages *in, double late) {
    in->late = late;
}

/* z (nz) of stage i of steps g that begin at t, the time of the last ns_inputs_stages_at(): D^i v put through
 * the Euler step.  Returns 0 if all are zero. */
int ns_inputs_stages_stage(const ns_input_stages *in, double t, double g, int i, double *z);

/* How many times its largest real value the steepest straight piece reaches in the time g. */
double ns_inputs_stages_steepest(const ns_input_stages *in, double g);

/* D^(order+1) of inputs in Euler steps g, relative to the largest each ever was: what is left out is of that
 * size. */
double ns_inputs_stages_error(const ns_input_stages *in, double g, int order);

/* in->first: the next instant at which time-only commands change.  They are as in mode, at the right side of
 * t, where nothing is known yet.  h: no step from t is longer. */
void ns_inputs_stages_find_command(ns_input_stages *in, double t, double h, const ns_mode *mode);

/* Flips the modes of time-only commands that change up to t, after ns_inputs_stages_find_command(); how many,
 * and their instants are added to *sum. */
int ns_inputs_stages_flip_commands(ns_input_stages *in, double t, ns_mode *mode, double *sum);

#endif
