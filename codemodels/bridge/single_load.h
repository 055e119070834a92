/* bridge/single_load.h - one load a timepoint, where ngspice would solve twice. */
#ifndef BRIDGE_SINGLE_LOAD_H
#define BRIDGE_SINGLE_LOAD_H

#include "session.h"

/* After a point is shown: the next is to be loaded once. */
void ns_bridge_single_load_arm(ns_session *s);

/* At the begin of a load: 1 if it is the only one of its point; ns_bridge_single_load_end() then leaves
 * s->force.value as solution.
 */
int ns_bridge_single_load_begin(ns_session *s);
void ns_bridge_single_load_end(ns_session *s);

/* Takes back what ns_bridge_single_load_arm() did. */
void ns_bridge_single_load_forget(ns_session *s);

#endif
