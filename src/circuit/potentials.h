/* src/circuit/potentials.h - potentials of nodes, and their differences, as sums of inputs. */
#ifndef NS_CIRCUIT_POTENTIALS_H
#define NS_CIRCUIT_POTENTIALS_H

#include "circuit_internal.h"

/* The potential of a node: by how many volts each input counts in it, by ascending input; nz stands for the
 * constant 1. */
typedef struct ns_potential {
    int count;
    int *of;
    double *volts;
} ns_potential;

typedef struct ns_potentials {
    const ns_circuit *c;
    int count;                /* used nodes, then ground */
    int nz;                   /* inputs */
    int *group;               /* count */
    int *next;                /* count: the next node of the same group, in a ring */
    int *size;                /* count: of the group of this number */
    ns_potential *volts;      /* count: against the group's own zero */
    double *gap;              /* nz+1: v_p - v_n of a source, */
    int *in_gap;              /* nz+1: the inputs it is made of, */
    char *has;                /* nz+1: these, marked */
    const ns_signal **signal; /* nz+1: of each input */
    int in_gap_count;
    double largest; /* V: of all sources; 0: not known yet */
    int failed;     /* memory ran out */
} ns_potentials;

/* Of the circuit; 0: memory ran out.  What is there is freed in either case. */
int ns_circuit_potentials_find(ns_potentials *p, const ns_circuit *c);
void ns_circuit_potentials_free(ns_potentials *p);

/* Where a node stands in volts and group. */
int ns_circuit_potentials_place(const ns_potentials *p, int number);

/* gap = 0; gap += volts times input k (nz: the constant 1). */
void ns_circuit_potentials_clear_gap(ns_potentials *p);
void ns_circuit_potentials_add_gap(ns_potentials *p, int k, double volts);

/* gap += gain (v_p - v_n), of places; 0 if they are of different groups. */
int ns_circuit_potentials_add_difference(ns_potentials *p, double gain, int at_p, int at_n);

/* gap += the first terms of an element; 0 if one is a current, or its node is not known against ground. */
int ns_circuit_potentials_add_terms(ns_potentials *p, const element *e, int count);

#endif
