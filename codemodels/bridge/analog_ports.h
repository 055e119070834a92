/* bridge/analog_ports.h - what a reader of an analog code model works with: its ports as values, hidden
 * states. */
#ifndef BRIDGE_ANALOG_PORTS_H
#define BRIDGE_ANALOG_PORTS_H

#include "extract_walk.h"
#include "pure/piecewise.h"

typedef struct ns_analog {
    ns_extract_walk *w;
    MIFinstance *inst;
    const char *model;
    ns_piecewise p; /* of the instance; its name is `name` */
    char name[EXTRACT_NAME];
} ns_analog;

/* Port k of connection c as a value; NULL: a->p.status. */
ns_piecewise_value *ns_bridge_analog_input(ns_analog *a, int c, int k);
/* Puts v out at the only port of connection c.  Statuses. */
int ns_bridge_analog_output(ns_analog *a, int c, const ns_piecewise_value *v);
/* 1 if all currents that it senses are known. */
int ns_bridge_analog_is_ready(const ns_extract_walk *w, const MIFinstance *inst);

/* Parameters: a number, element k of an array, how many it has, whether it was given. */
double ns_bridge_analog_number(const ns_analog *a, int parameter);
double ns_bridge_analog_element(const ns_analog *a, int parameter, int k);
int ns_bridge_analog_size(const ns_analog *a, int parameter);
int ns_bridge_analog_given(const ns_analog *a, int parameter);

/* A number nobody uses for a node. */
int ns_bridge_analog_node(ns_analog *a);
/* The voltage of a node as a value. */
ns_piecewise_value *ns_bridge_analog_voltage(ns_analog *a, int node);
/* A state at this node: it starts at `ic` and changes by `rate` a second.  Statuses. */
int ns_bridge_analog_state(ns_analog *a, int node, double ic, const ns_piecewise_value *rate);

/* k (a + offset); limited to [low, high] (NAN: no limit). */
ns_piecewise_value *ns_bridge_analog_scaled(ns_analog *a, double k, const ns_piecewise_value *v,
                                            double offset);
ns_piecewise_value *ns_bridge_analog_limited(ns_analog *a, const ns_piecewise_value *v,
                                             const ns_piecewise_value *low, const ns_piecewise_value *high);

#endif
