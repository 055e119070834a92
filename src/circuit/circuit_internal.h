/* src/circuit/circuit_internal.h - what a circuit object holds; private to src/circuit. */
#ifndef NS_CIRCUIT_INTERNAL_H
#define NS_CIRCUIT_INTERNAL_H

#include "linalg/sparse.h"
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
    SWITCH,
    KINK,
    CHOICE,
    BOX
} element_kind;

/* One element. */
typedef struct element {
    element_kind kind;
    char *name; /* owned */
    /* what it is connected to */
    int nnodes, node[4]; /* p n cp cn */
    int place[2];        /* where p and n were among the circuit's nodes when its system was made last */
    int by[2];           /* elements referred to: coupled inductors, controlling current */
    /* its parameters */
    ns_output output; /* of sources: voltage or current */
    double value;     /* ohm, F, H, k, gain, constant */
    double ic;        /* initial v or i, NAN: none */
    double low, high; /* of BOX: bounds of its value */
    double control;   /* of CHOICE: constant of its control, */
    int ncontrol;     /* whose terms are the first of all: how many */
    int nterms;       /* of LINEAR, KINK, CHOICE: how many, */
    ns_term *terms;   /* nterms, owned */
    ns_signal signal; /* of SOURCE; PWL arrays owned */
    ns_diode diode;   /* of DIODE */
    ns_switch sw;     /* of SWITCH, commanded by two nodes, or by the current of by[0] */
    int closed;       /* of SWITCH: 1: closed at a start where its control does not say */
    int at_rest; /* of SWITCH of vh = 0, CHOICE, with its control at vt: 1: open, -1: closed, 0: as it was;
                    or NS_RESTS_AS_IT_CAME */
    int rests;   /* at vt, also where that is not 0 */
    int group;   /* of CHOICE: its expression */
    int at_constant, at_any; /* NS_RESTS_AS_IT_CAME, and these where it is constant, or no sum of sources */
    /* its indices in the system, given when it is added; -1: none */
    int current; /* among the currents in x */
    int pair;    /* the first of its ns_circuit_pairs_of() */
    int input;   /* z entry */
    int command; /* of a switch */
} element;

/* How many unknowns, pairs, inputs, commands an element brings. */
typedef struct needs {
    int currents, pairs, inputs, commands;
} needs;

typedef struct node_info {
    int number;
    int used;    /* an element names it, so its voltage is an unknown: */
    int unknown; /* how many nodes before it are used */
    char *name;  /* owned, or NULL */
    double ic;   /* V, NAN: none */
} node_info;

/* Names of elements by hash, open addressing; entries are numbers of elements + 1, 0: none. */
typedef struct name_table {
    int *slot;
    size_t size; /* a power of two, or 0 */
} name_table;

struct ns_circuit {
    /* elements, in the order in which they were added */
    int nelements;
    element *element;
    size_t element_room; /* allocated */
    name_table names;
    /* nodes, by ascending number, without ground */
    int nnodes;
    node_info *node;
    size_t node_room; /* allocated */
    /* what the system has of each */
    int nused; /* nodes that elements name */
    int ncurrents, npairs, ninputs, ncommands;
    /* why the last call was refused */
    char message[256];
};

/* Writes the message and returns status. */
int ns_circuit_complain(ns_circuit *c, int status, const char *format, ...);

/* Adds a copy of *e, which must be right; its pointers stay the caller's.  Errors: MEMORY. */
int ns_circuit_add_element(ns_circuit *c, const element *e, needs wants, int *id);

/* Errors: NULL, SIZE (element id is none of that kind, which a user calls `what`). */
int ns_circuit_check_is(ns_circuit *c, int id, element_kind kind, const char *what);

/* elements.c: a blank element of this kind, its name and its nodes (p n cp cn) checked; a parameter of the
 * element `name` is a finite number; a term of it refers to what there is.  Statuses, with a message. */
int ns_circuit_start_element(ns_circuit *c, element *e, element_kind kind, const char *name, int nnodes,
                             const int *nodes);
int ns_circuit_check_finite(ns_circuit *c, const char *name, const char *parameter, double value);
int ns_circuit_check_term(ns_circuit *c, const char *name, const ns_term *t);

/* The place of a node in c->node, or where it would have to be. */
int ns_circuit_find_node(const ns_circuit *c, int number, int *found);

