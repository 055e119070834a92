/* bridge/own_way.c - ways along V, R, L, E, D, B and tables from a node to another one or to ground, and
 * what voltage is between their ends. */
#include "own_way.h"

#include <math.h>

#include "models.h"
#include "own_mosfet.h"

#include "spicelib/devices/asrc/asrcdefs.h"
#include "spicelib/devices/cap/capdefs.h"
#include "spicelib/devices/ind/inddefs.h"
#include "spicelib/devices/res/resdefs.h"
#include "spicelib/devices/vcvs/vcvsdefs.h"
#include "spicelib/devices/vsrc/vsrcdefs.h"

/* A node in a B source may be that of another B, so often. */
enum { INSIDE_MAX = 4 };

static int has_capacitor(const CKTcircuit *ckt, int p, int n) {
    for (NGTABLEPTR box = ckt->DEVnameHash->thread; box; box = box->thread_next) {
        const CAPinstance *c = box->data;
        if (ns_bridge_models_letter(box->data) == 'c' &&
            ((c->CAPposNode == p && c->CAPnegNode == n) || (c->CAPposNode == n && c->CAPnegNode == p)))
            return 1;
    }
    return 0;
}

/* Of a supply that V make between the two nodes, or of a bootstrap: a D charges its C from a supply while the
 * other end is at ground. */
int ns_bridge_own_range_at(const CKTcircuit *ckt, int inside, int eq, int above, ns_own_range *r) {
    ns_own_way w = {.ckt = ckt, .inside_b = inside, .along_d = above > 0};
    ns_own_way between = {.ckt = ckt, .inside_b = inside, .goal = above};
    *r = (ns_own_range){0};
    if (above > 0 && ns_bridge_own_way(&between, eq, r) && between.met == above)
        return 1;
    *r = (ns_own_range){0};
    return (above == 0 || has_capacitor(ckt, eq, above)) && ns_bridge_own_way(&w, eq, r) &&
           (above == 0 || r->low == r->high);
}

/* By how much an E raises its first node, as V and R drive its control, from the one end of that or from the
 * other; 0: they do not. */
static int read_vcvs(const ns_own_way *w, const VCVSinstance *e, ns_own_range *gap) {
    double gain = e->VCVScoeff, share;
    ns_own_range r = {0};
    if (!w->find)
        return 0;
    if (!w->find(w->ckt, e->VCVScontPosNode, e->VCVScontNegNode, 1, &r, &share)) {
        gain = -gain;
        r = (ns_own_range){0};
        if (!w->find(w->ckt, e->VCVScontNegNode, e->VCVScontPosNode, 1, &r, &share))
            return 0;
    }
    const double low = gain * r.low, high = gain * r.high;
    *gap = (ns_own_range){fmin(low, high), fmax(low, high), r.switches, 1, 0.0, r.amplifies, 0};
    return 1;
}

/* A code model pwl, as ngspice makes of TABLE: a source to ground. */
static int read_table(const ns_own_way *w, const GENinstance *inst, int here, int *p, ns_own_range *gap) {
    ns_own_way way = {.ckt = w->ckt, .inside_table = 1};
    ns_own_range input = {0};
    int in;
    if (w->inside_b || w->inside_table || !ns_bridge_own_range_of_table(inst, here, p, &in, gap) ||
        !ns_bridge_own_way(&way, in, &input))
        return 0;
    ns_bridge_own_follow(gap, &input);
    gap->sources = 1;
    return 1;
}

int ns_bridge_own_contacts(const GENinstance *inst, int *p, int *n) {
    const ns_own_kind kind = ns_bridge_own_kind(inst);
    ns_own_switch s = {.p = -1, .n = -1};
    ns_own_mosfet m;
    if (kind == OWN_MOSFET) {
        ns_bridge_own_read_mosfet(inst, &m);
        s = (ns_own_switch){.p = m.drain, .n = m.source};
    }
    if (kind == OWN_SWITCH)
        ns_bridge_own_read_switch(inst, NULL, &s);
    else if (kind == OWN_CURRENT_SWITCH)
        ns_bridge_own_read_current_switch(inst, NULL, 0, &s);
    else if (ns_bridge_models_kind(inst) == KIND_SWITCH)
        s = (ns_own_switch){.p = ns_bridge_models_node((const MIFinstance *)inst, SWITCH_P),
                            .n = ns_bridge_models_node((const MIFinstance *)inst, SWITCH_N)};
    *p = s.p;
    *n = s.n;
    return s.p >= 0;
}

