/* bridge/own_mosfet.h - ngspice's own M, of a model VDMOS or of level 1 or 3, as plain numbers. */
#ifndef BRIDGE_OWN_MOSFET_H
#define BRIDGE_OWN_MOSFET_H

#include "own_structs.h"

enum { OWN_HIDDEN = 4 }; /* nodes of a device that ngspice has added, at most */

typedef struct ns_own_mosfet {
    int sign;                      /* 1: n channel, -1: p channel */
    int drain, gate, source, bulk; /* equations; bulk is the source where there is none */
    double vth;                    /* V, of v(gate,source) times sign */
    double beta;                   /* A/V^2, multiplier and size included, at v(gate,source) = 0 */
    double theta, bends_from;      /* 1/V, V beyond vth: beta/(1 + theta (above - bends_from)) */
    double critical;               /* V: of vmax, at no voltage beyond vth; INFINITY: none */
    double triode; /* mtriode, or the bulk's part: by how much v(drain,source) counts below saturation */
    double shift, slope; /* V: of what is above vth, in weak inversion; slope 0: none */
    double series;       /* ohm, of drain and source */
    double leak;         /* ohm beside the channel; INFINITY: none */
    double gamma;        /* V^0.5: by how much the bulk raises vth */
    struct {
        double ohm, source;       /* rg; F to the source, */
        double drain, more, bend; /* to the drain, where that is high; how much more where it is low; 1/V */
    } charge;                     /* of the gate, which is left out */
    ns_own_diode body;            /* from source (or bulk) to drain, of an n channel */
    struct {
        int anode, cathode; /* equations; the same one: bulk is the source, and there is none */
    } at_source;            /* the other junction, between bulk and source */
    struct {
        int inside, outside; /* equations; 0: none */
    } hidden[OWN_HIDDEN];
    int heats;
} ns_own_mosfet;

void ns_bridge_own_read_mosfet(const GENinstance *inst, ns_own_mosfet *m);

/* What its model says of its channel where v(gate,source) is `above` V beyond vth: A/V^2; V, what remains for
 * the channel; A, of saturation; ohm, drain and source included, without current. */
double ns_bridge_own_gain(const ns_own_mosfet *m, double above);
double ns_bridge_own_overdrive(const ns_own_mosfet *m, double above);
double ns_bridge_own_saturation(const ns_own_mosfet *m, double above);
/* V beyond vth at which it saturates at a current (A); A, at a voltage `volts` between drain and source. */
double ns_bridge_own_needs(const ns_own_mosfet *m, double amperes);
double ns_bridge_own_channel(const ns_own_mosfet *m, double above, double volts);
double ns_bridge_own_resistance(const ns_own_mosfet *m, double above);

/* F between gate and drain, where that is v (V) above it. */
double ns_bridge_own_gate_to_drain(const ns_own_mosfet *m, double v);

/* @m1[id] at a point, and so that ngspice's own convergence test finds nothing.  amperes: into the drain.
 * value: by equation. */
void ns_bridge_own_write_mosfet(GENinstance *inst, CKTcircuit *ckt, double amperes, const double *value);

/* Of v(gate,source) times sign. */
typedef struct ns_own_drive {
    double low, high;     /* V */
    int switches;         /* PULSE, PWL, a choice of a B source or a digital part drives it */
    int follows;          /* one of the following */
    int by_r;             /* R alone, and no source, hold the gate */
    double opens, closes; /* ohm through which they discharge and charge it; NAN: that is not known */
} ns_own_drive;
enum {
    FOLLOWS_GATE = 1,   /* an n channel's gate is driven against ground, its source is not tied to that */
    FOLLOWS_AND_CLOSES, /* so, and high is of v(gate,drain), from which on it is closed */
    FOLLOWS_DRAIN,      /* its drain acts on its gate, and holds it there while it swings (own_feedback.h) */
    FOLLOWS_SHUNT       /* the drop of a shunt at its source holds it there while its current rises */
};

/* s: by how much the charge of its gate would have it closed longer (-: shorter), of a drain that swings by
 * so many volts.  Left out.  *ohm: through which most of that. */
double ns_bridge_own_late(const ns_own_mosfet *m, const ns_own_drive *drive, double volts, double *ohm);

/* What sources drive the gate with: the voltage that the network of V, R and an E of known control around it
 * gives it, against what V, R and L connect the source with.  0: that leads to neither ground nor each other.
 */
int ns_bridge_own_find_drive(const CKTcircuit *ckt, const ns_own_mosfet *m, ns_own_drive *drive);

#endif
