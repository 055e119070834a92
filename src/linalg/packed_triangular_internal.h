/* src/linalg/packed_triangular_internal.h - packed triangular factors from inside: shared by
 * packed_triangular.c, partial_refactor.c. */
#ifndef NS_LINALG_PACKED_TRIANGULAR_INTERNAL_H
#define NS_LINALG_PACKED_TRIANGULAR_INTERNAL_H

#include "packed_triangular.h"

struct ns_packed_triangular {
    int n, out, blocks;
    int *begin;            /* blocks+1: of the unknowns of a block */
    int *row, *to;         /* n: where unknown k takes its right-hand side, and leaves its value */
    int *out_row, *out_to; /* out: the same of those left out */
    int *l, *u;            /* n+1: row k of L (below the diagonal) and F, of U (above it) over its pivot, */
    int *li, *ui;          /* their columns, */
    double *lx, *ux;       /* and values; but for those */
    double *below, *above; /* n: right beside the diagonal, which wait for the one just solved for */
    double *scale, *pivot; /* n: the right-hand side is multiplied by; of U, reciprocal */
    double *of; /* of pivots chosen once (partial_refactor.h), which then own all places: the matrix */
};

/* The next of the arrays that share a block. */
static inline int *ns_packed_next(int **from, int count) {
    int *first = *from;
    *from += count;
    return first;
}

#endif
