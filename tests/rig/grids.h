/* tests/rig/grids.h - (P1) of passive networks with a plan: ladders and meshes of resistances and capacitors
 * with ideal diodes, of any size (random ones: networks.c). */
#ifndef NONSMOOTH_TESTS_GRIDS_H
#define NONSMOOTH_TESTS_GRIDS_H

#include "sample.h"

typedef enum grid_kind {
    GRID_LADDER, /* reduced: a chain of nodes, diodes from each to the next: W = E' K^-1 E */
    GRID_MESH,   /* reduced: a square mesh with twice as many ideal diodes as nodes: loops, W of half rank */
    GRID_RON,    /* the same, diodes of 1 mOhm and 1 GOhm */
    GRID_NODES,  /* whole: its nodes are equalities, as many diodes; few resistors, pF beside uF */
    GRID_SWITCHES, /* the same, a fifth of the devices closed switches, some in loops: redundant */
    GRID_KINDS
} grid_kind;

const char *grid_name(int kind);

/* Problem `number` of m <= s->cap unknowns, driven by random currents into the nodes; no answer is known, but
 * there is one: y = W lambda + q >= 0 can be met and W is positive semidefinite. */
void grid_make(sample *s, int kind, int m, unsigned long long number);

#endif
