/* bridge/own_feedback.c - an M whose drain acts on its own gate.
 *
 * While the drain swings, the current of the capacitance between them holds the gate at its threshold.  A
 * switch would open and close infinitely fast there. */
#include "own_feedback.h"

#include "models.h"
#include "own_fed.h"
#include "own_voltage.h"

#include "spicelib/devices/cap/capdefs.h"
#include "spicelib/devices/cccs/cccsdefs.h"
#include "spicelib/devices/res/resdefs.h"
#include "spicelib/devices/vccs/vccsdefs.h"

/* Nodes that resistors join to a first one. */
typedef struct joined {
    int node[OWN_WAY_NODES], count;
} joined;

static int has(const joined *j, int node) {
    for (int k = 0; k < j->count; k++)
        if (j->node[k] == node)
            return 1;
    return 0;
}

/* V give it a voltage against the source or ground. */
static int is_known(const CKTcircuit *ckt, int source, int node) {
    ns_own_way w = {.ckt = ckt, .find = ns_bridge_own_find_voltage, .goal = source};
    ns_own_range volts = {0};
    return ns_bridge_own_way(&w, node, &volts);
}

/* Nodes whose voltage V give end the way. */
static void add(joined *j, const CKTcircuit *ckt, int source, int node) {
    if (j->count < OWN_WAY_NODES && !has(j, node) && !is_known(ckt, source, node))
        j->node[j->count++] = node;
}

static joined join(const CKTcircuit *ckt, int source, int first) {
    joined j = {.node = {first}, .count = 1};
    for (int k = 0; k < j.count; k++)
        for (NGTABLEPTR box = ckt->DEVnameHash->thread; box; box = box->thread_next) {
            const RESinstance *r = box->data;
            if (ns_bridge_models_letter(box->data) != 'r')
                continue;
            if (r->RESposNode == j.node[k])
                add(&j, ckt, source, r->RESnegNode);
            else if (r->RESnegNode == j.node[k])
                add(&j, ckt, source, r->RESposNode);
        }
    return j;
}

/* The nodes of a C, F or G; 0: it is none. */
static int read_ends(const GENinstance *inst, int *p, int *n) {
    switch (ns_bridge_models_letter(inst)) {
    case 'c':
        *p = ((const CAPinstance *)inst)->CAPposNode;
        *n = ((const CAPinstance *)inst)->CAPnegNode;
        return 1;
    case 'f':
        *p = ((const CCCSinstance *)inst)->CCCSposNode;
        *n = ((const CCCSinstance *)inst)->CCCSnegNode;
        return 1;
    case 'g':
        *p = ((const VCCSinstance *)inst)->VCCSposNode;
        *n = ((const VCCSinstance *)inst)->VCCSnegNode;
        return 1;
    default:
        return 0;
    }
}

/* An F or G whose current V give. */
static int is_known_current(const CKTcircuit *ckt, const GENinstance *inst) {
    const ns_own_way w = {.ckt = ckt, .find = ns_bridge_own_find_voltage};
    ns_own_range amperes;
    int p, n;
    return ns_bridge_own_read_fed_ends(inst, &p, &n) && ns_bridge_own_find_fed(&w, inst, &amperes);
}

/* 1 if a C that does not lead to the source or to ground, or if allows_known to a node whose voltage V give,
 * ends at the gate, or at what resistors join to it, or if an F or G of a current that V do not give feeds
 * it. */
static int has_other(const CKTcircuit *ckt, const ns_own_mosfet *m, int allows_known) {
    if (is_known(ckt, m->source, m->gate))
        return 0;
    const joined gate = join(ckt, m->source, m->gate), source = join(ckt, m->source, m->source);
    for (NGTABLEPTR box = ckt->DEVnameHash->thread; box; box = box->thread_next) {
        const GENinstance *inst = box->data;
        int p, n;
        if (!read_ends(inst, &p, &n) || has(&gate, p) == has(&gate, n) || is_known_current(ckt, inst))
            continue;
        const int other = has(&gate, p) ? n : p;
        if (ns_bridge_models_letter(inst) != 'c' ||
            (other != 0 && !has(&source, other) && !(allows_known && is_known(ckt, m->source, other))))
            return 1;
    }
    return 0;
}

int ns_bridge_own_has_feedback(const CKTcircuit *ckt, const ns_own_mosfet *m) {
    return has_other(ckt, m, 1);
}

int ns_bridge_own_is_coupled(const CKTcircuit *ckt, const ns_own_mosfet *m) {
    return has_other(ckt, m, 0);
}

/* 1 if these are gate and drain of one M: what is between them stands for a capacitance. */
static int is_inside_mosfet(const CKTcircuit *ckt, int p, int n) {
    for (NGTABLEPTR box = ckt->DEVnameHash->thread; box; box = box->thread_next) {
        ns_own_mosfet m;
        if (ns_bridge_own_kind(box->data) != OWN_MOSFET)
            continue;
        ns_bridge_own_read_mosfet(box->data, &m);
        if (m.drain > 0 && ((m.gate == p && m.drain == n) || (m.gate == n && m.drain == p)))
            return 1;
    }
    return 0;
}

/* 1 if a current from p to n, of which the gate's nodes and the drain's are these, flows into the gate from
 * elsewhere than its drain. */
static int enters(const joined *gate, const joined *drain, const ns_own_mosfet *m, int p, int n) {
    const int from = has(gate, p), to = has(gate, n), other = from ? n : p;
    return p != n && (from || to) && ((from && to) || (other != m->drain && !has(drain, other)));
}

int ns_bridge_own_is_fed(const CKTcircuit *ckt, const ns_own_mosfet *m) {
    static const double most_ohm = 1e6; /* through more a current charges the gate all along the run */
    const ns_own_way w = {.ckt = ckt, .find = ns_bridge_own_find_voltage, .goal = m->source};
    const int charges = !(ns_bridge_own_gate_ohm(ckt, m->gate, m->source, NULL, 0.0) < most_ohm);
    joined gate, drain;
    gate.count = ns_bridge_own_find_nodes(ckt, m->gate, m->source, 1, gate.node);
    drain.count = ns_bridge_own_find_nodes(ckt, m->drain, m->source, 0, drain.node);
    for (NGTABLEPTR box = ckt->DEVnameHash->thread; box; box = box->thread_next) {
        ns_own_range amperes;
        int p, n;
        if (ns_bridge_own_read_fed_ends(box->data, &p, &n) && enters(&gate, &drain, m, p, n) &&
            !is_inside_mosfet(ckt, p, n) && (charges || !ns_bridge_own_find_fed(&w, box->data, &amperes)))
            return 1;
    }
    return 0;
}
