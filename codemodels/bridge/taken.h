/* bridge/taken.h - charge and energy that our devices took in since the first point that is shown. */
#ifndef BRIDGE_TAKEN_H
#define BRIDGE_TAKEN_H

#include "analysis.h"

/* a->taken, for the waveform that is made next.  A status. */
int ns_bridge_taken_make(ns_analysis *a, ns_waveform_integrals *out);
void ns_bridge_taken_clear(ns_analysis *a);

/* ngspice accepted a point, and shows it next if is_shown. */
void ns_bridge_taken_accept(ns_analysis *a, int is_shown);

/* The point to be shown has these integrals (NULL: none); part: of the way from the point shown last. */
void ns_bridge_taken_at(ns_analysis *a, const double *sums, double part);

/* Charge (C) and energy (J) of device k; NAN: not known. */
void ns_bridge_taken_show(const ns_analysis *a, int k, double *q, double *joule);

#endif
