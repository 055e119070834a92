/* bridge/refused.h - analyses that are not supported, and what to do instead. */
#ifndef BRIDGE_REFUSED_H
#define BRIDGE_REFUSED_H

#include "ngspice.h"

/* 1 if the present analysis solves with the matrix that we fill, and would show nonsense.  Those that load
 * one of their own for small signals (.ac, .disto) are refused there. */
int ns_bridge_refused_is(const CKTcircuit *ckt);

/* One line; returns the code that ends the analysis. */
int ns_bridge_refused_end(const CKTcircuit *ckt);

#endif
