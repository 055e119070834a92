/* bridge/own_way.h - ways along V, R, L, E, D, B and tables from a node to another one or to ground, and what
 * voltage is between their ends. */
#ifndef BRIDGE_OWN_WAY_H
#define BRIDGE_OWN_WAY_H

#include "own_drive.h"

enum { OWN_WAY_NODES = 60 }; /* that are tried */

/* v(p,m), as sources drive it, and *share: of the voltage of m in it.  is_control: it is that of an E.  0:
 * they do not say. */
typedef int ns_own_find_voltage(const CKTcircuit *ckt, int p, int m, int is_control, ns_own_range *r,
                                double *share);

/* A search from a node to `goal` or ground. */
typedef struct ns_own_way {
    const CKTcircuit *ckt;
    ns_own_find_voltage *find; /* of the control of an E; NULL: E are no wires */
    int goal;                  /* equation */
    int at_goal;               /* another one, which is at the potential of the goal; 0: none */
    const GENinstance *closed; /* a switch, or an M, that counts as a wire; NULL: none */
    int along_r;               /* resistors and inductors count as wires */
    int along_d;               /* so do D */
    double shunt;              /* ohm: so do resistors below it */
    int gate;                  /* its C count as none */
    double farads;             /* so do C from there on: what they hold stays; 0: none */
    int inside_b;              /* it is that of a node in so many B sources, one in the other */
    int inside_table;          /* it is that of the input of a TABLE: no further one is looked into */
    int met;                   /* the equation that was met: goal, or 0 */
    int node[OWN_WAY_NODES], count;
} ns_own_way;

/* 1 if ways from `here`, *r below the beginning, lead to the goal or ground; *r: by how much it is above
 * that. */
int ns_bridge_own_way(ns_own_way *w, int here, ns_own_range *r);

/* As the header says of this type: what a B source reads. */
ns_own_range_at ns_bridge_own_range_at;

/* The ends of a switch, or of the channel of an M; 0: it is none. */
int ns_bridge_own_contacts(const GENinstance *inst, int *p, int *n);

int ns_bridge_own_way_has(const ns_own_way *w, int node);

/* The nodes of inst, one of them `here`, and by how much the first is above the second; 0: it is no wire. */
int ns_bridge_own_wire(const ns_own_way *w, const GENinstance *inst, int here, int *p, int *n,
                       ns_own_range *gap);

/* r, and a gap more, from its first node to its second one or backwards. */
ns_own_range ns_bridge_own_add_gap(ns_own_range r, ns_own_range gap, int forwards);

#endif
