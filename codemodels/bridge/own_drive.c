/* bridge/own_drive.c - the voltage at which a netlist drives the gate of a MOSFET: potentials of gate and
 * source, along V and R (of the source along L too), as ranges. */
#include <math.h>

#include "models.h"
#include "own_mosfet.h"

#include "spicelib/devices/ind/inddefs.h"
#include "spicelib/devices/res/resdefs.h"
#include "spicelib/devices/vsrc/vsrcdefs.h"

enum { DEEPEST = 12 }; /* elements in series */

typedef struct range {
    double low, high; /* V */
    int switches;     /* a PULSE or PWL is in it */
} range;

/* A way that is being tried: from a node to `goal` or ground. */
typedef struct way {
    const CKTcircuit *ckt;
    int goal;    /* equation */
    int along_l; /* inductors count as wires */
    int met;     /* the equation that was met: goal, or 0 */
    int node[DEEPEST + 1], count;
} way;

static void extend(range *r, double value) {
    r->low = fmin(r->low, value);
    r->high = fmax(r->high, value);
}

static range range_of(const VSRCinstance *v) {
    const double *c = v->VSRCcoeffs;
    range r = {v->VSRCdcValue, v->VSRCdcValue, 0};
    if (!v->VSRCcoeffsGiven || v->VSRCfunctionOrder < 2)
        return r;
    switch (v->VSRCfunctionType) {
    case PULSE:
    case EXP:
        return (range){fmin(c[0], c[1]), fmax(c[0], c[1]), v->VSRCfunctionType == PULSE};
    case SINE:
        return (range){c[0] - fabs(c[1]), c[0] + fabs(c[1]), 0};
    case PWL:
        r = (range){c[1], c[1], 1};
        for (int k = 3; k < v->VSRCfunctionOrder; k += 2)
            extend(&r, c[k]);
        return r;
    default:
        return r;
    }
}

/* The nodes of inst, and by how much the first is above the second; 0: it is no wire. */
static int read_wire(const way *w, const GENinstance *inst, int *p, int *n, range *gap) {
    *gap = (range){0.0, 0.0, 0};
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
    default:
        return 0;
    }
}

static int is_on_way(const way *w, int node) {
    for (int k = 0; k < w->count; k++)
        if (w->node[k] == node)
            return 1;
    return 0;
}

/* 1 if the way from its last node on leads to the goal or, if it does not, to ground; *r: by how much its
 * beginning is above what was met. */
static int go_on(way *w, range *r) {
    const int here = w->node[w->count - 1];
    if (here == w->goal || here == 0) {
        w->met = here;
        return 1;
    }
    for (NGTABLEPTR box = w->ckt->DEVnameHash->thread; box && w->count <= DEEPEST; box = box->thread_next) {
        range gap;
        int p, n;
        if (!read_wire(w, box->data, &p, &n, &gap) || (p != here && n != here) || p == n)
            continue;
        const int other = p == here ? n : p;
        const range before = *r;
        if (is_on_way(w, other))
            continue;
        r->switches |= gap.switches;
        r->low += p == here ? gap.low : -gap.high;
        r->high += p == here ? gap.high : -gap.low;
        w->node[w->count++] = other;
        if (go_on(w, r))
            return 1;
        w->count--;
        *r = before;
    }
    return 0;
}

int ns_bridge_own_find_drive(const CKTcircuit *ckt, const ns_own_mosfet *m, ns_own_drive *drive) {
    way of_gate = {.ckt = ckt, .goal = m->source, .node = {m->gate}, .count = 1};
    way of_source = {.ckt = ckt, .goal = 0, .along_l = 1, .node = {m->source}, .count = 1};
    range gate = {0.0, 0.0, 0}, source = {0.0, 0.0, 0};
    if (!go_on(&of_gate, &gate))
        return 0;
    if (of_gate.met == 0 && m->source != 0 && !go_on(&of_source, &source))
        return 0;
    *drive = m->sign > 0 ? (ns_own_drive){gate.low - source.high, gate.high - source.low, gate.switches}
                         : (ns_own_drive){source.low - gate.high, source.high - gate.low, gate.switches};
    return 1;
}
