/* src/inputs/input_states.h - the inputs as states of their own: z = Z v, v' = S v between corners.
 *
 * v_0 = 1.  A broken line that enters the circuit adds its value and, if it has ramps, its slope; a sine a
 * pair exp((-theta + i omega)(t - td)), which all sines of that frequency, damping and delay share; an
 * exponential one state each way.  Inputs that only drive commands as functions of time add nothing.
 */
#ifndef NS_INPUTS_INPUT_STATES_H
#define NS_INPUTS_INPUT_STATES_H

#include "time_events.h"

typedef enum ns_input_kind {
    NS_STATE_ONE,
    NS_STATE_VALUE,
    NS_STATE_SLOPE,
    NS_STATE_DECAY, /* this and what follows: waves */
    NS_STATE_COS,
    NS_STATE_SIN
} ns_input_kind;

typedef struct ns_input_state {
    ns_input_kind kind;
    int input;    /* VALUE, SLOPE: of this one */
    ns_wave wave; /* DECAY, COS, SIN: c, c, s of this one, */
    double omega; /* 2 pi wave.freq, 1/s, */
    double from;  /* and zero before */
} ns_input_state;

typedef struct ns_input_states {
    const ns_system *s;
    int nv;
    ns_input_state *state;  /* nv */
    double *Z;              /* nz*nv */
    double from;            /* holds from this time on */
    int output_only_inputs; /* inputs that unknowns follow and nothing else, */
    int *output_only_input; /* which */
} ns_input_states;

/* Of the inputs whose events those are.  Errors: MEMORY. */
int ns_inputs_states_create(const ns_system *s, const ns_time_events *events, ns_input_states **out);
void ns_inputs_states_free(ns_input_states *e); /* NULL is allowed */

/* 1 if the input, as it is in the system now, can be one of these states: its slope is one, or it has none.
 */
int ns_inputs_states_can_be(const ns_input_states *e, int input);

/* 1 if the input is one of these states: charges or guards may depend on it. */
int ns_inputs_states_has(const ns_input_states *e, int input);

/* v (nv) at t, from what ns_inputs_events_values() says there. */
void ns_inputs_states_at(const ns_input_states *e, double t, const double *z, const double *dz, double *v);

/* v becomes (1 - g S)^-1 v; v becomes exp(h S) v. */
void ns_inputs_states_stage(const ns_input_states *e, double g, double *v);
void ns_inputs_states_advance(const ns_input_states *e, double h, double *v);

/* Row i of S v. */
double ns_inputs_states_slope(const ns_input_states *e, int i, const double *v);

#endif
