/* bridge/own_drive.c - the voltage at which a netlist drives the gate of a MOSFET: potentials of gate and
 * source, as ranges.  That of the gate is the one of the network of V and R around it, dividers included;
 * that of the source is the one that the first way along V, R and L leads to. */
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>

#include "models.h"
#include "own_drive.h"
#include "own_mosfet.h"

#include "spicelib/devices/asrc/asrcdefs.h"
#include "spicelib/devices/ind/inddefs.h"
#include "spicelib/devices/res/resdefs.h"
#include "spicelib/devices/vcvs/vcvsdefs.h"
#include "spicelib/devices/vsrc/vsrcdefs.h"

enum { MOST_NODES = 60, MOST_TERMS = 240 }; /* that are tried */
/* A search from a node to `goal` or ground. */
typedef struct way {
    const CKTcircuit *ckt;
    int goal;       /* equation */
    int along_r;    /* resistors and inductors count as wires */
    int is_control; /* it is that of the control of an E: no further E is looked into */
    int along_d;    /* so do D */
    double shunt;   /* ohm: so do resistors below it */
    int inside_b;   /* it is that of a node in a B source: no further B is looked into */
    int met;        /* the equation that was met: goal, or 0 */
    int node[MOST_NODES], count;
} way;

static int find_voltage(const CKTcircuit *ckt, int p, int m, int is_control, ns_own_range *r, double *share);
static int go_on(way *w, int here, ns_own_range *r);

static int range_at(const CKTcircuit *ckt, int eq, ns_own_range *r) {
    way w = {.ckt = ckt, .is_control = 1, .inside_b = 1};
    *r = (ns_own_range){0};
    return go_on(&w, eq, r);
}

/* By how much an E raises its first node, as V and R drive its control; 0: they do not. */
static int read_vcvs(const way *w, const VCVSinstance *e, ns_own_range *gap) {
    const double gain = e->VCVScoeff;
    double share;
    ns_own_range r = {0};
    if (w->is_control || !find_voltage(w->ckt, e->VCVScontPosNode, e->VCVScontNegNode, 1, &r, &share))
        return 0;
    const double low = gain * r.low, high = gain * r.high;
    *gap = (ns_own_range){fmin(low, high), fmax(low, high), r.switches, 1, 0.0, r.amplifies, 0};
    return 1;
}

