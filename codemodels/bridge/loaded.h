/* bridge/loaded.h - is the ngspice that loads nonsmooth.cm the one it was made for? */
#ifndef BRIDGE_LOADED_H
#define BRIDGE_LOADED_H

#include "ngspice.h"

/* When the library is loaded: gives ngspice copies of these device types, with room behind them, in which it
 * leaves marks.  *types become the copies. */
void ns_bridge_loaded_prepare(SPICEdev **types, int n);

/* 1 if ngspice is of another version or another configuration.  What is known when it loads the library was
 * said then; more is known before the first setup, in one line. */
int ns_bridge_loaded_is_other(void);

#endif
