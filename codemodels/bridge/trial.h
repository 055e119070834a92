/* bridge/trial.h - what the marcher is asked to try for ngspice's next timepoint, and accepts with it. */
#ifndef BRIDGE_TRIAL_H
#define BRIDGE_TRIAL_H

#include "session.h"

/* Forgets all: an analysis begins. */
void ns_bridge_trial_clear(ns_session *s);

/* The marcher was started or restarted: reads its point and time.  This and the next: OK, or a code after
 * one line. */
int ns_bridge_trial_begin(ns_session *s);

/* Tries to go on to time t, s. */
int ns_bridge_trial_to(ns_session *s, double t, ns_until until);

/* Reads the point of the trial, or the accepted one, into s->analysis. */
int ns_bridge_trial_read(ns_session *s);

/* The same, and into s->force.value: what ngspice's solve is to return. */
int ns_bridge_trial_read_values(ns_session *s);

/* The values of ngspice's present timepoint into s->force.value; anew: even if they are there. */
int ns_bridge_trial_load(ns_session *s, int anew);

/* Accepts the trial, as the point that ngspice sees at t. */
void ns_bridge_trial_accept(ns_session *s, double t);
void ns_bridge_trial_drop(ns_session *s);

/* ngspice accepted its point: accepts the trial if that was it.  1 at the first point of an analysis. */
int ns_bridge_trial_accept_loaded(ns_session *s);

/* When the right side of a jump at the accepted time is shown, on the way to t: ngspice's time must advance,
 * by well less than what is left to t. */
double ns_bridge_trial_right_side(const ns_session *s, double t);

/* Writes one line on why the marcher's last call failed; returns ngspice's code for status. */
int ns_bridge_trial_fail(const ns_session *s, int status);

#endif
