/* bridge/digital_control.h - the control of d_osc and d_pwm between ngspice's points.
 *
 * ngspice lets d_osc take its control as constant from one point to the next, so its phase depends on where
 * the points are; the next edge is that of the control at the last point.  Here the model is called with the
 * constant control that leads to the same phase at its next edge as the control itself, as it is between the
 * points and, as a straight line, from there on. */
#ifndef BRIDGE_DIGITAL_CONTROL_H
#define BRIDGE_DIGITAL_CONTROL_H

#include "digital.h"

/* Makes the control of an input of an instance of this model; in->control stays NULL if it has none.  A
 * status of the library. */
int ns_bridge_digital_control_make(ns_digital_input *in, const char *model);
void ns_bridge_digital_control_free(ns_digital_control *c); /* NULL is allowed */

/* From t, s, on, where the control is v. */
void ns_bridge_digital_control_begin(ns_digital_control *c, const CKTcircuit *ckt, double t, double v);

/* ngspice accepts its point at t, s. */
void ns_bridge_digital_control_accept(ns_digital_control *c, double t);

/* The next edge, s; INFINITY: none.  queued: that of ngspice's queue, for a model that is called as it is. */
double ns_bridge_digital_control_edge(const ns_digital_control *c, double queued);

/* The next timepoint after t has to be at this time, s, at the latest: before the next edge, where that may
 * move.  at_corner: of a source. */
double ns_bridge_digital_control_until(const ns_digital_control *c, double t, int at_corner);

/* The last edge, s; the names of the instance and of its model. */
double ns_bridge_digital_control_last(const ns_digital_control *c, const char **name, const char **model);

/* 1 while its control is what it was at the start. */
int ns_bridge_digital_control_rests(const ns_digital_control *c);

#endif
