/* bridge/many_points.h - one line about a run whose waveforms need millions of timepoints. */
#ifndef BRIDGE_MANY_POINTS_H
#define BRIDGE_MANY_POINTS_H

#include "analysis.h"

/* The waveform gave out point p on its way to stop, s. */
void ns_bridge_many_points_count(ns_analysis *a, const ns_waveform_point *p, double stop);
/* a takes the place of `from`, whose circuit was altered. */
void ns_bridge_many_points_continue(ns_analysis *a, const ns_analysis *from);
void ns_bridge_many_points_clear(ns_analysis *a);

#endif