/* 1/(1 - r/roff): a branch i = lambda + v/roff follows v = vk + r i as v = (vk + r lambda) times this. */
double ns_circuit_kink_factor(double r, double roff);

/* How many pairs a device has: of a diode a second one if it breaks down, else one. */
int ns_circuit_pairs_of(const element *e);

/* Calls visit for every nonzero entry of the inductance matrix; row, column: numbers of inductors. */
void ns_circuit_each_inductance(const ns_circuit *c,
                                void (*visit)(void *to, int row, int column, double henries), void *to);

/* Refuses couplings that no windings can have.  Errors: RANGE, MEMORY, with a message. */
int ns_circuit_check_inductances(ns_circuit *c);

/* Currents of inductors that are sums of others': of inductor k, i_k = sum of sign i(of), entries first[k]
 * on; count[k] = 0: of none.  sign is 1 or -1. */
typedef struct ns_inductor_cuts {
    int *first, *count; /* nelements */
    int *of;
    signed char *sign;
} ns_inductor_cuts;

/* inductor_cuts.c.  To be freed in any case.  Errors: MEMORY. */
int ns_circuit_find_cuts(const ns_circuit *c, ns_inductor_cuts *cuts);
void ns_circuit_free_cuts(ns_inductor_cuts *cuts);

/* The element of this name, or -1 (names.c). */
int ns_circuit_find_name(const ns_circuit *c, const char *name);
/* Makes the last element be found by its name.  Room must have been reserved, for one more than there are. */
int ns_circuit_reserve_name(ns_circuit *c); /* Errors: MEMORY */
void ns_circuit_enter_name(ns_circuit *c);

enum { NS_RESTS_AS_IT_CAME = 2 }; /* of element.at_rest */

/* Where elements leave their numbers: entries are added to the arrays of s, or, if it is large, to lists. */
typedef enum matrix { IN_M, IN_A, IN_B, IN_C, IN_D, IN_E, IN_GX, IN_GZ, MATRICES } matrix;
typedef struct stamp {
    ns_circuit *c;
    ns_system *s;
    ns_entries *entries; /* MATRICES lists, NULL: s is not large */
} stamp;

/* Entry (i,j) += value; ground (-1) has neither row nor column.  IN_GX, IN_GZ: of command j, whose arrays are
 * there. */
void ns_circuit_stamp_add(const stamp *to, matrix which, int i, int j, double value);

/* The unknown, or the pair, that a term stands for; -1: it is not one. */
int ns_circuit_term_unknown(const ns_circuit *c, const ns_term *t);
int ns_circuit_term_pair(const ns_circuit *c, const ns_term *t);

/* What one element adds to the system; of coupled inductors nothing (inductance.c). */
void ns_circuit_stamp_element(const stamp *to, const element *e);

/* By how much an input counts in a control. */
typedef struct ns_input_gain {
    const ns_signal *z;
    double gain;
} ns_input_gain;

/* resting_control.c: by how much the thresholds of a switch are shifted for its at_rest: where its control is
 * constant + sum of count terms, and where it is anything else.  *both_ways: it is to be open where it comes
 * to its threshold from above, closed where from below, and does both.  Errors: MEMORY. */
int ns_circuit_shift_known(const element *e, double constant, const ns_input_gain *term, int count,
                           double *shift, int *both_ways);
double ns_circuit_shift_unknown(const ns_circuit *c, const element *e);
/* Of a choice whose control is as large as this, and no sum of sources. */
double ns_circuit_choice_shift_unknown(const ns_circuit *c, const element *e, double size);
/* The largest voltage of a V; how large constant + sum of count terms is, at most.  Errors: MEMORY. */
int ns_circuit_largest_source(const ns_circuit *c, double *volts);
int ns_circuit_largest_sum(double constant, const ns_input_gain *term, int count, double *largest);

/* The commands of all switches (switch_commands.c).  Errors: MEMORY. */
int ns_circuit_stamp_commands(const stamp *to);

/* Resistors that leaks at their nodes would be lost beside get their currents as unknowns (tiny_resistor.c).
 * Errors: MEMORY. */
int ns_circuit_tiny_resistors(ns_circuit *c);

/* ground_reference.c: the row of a node; ground has the row after those of the nodes. */
int ns_circuit_row_or_ground(const ns_circuit *c, int node);

/* Parts without any connection to ground get one (ground_reference.c).  Errors: MEMORY. */
int ns_circuit_ground_reference(const stamp *to);

#endif
