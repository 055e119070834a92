/* bridge/pure/source_compare.h - is a source of ngspice what it was read as? */
#ifndef BRIDGE_SOURCE_COMPARE_H
#define BRIDGE_SOURCE_COMPARE_H

#include "nonsmooth/signal.h"

enum { SOURCE_INSTANTS = 64 }; /* ngspice's Newton loop, which is to load at each, ends after 100 loads */

/* Instants from 0 to tstop, s, at which n signals are to be compared: spread over the run, and in the middle
 * of each signal's first segments between corners.  Returns how many, at most SOURCE_INSTANTS. */
int ns_bridge_source_instants(const ns_signal *z, int n, double tstop, double *t);

/* 1 if `got` is z's value at t, or near enough to t that rounding of times (of up to tstop, s) explains the
 * difference.  *wanted: z's value. */
int ns_bridge_source_agrees(const ns_signal *z, double t, double tstop, double got, double *wanted);

/* The largest size of the values that z is made of, V or A. */
double ns_bridge_source_size(const ns_signal *z);

#endif
