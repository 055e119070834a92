/* src/system/active_inputs.h - which inputs anything that happens depends on. */
#ifndef NS_SYSTEM_ACTIVE_INPUTS_H
#define NS_SYSTEM_ACTIVE_INPUTS_H

#include "nonsmooth/system.h"

/* active (nz): 1 for inputs that a state, a pair with a law of its own or a command by the state may depend
 * on; 0 for those that unknowns only follow, like the gate voltage of a switch.  Errors: MEMORY. */
int ns_system_active_inputs(const ns_system *s, unsigned char *active);

#endif
