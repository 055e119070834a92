/* bridge/own_models.h - what ngspice makes of D, S and W in its PSpice and LTspice modes: code models
 * sidiode, pswitch and aswitch, taken as ideal. */
#ifndef BRIDGE_OWN_MODELS_H
#define BRIDGE_OWN_MODELS_H

#include "extract_walk.h"

/* 1 if `model` is one of them; *status is what its reader says. */
int ns_bridge_own_models(ns_extract_walk *w, MIFinstance *inst, const char *model, int *status);

#endif