/* The nodes of inst, one of them `here`, and by how much the first is above the second; 0: it is no wire. */
int ns_bridge_own_wire(const ns_own_way *w, const GENinstance *inst, int here, int *p, int *n,
                       ns_own_range *gap) {
    *gap = (ns_own_range){0};
    if (inst == w->closed)
        return ns_bridge_own_contacts(inst, p, n);
    switch (ns_bridge_models_letter(inst)) {
    case 'v': {
        const VSRCinstance *v = (const VSRCinstance *)inst;
        *p = v->VSRCposNode;
        *n = v->VSRCnegNode;
        *gap = ns_bridge_own_range_of_wave(v->VSRCdcValue, v->VSRCfunctionType, v->VSRCfunctionOrder,
                                           v->VSRCcoeffsGiven ? v->VSRCcoeffs : NULL);
        return 1;
    }
    case 'r': {
        const RESinstance *r = (const RESinstance *)inst;
        *p = r->RESposNode;
        *n = r->RESnegNode;
        return w->along_r || r->RESconduct * w->shunt > 1.0;
    }
    case 'c': {
        const CAPinstance *c = (const CAPinstance *)inst;
        *p = c->CAPposNode;
        *n = c->CAPnegNode;
        return w->farads > 0.0 && c->CAPcapac * c->CAPm >= w->farads && *p != w->gate && *n != w->gate;
    }
    case 'l': {
        const INDinstance *l = (const INDinstance *)inst;
        *p = l->INDposNode;
        *n = l->INDnegNode;
        return w->along_r;
    }
    case 'e': {
        const VCVSinstance *e = (const VCVSinstance *)inst;
        *p = e->VCVSposNode;
        *n = e->VCVSnegNode;
        return (*p == here || *n == here) && read_vcvs(w, e, gap);
    }
    case 'b': {
        const ASRCinstance *b = (const ASRCinstance *)inst;
        *p = b->ASRCposNode;
        *n = b->ASRCnegNode;
        if ((*p != here && *n != here) || b->ASRCtype != ASRC_VOLTAGE || w->inside_b >= INSIDE_MAX ||
            !ns_bridge_own_range_of_b(w->ckt, inst, ns_bridge_own_range_at, w->inside_b,
                                      *n == 0 ? w->goal : 0, gap))
            return 0;
        *n = gap->of_goal ? w->goal : *n;
        return *p == here || *n == here;
    }
    case 'a':
        *n = 0;
        return ns_bridge_own_range_of_bridge(inst, here, p, n, gap) || read_table(w, inst, here, p, gap);
    case 'd': {
        ns_own_diode d = {0};
        if (w->along_d && ns_bridge_own_kind(inst) == OWN_DIODE)
            ns_bridge_own_read_diode(inst, &d);
        *p = d.cathode;
        *n = d.anode;
        return d.cathode > 0 && d.cathode == here;
    }
    default:
        return 0;
    }
}

int ns_bridge_own_way_has(const ns_own_way *w, int node) {
    for (int k = 0; k < w->count; k++)
        if (w->node[k] == node)
            return 1;
    return 0;
}

ns_own_range ns_bridge_own_add_gap(ns_own_range r, ns_own_range gap, int forwards) {
    r.low += forwards ? gap.low : -gap.high;
    r.high += forwards ? gap.high : -gap.low;
    r.switches |= gap.switches;
    r.sources |= gap.sources;
    r.amplifies |= gap.amplifies;
    return r;
}

/* 1 if ways from `here`, *r below the beginning, lead to the goal or ground; *r: by how much it is above
 * that. */
int ns_bridge_own_way(ns_own_way *w, int here, ns_own_range *r) {
    if (here == w->goal || here == 0 || here == w->at_goal) {
        w->met = here == 0 ? 0 : w->goal;
        return 1;
    }
    if (ns_bridge_own_way_has(w, here) || w->count == OWN_WAY_NODES)
        return 0;
    w->node[w->count++] = here;
    for (NGTABLEPTR box = w->ckt->DEVnameHash->thread; box; box = box->thread_next) {
        ns_own_range gap;
        int p, n;
        if (!ns_bridge_own_wire(w, box->data, here, &p, &n, &gap) || (p != here && n != here) || p == n)
            continue;
        ns_own_range further = ns_bridge_own_add_gap(*r, gap, p == here);
        if (ns_bridge_own_way(w, p == here ? n : p, &further)) {
            *r = further;
            return 1;
        }
    }
    return 0;
}
