/* tests/stress/plan.h - a netlist that was read: parts, what is compared, and the .tran line.
 *
 * Read are R L C K V I E G F H, A lines with ideal_diode and ideal_switch, .model, .tran, .save with v(a),
 * v(a,b), i(l); others, as B and the options of the run, are passed over.  Without .save the charges and
 * fluxes are compared: the voltage of every capacitor, the current of every inductor that no K with |k| = 1
 * names.
 */
#ifndef NONSMOOTH_TESTS_PLAN_H
#define NONSMOOTH_TESTS_PLAN_H

#include "netlist.h"
#include "nonsmooth.h"

enum { PLAN_PARTS = 600, PLAN_NODES = 600, PLAN_PROBES = 48, PLAN_CORNERS = 16, PLAN_NAME = 24 };

typedef struct plan_part {
    char kind; /* SPICE's letter; d and s: diode and switch */
    char name[PLAN_NAME];
    int node[4]; /* p, n, and those of the control */
    int by[2];   /* parts that it names: those of k, the source of f and h; -1: none */
    double value, ic;
    ns_signal signal;
    double corner_t[PLAN_CORNERS], corner_v[PLAN_CORNERS];
    ns_diode diode;
    ns_switch contact;
} plan_part;

typedef struct plan_probe {
    int part;    /* its current; -1: a voltage */
    int node[2]; /* v(node[0], node[1]) */
} plan_probe;

typedef struct plan {
    int parts, nodes, probes; /* node 0 is ground */
    plan_part part[PLAN_PARTS];
    char node[PLAN_NODES][PLAN_NAME];
    plan_probe probe[PLAN_PROBES];
    double step, stop;
    int uic;
} plan;

/* A circuit of the library: its elements' numbers by part, its nodes' by node. */
typedef struct plan_built {
    ns_circuit *circuit;
    int id[PLAN_PARTS], node[PLAN_NODES];
} plan_built;

/* NULL, or what was not understood: the line, which is n's. */
const char *plan_read(const netlist *n, plan *p);

/* shuffle: 0: as it stands; else parts in another order, nodes with other numbers, other names.  vary: each
 * resistance, capacitance and inductance is changed by up to that, relative to itself.  On failure *b holds
 * the circuit, which has the message, and is to be freed all the same. */
int plan_build(const plan *p, unsigned long long shuffle, double vary, plan_built *b);

/* What a probe is called: "v(a,b)", "i(l1)". */
void plan_probe_name(const plan *p, int probe, char *name, size_t size);

#endif
