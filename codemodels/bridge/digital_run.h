/* bridge/digital_run.h - XSPICE's digital parts while an analysis runs; all without effect where there are
 * none. Statuses are those of the library. */
#ifndef BRIDGE_DIGITAL_RUN_H
#define BRIDGE_DIGITAL_RUN_H

#include "session.h"

/* The march was started, its point is in s->analysis.x: thresholds are watched from there on. */
int ns_bridge_digital_begin(ns_session *s);

/* An analog input at the point in s->analysis.x. */
double ns_bridge_digital_plain(const ns_session *s, const ns_digital_input *in);

/* 1 if an output changed since it was set: an operating point is to be found anew. */
int ns_bridge_digital_is_stale(const ns_session *s);

/* At the end of a load: hybrid instances get the values of force.value. */
void ns_bridge_digital_load(ns_session *s);

/* ngspice accepted its point, where the waveform ends: outputs are set, thresholds are watched anew.  STATE:
 * an output changes at a time that the march has passed. */
int ns_bridge_digital_accept(ns_session *s);

/* Reports that refusal (STATE) of ns_bridge_digital_accept().  Returns a code of ngspice. */
int ns_bridge_digital_fail_late(const ns_session *s);

/* The waveform was refused its next point, with this status: 1 if that was for a threshold crossed right
 * after the last one, or since it is beyond that time, and it may be asked again. */
int ns_bridge_digital_goes_on(ns_session *s, int status);

/* The time, s, of the next point at the latest: an event of ngspice's queue. */
double ns_bridge_digital_until(ns_session *s, double until, double closest);

/* digital_ahead.c: once, how long an event at each node takes to reach a dac_bridge; then the time, s, at
 * which an event of ngspice's queue may matter to the circuit. */
int ns_bridge_digital_look_ahead(ns_digital *d, const CKTcircuit *ckt);
double ns_bridge_digital_next_event(const ns_digital *d, const CKTcircuit *ckt);

#endif
