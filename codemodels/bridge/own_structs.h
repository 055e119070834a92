/* bridge/own_structs.h - ngspice's own D, S, W and M as plain numbers.
 *
 * Their structs are seen by own_structs.c and own_mosfet.c alone. */
#ifndef BRIDGE_OWN_STRUCTS_H
#define BRIDGE_OWN_STRUCTS_H

#include "ngspice.h"
#include "pure/diode_law.h"

typedef enum ns_own_kind {
    OWN_NONE,
    OWN_DIODE,
    OWN_SWITCH,
    OWN_CURRENT_SWITCH,
    OWN_MOSFET,
    OWN_SIDIODE,
    OWN_PSWITCH
} ns_own_kind;

/* OWN_NONE: of a type that is not read (a D of CIDER). */
ns_own_kind ns_bridge_own_kind(const GENinstance *inst);

typedef struct ns_own_switch {
    int p, n;      /* equations of its nodes */
    int cp, cn;    /* of its control, of S */
    int branch;    /* of the current that controls it, of W */
    double vt, vh; /* V or A; vh is at least 0 */
    double early;  /* V or A: of a negative vh, by how much ngspice changes it before vt, in both directions
                      (own_early.c) */
    double ron, roff; /* ohm */
    int closed;       /* where the control does not say: ON was given, and counts */
    int held;         /* at its threshold, at the start (own_start.c) */
} ns_own_switch;

/* dc: in .op or .dc, where such a switch is closed from the second point on if it was in the point before;
 * else NULL.  uic: .tran begins with it. */
void ns_bridge_own_read_switch(const GENinstance *inst, const CKTcircuit *dc, ns_own_switch *s);
void ns_bridge_own_read_current_switch(const GENinstance *inst, const CKTcircuit *dc, int uic,
                                       ns_own_switch *s);

typedef struct ns_own_diode {
    int anode, cathode;
    int inside;               /* behind the series resistance; the anode, if there is none */
    double rs;                /* ohm */
    double bv;                /* V, INFINITY: none */
    double farads;            /* of the junction at 0 V; */
    double built_in, grading; /* V; exponent: at v backwards it is so many farads/(1 + v/built_in)^grading */
    double tt;                /* s: transit time, which is left out */
    int heats;                /* its temperature follows its losses */
    int is_default;           /* its model gives no law: none of is, n, rs */
    ns_diode_law law;         /* of the junction */
    ns_breakdown_law breakdown;
} ns_own_diode;

void ns_bridge_own_read_diode(const GENinstance *inst, ns_own_diode *d);

/* F: of the junction at v, V, backwards. */
double ns_bridge_own_junction(const ns_own_diode *d, double v);

/* Writes v and i where ngspice shows them (@s1[i], @d1[id]) and where its own load starts from, so that it
 * limits nothing.  v: of the switch, of the diode's junction, V; i: A. */
void ns_bridge_own_write_switch(GENinstance *inst, CKTcircuit *ckt, double v, double i, int on);
void ns_bridge_own_write_diode(GENinstance *inst, CKTcircuit *ckt, double v, double i);

#endif
