/* bridge/own_voltage.h - the voltage between two nodes, as sources drive it through V, R and E. */
#ifndef BRIDGE_OWN_VOLTAGE_H
#define BRIDGE_OWN_VOLTAGE_H

#include "own_way.h"

ns_own_find_voltage ns_bridge_own_find_voltage;

/* v(gate,source) likewise; *ohm: that V hold the gate through, 0 if directly. */
int ns_bridge_own_find_gate(const CKTcircuit *ckt, int gate, int source, ns_own_range *r, double *share,
                            double *ohm);
/* Likewise while a switch, or an M, is closed. */
int ns_bridge_own_find_gate_by(const CKTcircuit *ckt, int gate, int source, const GENinstance *by,
                               ns_own_range *r, double *share);
/* ohm through which it is held then (by NULL: while all switches are open), by V or a C of so many F, against
 * its source or ground; NAN: it is not. */
double ns_bridge_own_gate_ohm(const CKTcircuit *ckt, int gate, int source, const GENinstance *by,
                              double farads);
/* v(gate,drain) likewise, of an M that is closed: its source has the potential of its drain.  by: another
 * switch, or M, that is closed as well, or NULL. */
int ns_bridge_own_find_gate_closed(const CKTcircuit *ckt, int gate, int source, int drain,
                                   const GENinstance *by, ns_own_range *r, double *share);

/* The nodes that V and R, with `coils` L too, connect with the first one and that V do not tie to the goal or
 * to ground; node: room for OWN_WAY_NODES.  Their number. */
int ns_bridge_own_find_nodes(const CKTcircuit *ckt, int first, int goal, int coils, int *node);

#endif
