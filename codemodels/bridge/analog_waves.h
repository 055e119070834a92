/* bridge/analog_waves.h - XSPICE's controlled oscillators sine, triangle and square, where their control is
 * constant. */
#ifndef BRIDGE_ANALOG_WAVES_H
#define BRIDGE_ANALOG_WAVES_H

#include "analog_ports.h"

/* Statuses; a->p.why: what is wrong. */
int ns_bridge_analog_sine(ns_analog *a);
int ns_bridge_analog_triangle(ns_analog *a);
int ns_bridge_analog_square(ns_analog *a);

#endif
