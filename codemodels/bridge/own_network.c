/* bridge/own_network.c - the voltage between two nodes, as the network of V and R around them gives it. */
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>

#include "models.h"
#include "own_fed.h"
#include "own_structs.h"
#include "own_touch.h"
#include "own_voltage.h"

#include "spicelib/devices/ind/inddefs.h"
#include "spicelib/devices/res/resdefs.h"

enum { MOST_TERMS = 240 }; /* that are tried */

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
    ns_own_way wires; /* what it consists of */
    int node[OWN_WAY_NODES], nodes, rows, terms;
    double a[OWN_WAY_NODES * OWN_WAY_NODES];
    term term[MOST_TERMS];
    double ohm;  /* that the first node has against what V hold */
    int is_full; /* there is more than it can hold */
    int is_fed;  /* by a current that is not known */
    int coils;   /* L that K does not couple count as V of 0 V: that is their mean */
} network;

static int place_of(const network *n, int node) {
    for (int k = 0; k < n->nodes; k++)
        if (n->node[k] == node)
            return k;
    return -1;
}

/* 1 if V tie it to the goal or to ground; *volts: by how much it is above *met. */
static int is_tied(const network *n, int node, ns_own_range *volts, int *met) {
    ns_own_way w = {.ckt = n->wires.ckt,
                    .find = n->wires.find,
                    .goal = n->wires.goal,
                    .at_goal = n->wires.at_goal,
                    .closed = n->wires.closed,
                    .farads = n->wires.farads,
                    .gate = n->wires.gate,
                    .inside_b = n->wires.inside_b};
    *volts = (ns_own_range){0};
    const int tied = ns_bridge_own_way(&w, node, volts);
    *met = w.met;
    return tied;
}

