/* bridge/own_supply.c - the current of a supply that feeds gates alone, whose charge is left out.
 *
 * Each time a gate is charged, its supply gives that charge: through a driver of switches, and through the D
 * of a bootstrap.  Here it is no charge at all, so such a V shows next to no current. */
#include "own_supply.h"

#include <math.h>

#include "models.h"
#include "own_way.h"
#include "report.h"

#include "spicelib/devices/res/resdefs.h"
#include "spicelib/devices/vsrc/vsrcdefs.h"

/* The charge of gates counts if it is more than this part of what the supply shows. */
static const double much = 0.5;

/* The ends of what may feed a gate: R, D, and contacts.  0: it is none of these. */
static int read_ends(const GENinstance *inst, int *p, int *n) {
    ns_own_diode d;
    switch (ns_bridge_models_letter(inst)) {
    case 'r':
        *p = ((const RESinstance *)inst)->RESposNode;
        *n = ((const RESinstance *)inst)->RESnegNode;
        return 1;
    case 'd':
        if (ns_bridge_own_kind(inst) != OWN_DIODE)
            return 0;
        ns_bridge_own_read_diode(inst, &d);
        *p = d.anode;
        *n = d.cathode;
        return 1;
    default:
        return ns_bridge_own_contacts(inst, p, n);
    }
}

/* A V of DC between this node and ground. */
static const VSRCinstance *find_dc(const CKTcircuit *ckt, int node) {
    for (NGTABLEPTR box = ckt->DEVnameHash->thread; box; box = box->thread_next) {
        const VSRCinstance *v = box->data;
        if (ns_bridge_models_letter(box->data) == 'v' && !v->VSRCcoeffsGiven && v->VSRCdcValue != 0.0 &&
            ((v->VSRCposNode == node && v->VSRCnegNode == 0) ||
             (v->VSRCnegNode == node && v->VSRCposNode == 0)))
            return v;
    }
    return NULL;
}

static void add(ns_own_way *w, int node) {
    if (node != 0 && node != w->goal && w->count < OWN_WAY_NODES && !ns_bridge_own_way_has(w, node))
        w->node[w->count++] = node;
}

/* The nearest one that feeds the gate; of a gate that it holds without a switch in between, none. */
static const VSRCinstance *find_supply(const CKTcircuit *ckt, const ns_own_mosfet *m) {
    ns_own_way w = {.ckt = ckt, .goal = m->source, .node = {m->gate}, .count = 1};
    for (int k = 0; k < w.count; k++) {
        const VSRCinstance *v = k > 0 ? find_dc(ckt, w.node[k]) : NULL;
        if (v)
            return v;
        for (NGTABLEPTR box = ckt->DEVnameHash->thread; box; box = box->thread_next) {
            int p, n;
            if (!read_ends(box->data, &p, &n))
                continue;
            if (p == w.node[k])
                add(&w, n);
            else if (n == w.node[k])
                add(&w, p);
        }
    }
    return NULL;
}

void ns_bridge_own_find_supplies(const CKTcircuit *ckt, ns_extract *ex) {
    for (int k = 0; k < ex->nowns; k++) {
        ns_own_taken *o = &ex->own[k];
        const VSRCinstance *v =
            o->kind == OWN_MOSFET && o->drive > o->mosfet.vth ? find_supply(ckt, &o->mosfet) : NULL;
        o->supply.inst = (const GENinstance *)v;
        o->supply.branch = v ? v->VSRCbranch : 0;
    }
}

void ns_bridge_own_count_supply(const ns_analysis *a, ns_own_taken *o, double seconds) {
    const int at = o->supply.inst ? a->unknown[o->supply.branch] : -1;
    const double amperes = at >= 0 ? fabs(a->x[at]) : 0.0;
    if (seconds > 0.0) {
        o->supply.shown += 0.5 * seconds * (amperes + o->supply.amperes);
        o->supply.seconds += seconds;
    }
    o->supply.amperes = amperes;
}

/* C that a gate takes each time, from the lowest to the highest voltage of its drive. */
static double charge_of(const ns_own_taken *o) {
    const double swing = o->drive - (isnan(o->driven.low) ? 0.0 : o->driven.low);
    return (o->mosfet.charge.source + o->mosfet.charge.drain) * swing +
           o->mosfet.charge.drain * o->seen.most_v;
}

/* A in the mean, of all gates that the supply of this one feeds. */
static double left_out_of(const ns_analysis *a, const ns_own_taken *o) {
    double sum = 0.0;
    for (int k = 0; k < a->ex.nowns; k++) {
        const ns_own_taken *other = &a->ex.own[k];
        if (other->supply.inst == o->supply.inst)
            sum += charge_of(other) * other->seen.openings;
    }
    return sum / o->supply.seconds;
}

int ns_bridge_own_note_supply(const ns_analysis *a) {
    static const double least = 1e-5; /* A: less is a trifle */
    for (int k = 0; k < a->ex.nowns; k++) {
        const ns_own_taken *o = &a->ex.own[k];
        if (!o->supply.inst || !(o->supply.seconds > 0.0))
            continue;
        const double left_out = left_out_of(a, o);
        if (!(left_out > fmax(least, much * o->supply.shown / o->supply.seconds)))
            continue;
        ns_bridge_report_note("%s feeds the gate of %s, whose charge is left out: its own models take some "
                              "%.2g A more from it in the mean than i(%s) shows",
                              o->supply.inst->GENname, o->inst->GENname, left_out, o->supply.inst->GENname);
        return 1;
    }
    return 0;
}
