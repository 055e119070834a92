/* bridge/own_current.h - the current at which the curve of each D is read where option id is not given: its
 * own, as a first pass along the run finds it. */
#ifndef BRIDGE_OWN_CURRENT_H
#define BRIDGE_OWN_CURRENT_H

#include "analysis.h"

/* The D of an element that was taken: in the circuit, -1: it has none. */
int ns_bridge_own_diode_element(const ns_own_taken *o);

/* Where two lines stand for a D: adds to the current along the first one that along the second. */
void ns_bridge_own_add_beyond(const ns_analysis *a, const ns_own_taken *o, const ns_mode *mode, double *i);

/* And its slope above the voltage where the second one begins, ohm. */
double ns_bridge_own_slope_beyond(const ns_own_taken *o);

/* 1 if it is a follower, and its source is where its gate has it, not at its drain. */
int ns_bridge_own_is_following(const ns_analysis *a, const ns_own_taken *o);

/* 1 if the analysis, which is of .tran, has a D whose current is to be found. */
int ns_bridge_own_wants_currents(const ns_analysis *a);

/* The march of the pass, of a run up to stop, s: by the default engine, whichever the options ask for. */
int ns_bridge_own_pass_march(const ns_analysis *a, double stop, ns_march **march);

/* s: how far a brief pass is to go before one to stop; stop: none is worth it. */
double ns_bridge_own_brief_stop(const ns_analysis *a, double stop);

/* Integrates that march, which was started, to the time stop, s, or as far as is worth it (brief: less is);
 * what flows from start (s) on counts, where it comes to that, in place of what an earlier pass found.
 * Failures and an interrupt end the pass; errors: MEMORY. */
int ns_bridge_own_find_currents(ns_analysis *a, ns_march *march, double start, double stop, int brief,
                                ns_own_found *currents);
void ns_bridge_own_forget_currents(ns_own_found *currents);

/* own_current_alike.c. */

/* D of one model that carry nearly the same are taken alike, on whichever sides of a rounding their currents
 * are: phases of one converter share its current equally.  grouped: zeros, one of each current. */
void ns_bridge_own_round_in_groups(ns_own_found *currents, unsigned char *grouped);
/* The largest current (A) that was found of another D, or junction of an M, between the same two nodes; 0:
 * there is none.  It is the guess for a D that was found without a current: with a smaller guess its vf would
 * be lower than that of the others, and it would take their whole current. */
double ns_bridge_own_parallel_current(const ns_own_found *currents, const GENinstance *inst);

#endif
