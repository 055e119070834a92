/* bridge/digital.h - XSPICE's digital parts: ngspice's event code runs as it is, and this is where it meets
 * the marcher.
 *
 * Thresholds of adc_bridge are watched by the marcher (ns_march_watch()); outputs of dac_bridge are inputs
 * that are replaced when their event comes (ns_march_set_input()); an event of ngspice's queue is a
 * timepoint. */
#ifndef BRIDGE_DIGITAL_H
#define BRIDGE_DIGITAL_H

#include "models.h"
#include "nonsmooth/march.h"

struct ns_extract_walk;

typedef struct ns_digital_control ns_digital_control; /* digital_control.h */

/* An analog input of an instance that puts out digital ones. */
typedef struct ns_digital_input {
    MIFinstance *inst;
    Mif_Port_Data_t *port;
    int p, n;                    /* equations whose difference it is; 0: none */
    int is_bridge;               /* of an adc_bridge: */
    double low, high;            /* V or A: 0 up to low, 1 from high on, between them unknown */
    int above_low, above_high;   /* the sides on which it is */
    ns_digital_control *control; /* of d_osc and d_pwm; else NULL */
} ns_digital_input;

/* An output of a dac_bridge. */
typedef struct ns_digital_output {
    const char *name;            /* of the instance */
    const Mif_Port_Data_t *port; /* the digital input that commands it */
    int p, n;                    /* the nodes that it is between */
    int input;                   /* of the system */
    int state;                   /* that it goes to, or has */
    double level[3];             /* V or A: of 0, 1 and unknown */
    double rise, fall;           /* s: from the level of 0 to that of 1, and back */
} ns_digital_output;

/* An instance of events alone whose delays are known. */
typedef struct ns_digital_part {
    MIFinstance *inst;
    double seconds; /* the shortest one, above 0 */
} ns_digital_part;

/* How long an event at a node takes to reach an instance whose delays are not, a dac_bridge for example. */
typedef struct ns_digital_lag {
    double seconds; /* INFINITY: it never does */
    int by_several; /* the sum of delays of several parts */
} ns_digital_lag;

typedef struct ns_digital {
    int ninputs, noutputs;
    ns_digital_input *input;   /* ninputs */
    ns_digital_output *output; /* noutputs */
    ns_threshold *threshold;   /* 2 ninputs: work */
    int nparts, nlags;
    ns_digital_part *part; /* nparts */
    ns_digital_lag *lag;   /* nlags: of each node of ngspice's event code */
    int crossed;           /* a threshold was crossed at ngspice's present point */
    double changed;        /* s: when an output changed last */
    double reach;          /* of a short step, in what ngspice can tell apart */
    int short_steps;       /* how many points come at once: at the start, after a crossing beside another */
} ns_digital;

/* Reads an instance of a code model of this name that has digital terminals; EXTRACT_REFUSED. */
int ns_bridge_digital_read(struct ns_extract_walk *w, MIFinstance *inst, const char *model);
/* Notes the delay of an instance of events alone; a status of the library. */
int ns_bridge_digital_note_delay(ns_digital *d, MIFinstance *inst, const char *model);
/* 0, 1 or 2 (unknown) at a digital input. */
int ns_bridge_digital_state(const Mif_Port_Data_t *port);
/* 1 if a dac_bridge whose bit is unknown drives this node. */
int ns_bridge_digital_is_undefined(const ns_digital *d, int node);
void ns_bridge_digital_clear(ns_digital *d);
static inline int ns_bridge_digital_is(const ns_digital *d) {
    return d->ninputs > 0 || d->noutputs > 0;
}
/* 1 if there is a d_osc or d_pwm. */
int ns_bridge_digital_has_controls(const ns_digital *d);
/* 1 if something else than an adc_bridge has an analog input: d_osc, for example. */
int ns_bridge_digital_has_others(const ns_digital *d);
/* 1 if no such part reads anything but a control that has not moved yet. */
int ns_bridge_digital_is_at_rest(const ns_digital *d);

#endif
