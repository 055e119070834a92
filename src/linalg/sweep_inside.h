/* src/linalg/sweep_inside.h - packed triangular factors from inside: shared by sweep.c, steady.c. */
#ifndef NS_SWEEP_INSIDE_H
#define NS_SWEEP_INSIDE_H

#include "sweep.h"

struct ns_sweep {
    int n, out, blocks;
    int *begin;            /* blocks+1: of the unknowns of a block */
    int *row, *to;         /* n: where unknown k takes its right-hand side, and leaves its value */
    int *out_row, *out_to; /* out: the same of those left out */
    int *l, *u;            /* n+1: row k of L (below the diagonal) and F, of U (above it) over its pivot, */
    int *li, *ui;          /* their columns, */
    double *lx, *ux;       /* and values; but for those */
    double *below, *above; /* n: right beside the diagonal, which wait for the one just solved for */
    double *scale, *pivot; /* n: the right-hand side is multiplied by; of U, reciprocal */
    double *of;            /* of pivots chosen once (steady.h), which then own all places: the matrix */
};

#endif