/* The nodes of inst, one of them `here`, and by how much the first is above the second; 0: it is no wire. */
static int read_wire(const way *w, const GENinstance *inst, int here, int *p, int *n, ns_own_range *gap) {
    *gap = (ns_own_range){0};
    switch (ns_bridge_models_letter(inst)) {
    case 'v': {
        const VSRCinstance *v = (const VSRCinstance *)inst;
        *p = v->VSRCposNode;
        *n = v->VSRCnegNode;
        *gap = ns_bridge_own_range_of_v(v);
        return 1;
    }
    case 'r': {
        const RESinstance *r = (const RESinstance *)inst;
        *p = r->RESposNode;
        *n = r->RESnegNode;
        return w->along_r || r->RESconduct * w->shunt > 1.0;
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
        if ((*p != here && *n != here) || w->inside_b ||
            !ns_bridge_own_range_of_b(w->ckt, inst, range_at, *n == 0 ? w->goal : 0, gap))
            return 0;
        *n = gap->of_goal ? w->goal : *n;
        return *p == here || *n == here;
    }
    case 'a':
        return ns_bridge_own_range_of_bridge(inst, here, p, n, gap);
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

static int was_tried(const way *w, int node) {
    for (int k = 0; k < w->count; k++)
        if (w->node[k] == node)
            return 1;
    return 0;
}

static ns_own_range add_gap(ns_own_range r, ns_own_range gap, int forwards) {
    r.low += forwards ? gap.low : -gap.high;
    r.high += forwards ? gap.high : -gap.low;
    r.switches |= gap.switches;
    r.sources |= gap.sources;
    r.amplifies |= gap.amplifies;
    return r;
}

/* 1 if ways from `here`, *r below the beginning, lead to the goal or ground; *r: by how much it is above
 * that. */
static int go_on(way *w, int here, ns_own_range *r) {
    if (here == w->goal || here == 0) {
        w->met = here;
        return 1;
    }
    if (was_tried(w, here) || w->count == MOST_NODES)
        return 0;
    w->node[w->count++] = here;
    for (NGTABLEPTR box = w->ckt->DEVnameHash->thread; box; box = box->thread_next) {
        ns_own_range gap;
        int p, n;
        if (!read_wire(w, box->data, here, &p, &n, &gap) || (p != here && n != here) || p == n)
            continue;
        ns_own_range further = add_gap(*r, gap, p == here);
        if (go_on(w, p == here ? n : p, &further)) {
            *r = further;
            return 1;
        }
    }
    return 0;
}

/* --- the network of V and R around a gate --- */

/* A known part of an equation of the network. */
typedef struct term {
    int row;
    double weight;
    ns_own_range volts;
    int of_goal; /* beside that the voltage of the goal */
} term;

/* Its unknowns: voltages of nodes that no V ties to the goal or to ground, then currents of the V between
 * them.  Its matrix is symmetric. */
typedef struct network {
    way wires; /* what it consists of */
    int node[MOST_NODES], nodes, rows, terms;
    double a[MOST_NODES * MOST_NODES];
    term term[MOST_TERMS];
    int is_full; /* there is more than it can hold */
} network;

static int place_of(const network *n, int node) {
    for (int k = 0; k < n->nodes; k++)
        if (n->node[k] == node)
            return k;
    return -1;
}

/* 1 if V tie it to the goal or to ground; *volts: by how much it is above *met. */
static int is_tied(const network *n, int node, ns_own_range *volts, int *met) {
    way w = {.ckt = n->wires.ckt,
             .goal = n->wires.goal,
             .is_control = n->wires.is_control,
             .inside_b = n->wires.inside_b};
    *volts = (ns_own_range){0};
    const int tied = go_on(&w, node, volts);
    *met = w.met;
    return tied;
}

static void add_node(network *n, int node) {
    ns_own_range volts;
    int met;
    if (place_of(n, node) >= 0 || is_tied(n, node, &volts, &met))
        return;
    if (n->nodes == MOST_NODES)
        n->is_full = 1;
    else
        n->node[n->nodes++] = node;
}

static void add_term(network *n, int row, double weight, ns_own_range volts, int of_goal) {
    if (n->terms == MOST_TERMS)
        n->is_full = 1;
    else
        n->term[n->terms++] = (term){row, weight, volts, of_goal};
}

static void add_at(network *n, int row, int column, double value) {
    n->a[row * MOST_NODES + column] += value;
}

/* A resistor in the row of one of its ends. */
static void add_resistor(network *n, int row, int other, double siemens) {
    const int column = place_of(n, other);
    ns_own_range volts;
    int met;
    add_at(n, row, row, siemens);
    if (column >= 0)
        add_at(n, row, column, -siemens);
    else if (is_tied(n, other, &volts, &met))
        add_term(n, row, siemens, volts, met == n->wires.goal);
}

/* A V whose first end is the node of this row; the other one is among the nodes too. */
static void add_source(network *n, int row, int other, ns_own_range gap) {
    const int current = n->rows, column = place_of(n, other);
    if (current == MOST_NODES || column < 0) {
        n->is_full = 1;
        return;
    }
    n->rows++;
    add_at(n, row, current, 1.0);
    add_at(n, current, row, 1.0);
    add_at(n, column, current, -1.0);
    add_at(n, current, column, -1.0);
    add_term(n, current, 1.0, gap, 0);
}

/* Each element at the k-th node: its other node, or what it says. */
static void visit(network *n, int k, int adds_nodes) {
    const int here = n->node[k];
    for (NGTABLEPTR box = n->wires.ckt->DEVnameHash->thread; box; box = box->thread_next) {
        const GENinstance *inst = box->data;
        const char letter = ns_bridge_models_letter(inst);
        ns_own_range gap;
        int p, m;
        if (letter == 'l' || !read_wire(&n->wires, inst, here, &p, &m, &gap) || (p != here && m != here) ||
            p == m)
            continue;
        if (adds_nodes)
            add_node(n, p == here ? m : p);
        else if (letter == 'r')
            add_resistor(n, k, p == here ? m : p, ((const RESinstance *)inst)->RESconduct);
        else if (p == here)
            add_source(n, k, m, gap);
    }
}

/* *share: of the voltage of the goal in that of the first node; *r: what sources add.  0: it is not known. */
static int solve(network *n, ns_own_range *r, double *share) {
    double y[MOST_NODES] = {1.0}; /* the first column of the inverse */
    lapack_int pivot[MOST_NODES];
    if (LAPACKE_dgetrf_work(LAPACK_COL_MAJOR, n->rows, n->rows, n->a, MOST_NODES, pivot) != 0 ||
        LAPACKE_dgetrs_work(LAPACK_COL_MAJOR, 'N', n->rows, 1, n->a, MOST_NODES, pivot, y, MOST_NODES) != 0)
        return 0;
    *share = 0.0;
    for (int k = 0; k < n->terms; k++) {
        const term *t = &n->term[k];
        const double part = y[t->row] * t->weight;
        const double low = part * t->volts.low, high = part * t->volts.high;
        *r = add_gap(*r,
                     (ns_own_range){fmin(low, high), fmax(low, high), t->volts.switches, t->volts.sources,
                                    0.0, t->volts.amplifies, 0},
                     1);
        *share += t->of_goal ? part : 0.0;
    }
    return isfinite(r->low) && isfinite(r->high);
}

/* The voltage of a node, as sources drive it: *r + *share times that of the goal. */
static int find_potential(network *n, int node, ns_own_range *r, double *share) {
    int met;
    if (is_tied(n, node, r, &met)) {
        *share = met == n->wires.goal;
        return r->sources;
    }
    add_node(n, node);
    for (int k = 0; k < n->nodes; k++)
        visit(n, k, 1);
    n->rows = n->nodes;
    for (int k = 0; k < n->nodes; k++)
        visit(n, k, 0);
    *r = (ns_own_range){0};
    return !n->is_full && solve(n, r, share) && r->sources;
}

/* v(p,m), as sources drive it; 0: they do not say. */
static int find_voltage(const CKTcircuit *ckt, int p, int m, int is_control, ns_own_range *r, double *share) {
    static const double nearly_all = 0.95; /* what pulls a gate that follows its source to ground is weak */
    way of_goal = {.ckt = ckt, .along_r = 1};
    ns_own_range goal = {0};
    network *n = calloc(1, sizeof *n);
    *share = 0.0;
    if (!n)
        return 0;
    n->wires = (way){.ckt = ckt, .goal = m, .along_r = 1, .is_control = is_control};
    const int known = find_potential(n, p, r, share);
    free(n);
    if (!known || m == 0 || *share > 1.0 - 1e-12)
        return known;
    if (is_control || !go_on(&of_goal, m, &goal))
        return *share > nearly_all;
    r->low -= (1.0 - *share) * goal.high;
    r->high -= (1.0 - *share) * goal.low;
    return 1;
}

/* --- a gate that switches connect with its source and with a supply --- */

/* The other end of a switch of which one is at this node; -1: it is none. */
static int beyond_switch(const GENinstance *inst, int here) {
    const ns_own_kind kind = ns_bridge_own_kind(inst);
    ns_own_switch s = {.p = -1, .n = -1};
    if (kind == OWN_SWITCH)
        ns_bridge_own_read_switch(inst, NULL, &s);
    else if (kind == OWN_CURRENT_SWITCH)
        ns_bridge_own_read_current_switch(inst, NULL, 0, &s);
    else if (ns_bridge_models_kind(inst) == KIND_SWITCH)
        s = (ns_own_switch){.p = ns_bridge_models_node((const MIFinstance *)inst, SWITCH_P),
                            .n = ns_bridge_models_node((const MIFinstance *)inst, SWITCH_N)};
    return s.p == here ? s.n : s.n == here ? s.p : -1;
}

/* The voltage of `node` above the source of m, along V, R, L and D, is added to *r. */
static void add_end(const CKTcircuit *ckt, int source, int node, ns_own_range *r) {
    way w = {.ckt = ckt, .goal = source, .along_r = 1, .along_d = 1};
    way of_goal = {.ckt = ckt, .along_r = 1};
    ns_own_range end = {0}, goal = {0};
    if (!go_on(&w, node, &end))
        return;
    if (w.met != source && go_on(&of_goal, source, &goal))
        end = add_gap(end, goal, 0);
    ns_bridge_own_extend(r, end.low);
    ns_bridge_own_extend(r, end.high);
}

/* From a gate along R; *r: of the ends beyond all switches, and of those without one. */
static void visit_ends(way *w, int here, ns_own_range *r) {
    ns_own_range volts = {0};
    way by_v = {.ckt = w->ckt, .goal = w->goal};
    if (was_tried(w, here) || w->count == MOST_NODES)
        return;
    w->node[w->count++] = here;
    if (go_on(&by_v, here, &volts)) {
        add_end(w->ckt, w->goal, here, r);
        return;
    }
    for (NGTABLEPTR box = w->ckt->DEVnameHash->thread; box; box = box->thread_next) {
        const GENinstance *inst = box->data;
        const int end = beyond_switch(inst, here);
        int p, n;
        if (end >= 0) {
            add_end(w->ckt, w->goal, end, r);
            r->switches = 1;
        } else if (ns_bridge_models_letter(inst) == 'r' && read_wire(w, inst, here, &p, &n, &volts) &&
                   (p == here || n == here)) {
            visit_ends(w, p == here ? n : p, r);
        }
    }
}

/* The source of a closed M has the potential of its drain: the drive of one whose gate is driven against
 * ground. 0: that potential is not known. */
static int lower_when_closed(const CKTcircuit *ckt, const ns_own_mosfet *m, ns_own_drive *drive) {
    way to_supply = {.ckt = ckt}, along_r = {.ckt = ckt, .along_r = 1};
    ns_own_range drain = {0};
    const int known = go_on(&to_supply, m->drain, &drain) || go_on(&along_r, m->drain, &drain);
    const double left = known ? drive->high - drain.high : NAN;
    drive->follows = left > m->vth ? FOLLOWS_AND_CLOSES : 1;
    drive->high = left <= m->vth ? drive->high : left;
    return known;
}

int ns_bridge_own_find_drive(const CKTcircuit *ckt, const ns_own_mosfet *m, ns_own_drive *drive) {
    ns_own_range r = {0};
    double share;
    if (!find_voltage(ckt, m->gate, m->source, 0, &r, &share)) {
        way ends = {.ckt = ckt, .goal = m->source, .along_r = 1};
        r = (ns_own_range){INFINITY, -INFINITY, 0, 1, 0.0, 0, 0};
        share = 1.0;
        visit_ends(&ends, m->gate, &r);
        if (!r.switches || !(r.low < r.high))
            return 0;
    }
    way to_ground = {.ckt = ckt, .shunt = 1.0}; /* ohm: more than most shunts that sense a current */
    ns_own_range source = {0};
    *drive = m->sign > 0 ? (ns_own_drive){r.low, r.high, r.switches && !r.amplifies, 0}
                         : (ns_own_drive){-r.high, -r.low, r.switches && !r.amplifies, 0};
    return m->sign < 0 || share >= 0.5 || go_on(&to_ground, m->source, &source) ||
           lower_when_closed(ckt, m, drive);
}
