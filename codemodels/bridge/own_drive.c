/* bridge/own_drive.c - the voltage at which a netlist drives the gate of a MOSFET: potentials of gate and
 * source, along V and R (of the source along L too), as ranges. */
#include <math.h>

#include "models.h"
#include "own_mosfet.h"

#include "spicelib/devices/ind/inddefs.h"
#include "spicelib/devices/res/resdefs.h"
#include "spicelib/devices/vcvs/vcvsdefs.h"
#include "spicelib/devices/vsrc/vsrcdefs.h"

enum { MOST_NODES = 60 }; /* that are tried */

typedef struct range {
    double low, high; /* V */
    int switches;     /* a PULSE or PWL is in it */
    int sources;      /* any V is */
} range;

/* A search from a node to `goal` or ground. */
typedef struct way {
    const CKTcircuit *ckt;
    int goal;        /* equation */
    int along_l;     /* inductors count as wires */
    int is_control;  /* it is that of the control of an E: no further E is looked into */
    int by_a_source; /* a way of resistors alone, as one that keeps a gate low, does not count */
    int met;         /* the equation that was met: goal, or 0 */
    int node[MOST_NODES], count;
} way;

static void extend(range *r, double value) {
    r->low = fmin(r->low, value);
    r->high = fmax(r->high, value);
}

static range range_of(const VSRCinstance *v) {
    const double *c = v->VSRCcoeffs;
    range r = {v->VSRCdcValue, v->VSRCdcValue, 0, 1};
    if (!v->VSRCcoeffsGiven || v->VSRCfunctionOrder < 2)
        return r;
    switch (v->VSRCfunctionType) {
    case PULSE:
    case EXP:
        return (range){fmin(c[0], c[1]), fmax(c[0], c[1]), v->VSRCfunctionType == PULSE, 1};
    case SINE:
        return (range){c[0] - fabs(c[1]), c[0] + fabs(c[1]), 0, 1};
    case PWL:
        r = (range){c[1], c[1], 1, 1};
        for (int k = 3; k < v->VSRCfunctionOrder; k += 2)
            extend(&r, c[k]);
        return r;
    default:
        return r;
    }
}

static int go_on(way *w, int here, range *r);

/* By how much an E raises its first node, as V and R drive its control; 0: they do not. */
static int read_vcvs(const way *w, const VCVSinstance *e, range *gap) {
    way control = {.ckt = w->ckt, .goal = e->VCVScontNegNode, .is_control = 1, .by_a_source = 1};
    range r = {0};
    if (w->is_control || !go_on(&control, e->VCVScontPosNode, &r) || control.met != e->VCVScontNegNode)
        return 0;
    const double low = e->VCVScoeff * r.low, high = e->VCVScoeff * r.high;
    *gap = (range){fmin(low, high), fmax(low, high), r.switches, 1};
    return 1;
}

/* The nodes of inst, and by how much the first is above the second; 0: it is no wire.  here: one of them, or
 * it is no matter. */
static int read_wire(const way *w, const GENinstance *inst, int here, int *p, int *n, range *gap) {
    *gap = (range){0};
    switch (ns_bridge_models_letter(inst)) {
    case 'v': {
        const VSRCinstance *v = (const VSRCinstance *)inst;
        *p = v->VSRCposNode;
        *n = v->VSRCnegNode;
        *gap = range_of(v);
        return 1;
    }
    case 'r': {
        const RESinstance *r = (const RESinstance *)inst;
        *p = r->RESposNode;
        *n = r->RESnegNode;
        return 1;
    }
    case 'l': {
        const INDinstance *l = (const INDinstance *)inst;
        *p = l->INDposNode;
        *n = l->INDnegNode;
        return w->along_l;
    }
    case 'e': {
        const VCVSinstance *e = (const VCVSinstance *)inst;
        *p = e->VCVSposNode;
        *n = e->VCVSnegNode;
        return (*p == here || *n == here) && read_vcvs(w, e, gap);
    }
    default:
        return 0;
    }
}

static int was_tried(const way *w, int node) {
    for (int k = 0; k < w->count; k++)
        if (w->node[k] == node)
            return 1;
    return 0;
}

static range add_gap(range r, range gap, int forwards) {
    r.low += forwards ? gap.low : -gap.high;
    r.high += forwards ? gap.high : -gap.low;
    r.switches |= gap.switches;
    r.sources |= gap.sources;
    return r;
}

/* 1 if ways from `here`, which is *r below the beginning, lead to the goal or to ground; *r: by how much the
 * beginning is above what was met. */
static int go_on(way *w, int here, range *r) {
    if (here == w->goal || here == 0) {
        w->met = here;
        return r->sources || !w->by_a_source;
    }
    if (was_tried(w, here) || w->count == MOST_NODES)
        return 0;
    w->node[w->count++] = here;
    for (NGTABLEPTR box = w->ckt->DEVnameHash->thread; box; box = box->thread_next) {
        range gap;
        int p, n;
        if (!read_wire(w, box->data, here, &p, &n, &gap) || (p != here && n != here) || p == n)
            continue;
        range further = add_gap(*r, gap, p == here);
        if (go_on(w, p == here ? n : p, &further)) {
            *r = further;
            return 1;
        }
    }
    return 0;
}

int ns_bridge_own_find_drive(const CKTcircuit *ckt, const ns_own_mosfet *m, ns_own_drive *drive) {
    way of_gate = {.ckt = ckt, .goal = m->source, .by_a_source = 1};
    way of_source = {.ckt = ckt, .along_l = 1};
    range gate = {0}, source = {0};
    if (!go_on(&of_gate, m->gate, &gate))
        return 0;
    if (of_gate.met == 0 && m->source != 0 && !go_on(&of_source, m->source, &source))
        return 0;
    *drive = m->sign > 0 ? (ns_own_drive){gate.low - source.high, gate.high - source.low, gate.switches}
                         : (ns_own_drive){source.low - gate.high, source.high - gate.low, gate.switches};
    return 1;
}
