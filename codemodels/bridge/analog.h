/* bridge/analog.h - XSPICE's analog code models that are piecewise linear, taken with sharp corners. */
#ifndef BRIDGE_ANALOG_H
#define BRIDGE_ANALOG_H

#include "extract_walk.h"

/* Reads an instance of the code model of this name.  Statuses of a reader. */
int ns_bridge_analog_read(ns_extract_walk *w, MIFinstance *inst, const char *model);

#endif
