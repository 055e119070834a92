/* bridge/taken.h - charge and energy that our devices took in since the first point that is shown. */
#ifndef BRIDGE_TAKEN_H
#define BRIDGE_TAKEN_H

#include "analysis.h"

/* a->taken, and *out for the waveform that is made next, or NULL.  march: where no waveform integrates on its
 * way, one of their own, which belongs to a->taken.  A status. */
int ns_bridge_taken_make(ns_analysis *a, ns_march *march, ns_waveform_integrals *out);
void ns_bridge_taken_clear(ns_analysis *a);

/* a takes the place of `from`, whose circuit was altered: sums go on from the point in from->x.  Before a is
 * started; from->x must be valid until it is. */
void ns_bridge_taken_continue(ns_analysis *a, const ns_analysis *from);

/* --- a marcher of their own --- */

/* NULL: there is none.  It is started like a->march, and then _begin() is called, if the next point is
 * shown. A status. */
ns_march *ns_bridge_taken_march(const ns_analysis *a);
int ns_bridge_taken_begin(ns_analysis *a);

/* --- points --- */

/* ngspice accepted the point at t, s, which a->x and a->mode are, and shows it next if is_shown. */
void ns_bridge_taken_accept(ns_analysis *a, double t, int is_shown);

/* The point to be shown has these integrals (NULL: none); part: of the way from the point shown last. */
void ns_bridge_taken_at(ns_analysis *a, const double *sums, double part);

/* Somebody wants to know them. */
void ns_bridge_taken_ask(ns_analysis *a);

/* Charge (C) and energy (J) of device k; NAN: not known. */
void ns_bridge_taken_show(const ns_analysis *a, int k, double *q, double *joule);

#endif
