/* src/system/active_inputs.h - which inputs anything that happens, or that is looked at, depends on. */
#ifndef NS_SYSTEM_ACTIVE_INPUTS_H
#define NS_SYSTEM_ACTIVE_INPUTS_H

#include "nonsmooth/system.h"

/* active (nz): 1 for inputs that a state, a pair with a law of its own or a command by the state may depend
 * on; 0 for those that unknowns only follow, like the gate voltage of a switch.  Errors: MEMORY. */
int ns_system_active_inputs(const ns_system *s, unsigned char *active);

/* The same and, in followed (nz), 1 for inputs that those unknowns and pairs follow that are looked at:
 * looked (n+m: x, lambda) is not 0.  Errors: MEMORY. */
int ns_system_followed_inputs(const ns_system *s, const unsigned char *looked, unsigned char *followed);

#endif
