/* src/circuit/circuit_internal.h - what a circuit object holds; private to src/circuit. */
#ifndef NS_CIRCUIT_INTERNAL_H
#define NS_CIRCUIT_INTERNAL_H

#include "nonsmooth/circuit.h"
#include "system/signal_internal.h"

typedef enum element_kind {
    RESISTOR,
    CAPACITOR,
    INDUCTOR,
    COUPLING,
    SOURCE,
    VCONTROLLED,
    ICONTROLLED,
    LINEAR,
    DIODE,
    SWITCH
} element_kind;

/* One element.  The numbers at the end are given when it is added; -1: none. */
typedef struct element {
    element_kind kind;
    char *name;
    int nnodes, node[4]; /* p n cp cn */
    ns_output output;    /* of sources: what they put out */
    double value, ic;    /* ohm, F, H, k, gain, constant; initial v or i, NAN */
    int by[2];           /* elements referred to: coupled inductors, controlling current */
    int nterms;
    ns_term *terms;   /* nterms, owned */
    ns_signal signal; /* PWL arrays owned */
    ns_diode diode;
    ns_switch sw;
    int current; /* which of the currents among x */
    int pair;    /* the first of its pairs; a breakdown pair follows */
    int input;   /* z entry */
    int command;
} element;

/* How many unknowns, pairs, inputs, commands an element brings. */
typedef struct needs {
    int currents, pairs, inputs, commands;
} needs;

typedef struct node_info {
    int number;
    int used;   /* an element names it, so its voltage is an unknown */
    char *name; /* owned, or NULL */
    double ic;  /* V, NAN: none */
} node_info;

struct ns_circuit {
    element *element;
    node_info *node; /* by ascending number, without ground */
    int nelements, nnodes;
    size_t element_room, node_room;
    int nused, ncurrents, npairs, ninputs, ncommands;
    char message[256];
};

/* Writes the message and returns status. */
int ns_complain(ns_circuit *c, int status, const char *format, ...);

/* Adds a copy of *e, which must be right; its pointers stay the caller's.  Errors: MEMORY. */
int ns_add_element(ns_circuit *c, const element *e, needs wants, int *id);

/* The place of a node in c->node, or where it would have to be. */
int ns_find_node(const ns_circuit *c, int number, int *found);

/* 1/(1 - r/roff): a branch i = lambda + v/roff follows v = vk + r i as v = (vk + r lambda) times this. */
double ns_kink_factor(double r, double roff);

/* Calls visit for every nonzero entry of the inductance matrix; row, column: numbers of inductors. */
void ns_each_inductance(const ns_circuit *c, void (*visit)(void *to, int row, int column, double henries),
                        void *to);

/* Refuses couplings that no windings can have.  Errors: RANGE, MEMORY, with a message. */
int ns_check_inductances(ns_circuit *c);

/* The commands of all switches (control.c).  Errors: MEMORY. */
int ns_stamp_commands(const ns_circuit *c, ns_system *s);

/* Parts without any connection to ground get one (gauge.c).  Errors: MEMORY. */
int ns_stamp_gauge(const ns_circuit *c, ns_system *s);

#endif
