/* bridge/chattering.h - one line about a comparator in a loop without hysteresis. */
#ifndef BRIDGE_CHATTERING_H
#define BRIDGE_CHATTERING_H

#include "analysis.h"

/* The waveform gave out point p on its way to stop, s. */
void ns_bridge_chattering_count(ns_analysis *a, const ns_waveform_point *p, double stop);
void ns_bridge_chattering_clear(ns_analysis *a);

#endif
