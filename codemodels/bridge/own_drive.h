/* bridge/own_drive.h - the ranges of what sources put out, of which the drive of a gate is made. */
#ifndef BRIDGE_OWN_DRIVE_H
#define BRIDGE_OWN_DRIVE_H

#include "models.h"

#include "spicelib/devices/vsrc/vsrcdefs.h"

typedef struct ns_own_range {
    double low, high; /* V */
    int switches;     /* it goes from one to the other in steps: PULSE, PWL, a choice, a digital part */
    int sources;      /* any source is in it */
    double slope;     /* of B: with signals that are not known, at most */
    int amplifies;    /* that is no comparator's */
    int of_goal;      /* of B: all that is above the voltage of a node, so often */
} ns_own_range;

void ns_bridge_own_extend(ns_own_range *r, double value);
/* Of V and I, in V or A, by their DC value and, if they have a function (c: its numbers, else NULL), by that.
 */
ns_own_range ns_bridge_own_range_of_wave(double dc, int function, int order, const double *c);

/* The range of the voltage at an equation above that of another one (0: ground), as V alone set it, and B, of
 * which this is so many inside, or of a C that a D charges from such a voltage.  0: they do not. */
typedef int ns_own_range_at(const CKTcircuit *ckt, int inside, int eq, int above, ns_own_range *r);

/* Of a B source, in V or A, of a node in so many others; nodes in it have the range that `at` gives, but for
 * the goal (an equation), above which its value may be (r->of_goal 1).  0: it has none, or it is infinite. */
int ns_bridge_own_range_of_b(const CKTcircuit *ckt, const GENinstance *inst, ns_own_range_at *at, int inside,
                             int goal, ns_own_range *r);

/* Of the output of a dac_bridge, square, triangle or sine at this equation: its nodes, and the range between
 * them.  0: it has none. */
int ns_bridge_own_range_of_bridge(const GENinstance *inst, int here, int *p, int *n, ns_own_range *r);

/* Of the output of a pwl at this equation, as ngspice makes one of TABLE: its node, the equation of its
 * input, and the range of its y, with the largest slope.  0: it has none, or goes on beyond its ends. */
int ns_bridge_own_range_of_table(const GENinstance *inst, int here, int *p, int *in, ns_own_range *r);
/* r, of a table, switches or amplifies as its input does. */
void ns_bridge_own_follow(ns_own_range *r, const ns_own_range *in);

#endif
