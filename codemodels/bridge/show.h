/* bridge/show.h - what a user sees of a point: node voltages, branch currents, @ad1[i], the summary. */
#ifndef BRIDGE_SHOW_H
#define BRIDGE_SHOW_H

#include "native.h"

/* x (n of the system) -> value (neq), by equation number. */
void show_values(const engine *e, const double *x, double *value);

/* Currents, voltages and states of our devices at e->x, e->lambda -> their static variables: as soon as
 * someone asks, which show_devices() is for.  The point in e->x is the accepted one. */
void show_later(engine *e);
void show_devices(engine *e);

/* One line of counts; cpu in s. */
void show_summary(const engine *e, double cpu);

#endif
