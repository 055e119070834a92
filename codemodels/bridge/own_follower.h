/* bridge/own_follower.h - the lines that stand for the square law of an M that is a source follower. */
#ifndef BRIDGE_OWN_FOLLOWER_H
#define BRIDGE_OWN_FOLLOWER_H

#include "own_elements.h"

/* 1 if its source follows its gate; 0: a switch, also one that a drain or a shunt holds at its threshold. */
static inline int ns_bridge_own_is_follower(const ns_own_taken *o) {
    return o->follows == FOLLOWS_GATE || o->follows == FOLLOWS_AND_CLOSES;
}

/* 1 if its gate rests at what its current needs for a time that counts: of a follower, or while its drain
 * swings, or a shunt carries its current, and holds it there. */
static inline int ns_bridge_own_saturates(const ns_own_taken *o) {
    return o->follows != 0;
}

/* V: across the channel, without series resistance, at a current (A), where v(gate,drain) is `beyond` V
 * beyond vto. */
double ns_bridge_own_closed_voltage(const ns_own_mosfet *m, double beyond, double amperes);

/* ohm: of drain and source at its drive, without current. */
double ns_bridge_own_ohmic(const ns_own_taken *o);

/* ron and the lines of one whose mosfet, drive and follows are known. */
void ns_bridge_own_find_lines(ns_extract_walk *w, const GENinstance *inst, ns_own_taken *taken);

#endif
