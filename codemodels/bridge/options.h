/* bridge/options.h - the options of a run, from the instance of model `nonsmooth`. */
#ifndef BRIDGE_OPTIONS_H
#define BRIDGE_OPTIONS_H

#include "models.h"
#include "nonsmooth/march.h"

typedef struct ns_bridge_options {
    ns_method method;
    double h; /* s, 0: a sixteenth of ngspice's longest step */
    double theta, gamma;
    double reltol; /* 0: not given */
    int verbose;
    int corners;              /* ngspice gets time points at events and corners of sources */
    const MIFinstance *given; /* whose options these are; NULL: none given */
} ns_bridge_options;

void ns_bridge_options_default(ns_bridge_options *o);

/* Reads inst into o.  Returns OK, or says what is wrong in line (size bytes) and returns E_PARMVAL or
 * E_UNSUPP. */
int ns_bridge_options_read(const MIFinstance *inst, ns_bridge_options *o, char *line, size_t size);

/* As a netlist names it. */
const char *ns_bridge_options_method(ns_method method);

/* The file for a step that fails, as the model has it now; NULL: none. */
const char *ns_bridge_options_dump(const ns_bridge_options *o);

#endif
