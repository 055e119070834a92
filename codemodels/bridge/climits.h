/* bridge/climits.h - code models climit, whose limits are inputs: the upper one is not to be below the lower
 * one, where ngspice's code model has no value. */
#ifndef BRIDGE_CLIMITS_H
#define BRIDGE_CLIMITS_H

#include "extract_walk.h"

/* Connections and parameters of climit, in the order of its ifspec.ifs. */
enum { CLIMIT_IN, CLIMIT_UPPER, CLIMIT_LOWER, CLIMIT_OUT };
enum { CLIMIT_IN_OFFSET, CLIMIT_GAIN, CLIMIT_UPPER_DELTA, CLIMIT_LOWER_DELTA };

/* Statuses of the library. */
int ns_bridge_climits_keep(ns_extract *ex, const MIFinstance *inst);

/* At a point, value by equation: one line, and an error of ngspice, if limits are exchanged. */
int ns_bridge_climits_check(const ns_extract *ex, const double *value);

#endif
