/* bridge/own_pump.c - the gate of an M that a C drives and that a D clamps: as in a charge pump, and in
 * drivers that a capacitor isolates. */
#include "own_pump.h"

#include <math.h>

#include "models.h"
#include "own_touch.h"
#include "own_voltage.h"

#include "spicelib/devices/cap/capdefs.h"
#include "spicelib/devices/res/resdefs.h"

/* What touches the gate. */
typedef struct pump {
    const CKTcircuit *ckt;
    int gate, source;
    int driver;    /* the other end of its C */
    double farads; /* 0: it has none */
    int clamp;     /* the other end of its D */
    double volts;  /* that this D takes; NAN: there is none */
    int is_low;    /* it keeps the gate from falling below the other end */
    int bleeder;   /* the other end of an R; -1: there is none */
    double ohm;
    int other; /* something else, or more than one of a kind, is there */
} pump;

static void add_capacitor(pump *u, const CAPinstance *c) {
    u->other |= u->farads > 0.0;
    u->farads = c->CAPcapac * c->CAPm;
    u->driver = c->CAPposNode == u->gate ? c->CAPnegNode : c->CAPposNode;
}

/* A D to the source, or in the other direction, that is there to break down limits the gate, and counts no
 * more than that (own_drive.c) where another one clamps it. */
static void add_diode(pump *u, const GENinstance *inst) {
    static const double amperes = 1e-3;
    ns_own_diode d;
    ns_bridge_own_read_diode(inst, &d);
    u->other |= !isnan(u->volts) || isfinite(d.bv);
    u->volts = ns_bridge_diode_law_voltage(&d.law, amperes);
    u->is_low = d.cathode == u->gate;
    u->clamp = u->is_low ? d.anode : d.cathode;
}

static void add_resistor(pump *u, const RESinstance *r) {
    u->other |= u->bleeder >= 0;
    u->bleeder = r->RESposNode == u->gate ? r->RESnegNode : r->RESposNode;
    u->ohm = 1.0 / r->RESconduct;
}

static pump read_gate(const CKTcircuit *ckt, const ns_own_mosfet *m) {
    pump u = {.ckt = ckt, .gate = m->gate, .source = m->source, .volts = NAN, .bleeder = -1};
    for (NGTABLEPTR box = ckt->DEVnameHash->thread; box; box = box->thread_next) {
        const char letter = ns_bridge_models_letter(box->data);
        if (!ns_bridge_own_touches(box->data, u.gate))
            continue;
        if (letter == 'c')
            add_capacitor(&u, box->data);
        else if (letter == 'r')
            add_resistor(&u, box->data);
        else if (ns_bridge_own_kind(box->data) == OWN_DIODE)
            add_diode(&u, box->data);
        else
            u.other = 1;
    }
    return u;
}

/* The period of the PULSE that holds this node, s; 0: there is none. */
static double period_at(const CKTcircuit *ckt, int node) {
    enum { PERIOD = 6 };
    for (NGTABLEPTR box = ckt->DEVnameHash->thread; box; box = box->thread_next) {
        const VSRCinstance *v = box->data;
        if (ns_bridge_models_letter(box->data) == 'v' && (v->VSRCposNode == node || v->VSRCnegNode == node) &&
            v->VSRCfunctionType == PULSE && v->VSRCfunctionOrder > PERIOD)
            return v->VSRCcoeffs[PERIOD];
    }
    return 0.0;
}

/* An R beside the D takes little of what the C holds in a period. */
static int is_held(const pump *u) {
    static const double most = 0.1; /* of it */
    return u->bleeder < 0 || (u->bleeder == u->clamp && period_at(u->ckt, u->driver) > 0.0 &&
                              period_at(u->ckt, u->driver) < most * u->ohm * u->farads);
}

/* The voltage of a node above the source, as V hold both, or above ground; *met: 1 above the source. */
static int find_level(const pump *u, int node, int goal, ns_own_range *r, int *at_goal) {
    ns_own_way w = {.ckt = u->ckt, .find = ns_bridge_own_find_voltage, .goal = goal};
    *r = (ns_own_range){0};
    const int found = ns_bridge_own_way(&w, node, r);
    *at_goal = found && goal > 0 && w.met == goal;
    return found;
}

/* Of the D's other end above the source: that of a constant voltage. */
static int find_clamp(const pump *u, double *volts) {
    ns_own_range clamp, source = {0};
    int at_source, at_ground;
    if (!find_level(u, u->clamp, u->source, &clamp, &at_source) ||
        (!at_source && u->source > 0 && !find_level(u, u->source, 0, &source, &at_ground)) ||
        clamp.low != clamp.high || source.low != source.high)
        return 0;
    *volts = clamp.low - source.low;
    return 1;
}

int ns_bridge_own_find_pumped(const CKTcircuit *ckt, const ns_own_mosfet *m, ns_own_drive *drive) {
    const pump u = read_gate(ckt, m);
    ns_own_range driver;
    double clamp;
    int at_source;
    if (u.other || !(u.farads > 0.0) || isnan(u.volts) || !is_held(&u) ||
        !find_level(&u, u.driver, 0, &driver, &at_source) || driver.amplifies || !find_clamp(&u, &clamp))
        return 0;
    const double vf = u.bleeder < 0 ? 0.0 : u.volts; /* nothing flows any more, or what the R takes */
    const double swing = driver.high - driver.low, rest = clamp + (u.is_low ? -vf : vf);
    const double low = u.is_low ? rest : rest - swing, high = low + swing;
    *drive = (ns_own_drive){.low = m->sign > 0 ? low : -high,
                            .high = m->sign > 0 ? high : -low,
                            .switches = driver.switches,
                            .opens = NAN,
                            .closes = NAN};
    return 1;
}
