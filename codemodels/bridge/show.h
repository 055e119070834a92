/* bridge/show.h - what a user sees of a point: node voltages, branch currents, @ad1[i], the summary. */
#ifndef BRIDGE_SHOW_H
#define BRIDGE_SHOW_H

#include "analysis.h"

/* x (n of the system) -> value (neq), by equation number. */
void ns_bridge_show_values(const ns_analysis *a, const double *x, double *value);

/* Currents, voltages and states of our devices at a->x, a->lambda -> their static variables: as soon as
 * someone asks, which ns_bridge_show_devices() is for.  The point in a->x is the accepted one. */
void ns_bridge_show_later(ns_analysis *a);
void ns_bridge_show_devices(ns_analysis *a);

/* One line of counts; cpu in s. */
void ns_bridge_show_summary(const ns_analysis *a, double cpu);

#endif