static void add_node(network *n, int node) {
    ns_own_range volts;
    int met;
    if (place_of(n, node) >= 0 || is_tied(n, node, &volts, &met))
        return;
    if (n->nodes == OWN_WAY_NODES)
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
    n->a[row * OWN_WAY_NODES + column] += value;
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

/* A V whose first end is the node of this row; the other one is among the nodes too, or tied (L). */
static void add_source(network *n, int row, int other, ns_own_range gap) {
    const int current = n->rows, column = place_of(n, other);
    int met = -1;
    if (current == OWN_WAY_NODES || (column < 0 && !is_tied(n, other, &gap, &met))) {
        n->is_full = 1;
        return;
    }
    n->rows++;
    add_at(n, row, current, 1.0);
    add_at(n, current, row, 1.0);
    if (column >= 0) {
        add_at(n, column, current, -1.0);
        add_at(n, current, column, -1.0);
    }
    add_term(n, current, 1.0, gap, met == n->wires.goal);
}

static int is_coupled(const CKTcircuit *ckt, const GENinstance *coil) {
    for (NGTABLEPTR box = ckt->DEVnameHash->thread; box; box = box->thread_next) {
        const MUTinstance *k = box->data;
        if (ns_bridge_models_letter(box->data) == 'k' &&
            ((const GENinstance *)k->MUTind1 == coil || (const GENinstance *)k->MUTind2 == coil))
            return 1;
    }
    return 0;
}

static int is_left_out(const network *n, const GENinstance *inst) {
    return ns_bridge_models_letter(inst) == 'l' && (!n->coils || is_coupled(n->wires.ckt, inst));
}

/* A source of current at the k-th node. */
static void add_fed(network *n, int k, const GENinstance *inst) {
    ns_own_range amperes;
    int p, m;
    if (!ns_bridge_own_read_fed_ends(inst, &p, &m) || p == m || (p != n->node[k] && m != n->node[k]))
        return;
    if (ns_bridge_own_find_fed(&n->wires, inst, &amperes))
        add_term(n, k, m == n->node[k] ? 1.0 : -1.0, amperes, 0);
    else
        n->is_fed = 1;
}

/* Each element at the k-th node: its other node, or what it says. */
static void visit(network *n, int k, int adds_nodes) {
    const int here = n->node[k];
    for (NGTABLEPTR box = n->wires.ckt->DEVnameHash->thread; box; box = box->thread_next) {
        const GENinstance *inst = box->data;
        const char letter = ns_bridge_models_letter(inst);
        ns_own_range gap;
        int p, m;
        if (!adds_nodes)
            add_fed(n, k, inst);
        if (is_left_out(n, inst) || !ns_bridge_own_wire(&n->wires, inst, here, &p, &m, &gap) ||
            (p != here && m != here) || p == m)
            continue;
        const int other = p == here ? m : p;
        if (adds_nodes)
            add_node(n, other);
        else if (letter == 'r')
            add_resistor(n, k, other, ((const RESinstance *)inst)->RESconduct);
        else if (p == here || place_of(n, other) < 0)
            add_source(n, k, other, gap);
    }
}

/* *share: of the voltage of the goal in that of the first node; *r: what sources add.  0: it is not known. */
static int solve(network *n, ns_own_range *r, double *share) {
    double y[OWN_WAY_NODES] = {1.0}; /* the first column of the inverse */
    lapack_int pivot[OWN_WAY_NODES];
    if (LAPACKE_dgetrf_work(LAPACK_COL_MAJOR, n->rows, n->rows, n->a, OWN_WAY_NODES, pivot) != 0 ||
        LAPACKE_dgetrs_work(LAPACK_COL_MAJOR, 'N', n->rows, 1, n->a, OWN_WAY_NODES, pivot, y,
                            OWN_WAY_NODES) != 0)
        return 0;
    *share = 0.0;
    n->ohm = y[0];
    for (int k = 0; k < n->terms; k++) {
        const term *t = &n->term[k];
        const double part = y[t->row] * t->weight;
        const double low = part * t->volts.low, high = part * t->volts.high;
        *r = ns_bridge_own_add_gap(*r,
                                   (ns_own_range){fmin(low, high), fmax(low, high), t->volts.switches,
                                                  t->volts.sources, 0.0, t->volts.amplifies, 0},
                                   1);
        *share += t->of_goal ? part : 0.0;
    }
    return isfinite(r->low) && isfinite(r->high);
}

/* A D from there to the goal, which limits the voltage between them and drives nothing, or one that nothing
 * flows through but in breakdown. */
static int limits(const network *n, const GENinstance *inst) {
    ns_own_diode d;
    if (ns_bridge_own_kind(inst) != OWN_DIODE)
        return 0;
    ns_bridge_own_read_diode(inst, &d);
    const int goal = n->wires.goal, other = n->wires.at_goal > 0 ? n->wires.at_goal : goal;
    return d.anode == goal || d.cathode == goal || d.anode == other || d.cathode == other ||
           ns_bridge_own_is_opposed(n->wires.ckt, inst);
}

/* 1 if nothing but V and R, L that count, and C, carry a current into the nodes: what they have, sources or
 * not, is all. */
static int is_alone(const network *n) {
    for (int k = 0; k < n->nodes; k++)
        for (NGTABLEPTR box = n->wires.ckt->DEVnameHash->thread; box; box = box->thread_next) {
            const char letter = ns_bridge_models_letter(box->data);
            if (letter != 'v' && letter != 'r' && letter != 'c' &&
                (letter != 'l' || is_left_out(n, box->data)) &&
                ns_bridge_own_touches(box->data, n->node[k]) && !limits(n, box->data))
                return 0;
        }
    return 1;
}

static void add_all_nodes(network *n, int first) {
    add_node(n, first);
    for (int k = 0; k < n->nodes; k++)
        visit(n, k, 1);
}

/* The voltage of a node, as sources drive it: *r + *share times that of the goal.  Of a control it is not
 * known without a source. */
static int find_potential(network *n, int node, ns_own_range *r, double *share) {
    int met;
    if (is_tied(n, node, r, &met)) {
        *share = met == n->wires.goal;
        n->ohm = 0.0;
        return r->sources || n->wires.find;
    }
    add_all_nodes(n, node);
    n->rows = n->nodes;
    for (int k = 0; k < n->nodes; k++)
        visit(n, k, 0);
    *r = (ns_own_range){0};
    if (n->is_fed && !n->wires.find) /* of a gate own_feedback.c says it */
        return 0;
    return !n->is_full && solve(n, r, share) && (r->sources || (n->wires.find && is_alone(n)));
}

/* The potential of the goal, as V and what is closed say it, or else the first way along R and L. */
static int find_level(const ns_own_way *wires, ns_own_range *r) {
    const int node = wires->goal;
    ns_own_way by_v = {.ckt = wires->ckt, .find = ns_bridge_own_find_voltage, .closed = wires->closed},
               along_r = by_v;
    along_r.along_r = 1;
    *r = (ns_own_range){0};
    return ns_bridge_own_way(&by_v, node, r) || ns_bridge_own_way(&along_r, node, r);
}

/* That of the network with L, or, where that says nothing, without them. */
static int find_with_coils(const ns_own_way *wires, int p, ns_own_range *r, double *share, double *ohm) {
    int known = 0;
    for (int coils = 1; coils >= 0 && !known; coils--) {
        network *n = calloc(1, sizeof *n);
        *share = *ohm = 0.0;
        if (!n)
            return 0;
        n->ohm = NAN;
        n->wires = *wires;
        n->wires.along_r = 1;
        n->coils = coils;
        known = find_potential(n, p, r, share);
        *ohm = n->ohm;
        free(n);
    }
    return known;
}

/* The voltage of p above the goal of these wires, as sources drive it, and through which resistance; 0: they
 * do not say. */
static int find_voltage(ns_own_way wires, int p, ns_own_range *r, double *share, double *ohm) {
    static const double nearly_all = 0.95; /* what pulls a gate that follows its source to ground is weak */
    ns_own_range goal;
    const int known = find_with_coils(&wires, p, r, share, ohm);
    if (!known || wires.goal == 0 || *share > 1.0 - 1e-12)
        return known;
    if (!wires.find || !find_level(&wires, &goal))
        return *share > nearly_all;
    r->sources |= goal.switches;
    r->switches |= r->low == r->high && goal.switches; /* the supply does */
    r->low -= (1.0 - *share) * goal.high;
    r->high -= (1.0 - *share) * goal.low;
    return 1;
}

/* The voltage of p above the goal of these wires, through V and R, without L.  0: they do not say, and
 * nothing holds it either. */
static int find_level_at(const ns_own_way *wires, int p, ns_own_range *r) {
    network *n = calloc(1, sizeof *n);
    double share = 0.0;
    if (!n)
        return 0;
    n->ohm = NAN;
    n->wires = *wires;
    n->wires.along_r = 1;
    const int known = find_potential(n, p, r, &share) || isfinite(n->ohm);
    free(n);
    return known && isfinite(r->low) && isfinite(r->high) && (share > 1.0 - 1e-12 || wires->goal == 0);
}

/* Likewise as S, W and ideal switches, each alone or none, give it.  0: they give it no two voltages. */
static int find_switched(ns_own_way wires, int p, ns_own_range *r) {
    ns_own_range all = {INFINITY, -INFINITY, 1, 1, 0.0, 0, 0}, level;
    wires.closed = NULL;
    if (find_level_at(&wires, p, &level)) {
        ns_bridge_own_extend(&all, level.low);
        ns_bridge_own_extend(&all, level.high);
    }
    for (NGTABLEPTR box = wires.ckt->DEVnameHash->thread; box; box = box->thread_next) {
        int from, to;
        if (ns_bridge_own_kind(box->data) == OWN_MOSFET || !ns_bridge_own_contacts(box->data, &from, &to))
            continue;
        wires.closed = box->data;
        if (!find_level_at(&wires, p, &level))
            continue;
        ns_bridge_own_extend(&all, level.low);
        ns_bridge_own_extend(&all, level.high);
    }
    if (!(all.low < all.high))
        return 0;
    *r = all;
    return 1;
}

int ns_bridge_own_find_voltage(const CKTcircuit *ckt, int p, int m, int is_control, ns_own_range *r,
                               double *share) {
    const ns_own_way wires = {.ckt = ckt, .find = is_control ? NULL : ns_bridge_own_find_voltage, .goal = m};
    double ohm;
    const int known = find_voltage(wires, p, r, share, &ohm);
    if (!is_control || (known && r->low < r->high))
        return known;
    return find_switched(wires, p, r) || known;
}

int ns_bridge_own_find_gate(const CKTcircuit *ckt, int gate, int source, ns_own_range *r, double *share,
                            double *ohm) {
    return find_voltage((ns_own_way){.ckt = ckt, .find = ns_bridge_own_find_voltage, .goal = source}, gate, r,
                        share, ohm);
}

int ns_bridge_own_find_gate_by(const CKTcircuit *ckt, int gate, int source, const GENinstance *by,
                               ns_own_range *r, double *share) {
    double ohm;
    return find_voltage(
        (ns_own_way){.ckt = ckt, .find = ns_bridge_own_find_voltage, .goal = source, .closed = by}, gate, r,
        share, &ohm);
}

double ns_bridge_own_gate_ohm(const CKTcircuit *ckt, int gate, int source, const GENinstance *by,
                              double farads) {
    static const double most = 1e9; /* what holds it through more, from rounding too, holds nothing */
    double share, ohm;
    ns_own_range r;
    find_voltage((ns_own_way){.ckt = ckt,
                              .find = ns_bridge_own_find_voltage,
                              .goal = source,
                              .closed = by,
                              .farads = farads,
                              .gate = gate},
                 gate, &r, &share, &ohm);
    return ohm >= 0.0 && ohm < most ? ohm : NAN;
}

int ns_bridge_own_find_gate_closed(const CKTcircuit *ckt, int gate, int source, int drain,
                                   const GENinstance *by, ns_own_range *r, double *share) {
    double ohm;
    return find_voltage(
        (ns_own_way){
            .ckt = ckt, .find = ns_bridge_own_find_voltage, .goal = drain, .at_goal = source, .closed = by},
        gate, r, share, &ohm);
}

int ns_bridge_own_find_nodes(const CKTcircuit *ckt, int first, int goal, int coils, int *node) {
    network *n = calloc(1, sizeof *n);
    if (!n)
        return 0;
    n->wires = (ns_own_way){.ckt = ckt, .find = ns_bridge_own_find_voltage, .goal = goal, .along_r = 1};
    n->coils = coils;
    add_all_nodes(n, first);
    const int count = n->nodes;
    for (int k = 0; k < count; k++)
        node[k] = n->node[k];
    free(n);
    return count;
}
