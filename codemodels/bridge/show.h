/* bridge/show.h - what a user sees of a point: node voltages, branch currents, @ad1[on], the summary. */
#ifndef BRIDGE_SHOW_H
#define BRIDGE_SHOW_H

#include "analysis.h"

/* a->x, a->lambda -> value (neq), by equation number: node voltages and branch currents; _currents: those of
 * our devices alone. */
void ns_bridge_show_values(const ns_analysis *a, double *value);
void ns_bridge_show_currents(const ns_analysis *a, double *value);

/* Currents, voltages and states of our devices at a->x, a->lambda -> their static variables: as soon as
 * someone asks, which ns_bridge_show_devices() is for.  The point in a->x is the accepted one. */
void ns_bridge_show_later(ns_analysis *a);
void ns_bridge_show_devices(ns_analysis *a);

/* One line of counts; cpu in s. */
void ns_bridge_show_summary(const ns_analysis *a, double cpu);

#endif
