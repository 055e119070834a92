/* bridge/once.h - one load a timepoint, where ngspice would solve twice. */
#ifndef BRIDGE_ONCE_H
#define BRIDGE_ONCE_H

#include "native.h"

/* After a point is shown: the next is to be loaded once. */
void once_arm(native *b);

/* At the begin of a load: 1 if it is the only one of its point; once_end() then leaves b->value as solution.
 */
int once_begin(native *b);
void once_end(native *b);

/* Takes back what once_arm() did. */
void once_forget(native *b);

#endif
