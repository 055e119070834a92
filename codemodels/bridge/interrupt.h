/* bridge/interrupt.h - Ctrl-C while no point of ngspice's is at hand, at which it looks for that itself. */
#ifndef BRIDGE_INTERRUPT_H
#define BRIDGE_INTERRUPT_H

/* From _watch() to _leave() SIGINT is noted, and handed on to whom it was for; not where it would end the
 * program or is ignored. */
void ns_bridge_interrupt_watch(void);
int ns_bridge_interrupt_came(void);
void ns_bridge_interrupt_leave(void);

#endif
