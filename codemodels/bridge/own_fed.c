/* bridge/own_fed.c - the currents that I, F, G and B feed into a node, as ranges. */
#include "own_fed.h"

#include <math.h>

#include "models.h"
#include "own_touch.h"

#include "spicelib/devices/asrc/asrcdefs.h"
#include "spicelib/devices/cccs/cccsdefs.h"
#include "spicelib/devices/isrc/isrcdefs.h"
#include "spicelib/devices/res/resdefs.h"
#include "spicelib/devices/vccs/vccsdefs.h"

static void scale_by(ns_own_range *r, double gain) {
    const double low = gain * r->low, high = gain * r->high;
    r->low = fmin(low, high);
    r->high = fmax(low, high);
    r->sources = 1;
}

/* The potential of a node, as V, E and B alone hold it. */
static int find_held(const ns_own_way *w, int node, ns_own_range *r) {
    ns_own_way by_v = {.ckt = w->ckt, .find = w->find, .inside_b = w->inside_b};
    *r = (ns_own_range){0};
    return ns_bridge_own_way(&by_v, node, r);
}

/* v(p,n) of two nodes that V hold, one of them at a constant voltage. */
static int find_held_between(const ns_own_way *w, int p, int n, ns_own_range *r) {
    ns_own_range low;
    if (!find_held(w, p, r) || !find_held(w, n, &low) || (r->low != r->high && low.low != low.high))
        return 0;
    *r = ns_bridge_own_add_gap(*r, low, 0);
    return 1;
}

/* The V whose current is this unknown. */
static const VSRCinstance *find_v(const CKTcircuit *ckt, int branch) {
    for (NGTABLEPTR box = ckt->DEVnameHash->thread; box; box = box->thread_next)
        if (ns_bridge_models_letter(box->data) == 'v' &&
            ((const VSRCinstance *)box->data)->VSRCbranch == branch)
            return box->data;
    return NULL;
}

/* The one R that carries all that `before` carries into this node; NULL: there are others. */
static const RESinstance *find_next(const CKTcircuit *ckt, const void *before, int node) {
    const RESinstance *found = NULL;
    for (NGTABLEPTR box = ckt->DEVnameHash->thread; node > 0 && box; box = box->thread_next) {
        if (box->data == before || !ns_bridge_own_touches(box->data, node))
            continue;
        if (found || ns_bridge_models_letter(box->data) != 'r')
            return NULL;
        found = box->data;
    }
    return found;
}

/* From one end of v along R in series, one at least, to a node that V hold; *ohm: what these have in all.  0:
 * they lead to none. */
static int follow_series(const ns_own_way *w, const VSRCinstance *v, int *node, double *ohm) {
    const void *before = v;
    ns_own_range r;
    for (int k = 0; k < OWN_WAY_NODES && (k == 0 || !find_held(w, *node, &r)); k++) {
        const RESinstance *next = find_next(w->ckt, before, *node);
        if (!next)
            return 0;
        *ohm += 1.0 / next->RESconduct;
        *node = next->RESposNode == *node ? next->RESnegNode : next->RESposNode;
        before = next;
    }
    return 1;
}

/* Of a V whose ends V hold: R at one of them lead from or to another node that they hold. */
static int find_beside(const ns_own_way *w, const VSRCinstance *v, int *from, int *to, double *ohm) {
    *from = *to = v->VSRCposNode;
    *ohm = 0.0;
    if (follow_series(w, v, from, ohm))
        return 1;
    *from = *to = v->VSRCnegNode;
    *ohm = 0.0;
    return follow_series(w, v, to, ohm);
}

/* The current of a V, from its first node through it to the second, where R in series carry it, between nodes
 * that V hold. */
static int find_current(const ns_own_way *w, int branch, ns_own_range *r) {
    const VSRCinstance *v = find_v(w->ckt, branch);
    ns_own_range gap = {0};
    int from, to;
    double ohm = 0.0;
    if (!v)
        return 0;
    if (!find_held(w, v->VSRCposNode, r)) {
        if (!ns_bridge_own_wire(w, &v->gen, v->VSRCposNode, &from, &to, &gap) ||
            !follow_series(w, v, &from, &ohm) || !follow_series(w, v, &to, &ohm))
            return 0;
    } else if (!find_beside(w, v, &from, &to, &ohm)) {
        return 0;
    }
    if (!find_held_between(w, from, to, r) || (gap.low != gap.high && r->low != r->high))
        return 0;
    *r = ns_bridge_own_add_gap(*r, gap, 0);
    scale_by(r, 1.0 / ohm);
    return 1;
}

/* The control of a G. */
static int find_control(const ns_own_way *w, const VCCSinstance *g, ns_own_range *r) {
    const int p = g->VCCScontPosNode, n = g->VCCScontNegNode;
    double share;
    if (find_held_between(w, p, n, r))
        return 1;
    *r = (ns_own_range){0};
    if (w->find && w->find(w->ckt, p, n, 1, r, &share))
        return 1;
    *r = (ns_own_range){0};
    if (!w->find || !w->find(w->ckt, n, p, 1, r, &share))
        return 0;
    scale_by(r, -1.0);
    return 1;
}

int ns_bridge_own_read_fed_ends(const GENinstance *inst, int *p, int *n) {
    switch (ns_bridge_models_letter(inst)) {
    case 'i': /* ngspice calls the second node of the line positive */
        *p = ((const ISRCinstance *)inst)->ISRCnegNode;
        *n = ((const ISRCinstance *)inst)->ISRCposNode;
        return 1;
    case 'f':
        *p = ((const CCCSinstance *)inst)->CCCSposNode;
        *n = ((const CCCSinstance *)inst)->CCCSnegNode;
        return 1;
    case 'g':
        *p = ((const VCCSinstance *)inst)->VCCSposNode;
        *n = ((const VCCSinstance *)inst)->VCCSnegNode;
        return 1;
    case 'b':
        *p = ((const ASRCinstance *)inst)->ASRCposNode;
        *n = ((const ASRCinstance *)inst)->ASRCnegNode;
        return ((const ASRCinstance *)inst)->ASRCtype != ASRC_VOLTAGE;
    default:
        return 0;
    }
}

int ns_bridge_own_find_fed(const ns_own_way *w, const GENinstance *inst, ns_own_range *r) {
    double gain = 1.0;
    int known = 1;
    *r = (ns_own_range){0};
    switch (ns_bridge_models_letter(inst)) {
    case 'i': {
        const ISRCinstance *i = (const ISRCinstance *)inst;
        *r = ns_bridge_own_range_of_wave(i->ISRCdcValue, i->ISRCfunctionType, i->ISRCfunctionOrder,
                                         i->ISRCcoeffsGiven ? i->ISRCcoeffs : NULL);
        gain = i->ISRCmGiven ? i->ISRCmValue : 1.0;
        break;
    }
    case 'f':
        known = find_current(w, ((const CCCSinstance *)inst)->CCCScontBranch, r);
        gain = ((const CCCSinstance *)inst)->CCCScoeff;
        break;
    case 'g':
        known = find_control(w, (const VCCSinstance *)inst, r);
        gain = ((const VCCSinstance *)inst)->VCCScoeff;
        break;
    default:
        known = ns_bridge_own_range_of_b(w->ckt, inst, ns_bridge_own_range_at, w->inside_b, 0, r);
        gain = ((const ASRCinstance *)inst)->ASRCm;
        break;
    }
    scale_by(r, gain);
    return known;
}
