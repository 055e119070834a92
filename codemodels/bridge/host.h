/* bridge/host.h - the program that ngspice runs in. */
#ifndef BRIDGE_HOST_H
#define BRIDGE_HOST_H

/* 1 if that is the program ngspice, whose streams are the user's; 0 if it is another one that uses the
 * library libngspice, which takes what ngspice prints through a callback. */
int ns_bridge_host_is_ngspice(void);

#endif
