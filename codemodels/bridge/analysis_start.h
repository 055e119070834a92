/* bridge/analysis_start.h - the start of an analysis, its resumption, its end. */
#ifndef BRIDGE_ANALYSIS_START_H
#define BRIDGE_ANALYSIS_START_H

#include "session.h"

/* All of these: OK, or a code after one line. */

/* Can the running ngspice, its options and all elements be dealt with? */
int ns_bridge_analysis_check(ns_session *s);

/* Leaves the operating point, or the start from rest (uic), in s->force.value. */
int ns_bridge_analysis_start(ns_session *s);

/* After `resume`: if something was altered, goes on from the present charges and fluxes. */
int ns_bridge_analysis_resume(ns_session *s);

void ns_bridge_analysis_end(ns_session *s);

#endif
