/* src/linalg/sweep.h - solutions with factors that are packed: each block's L forward and U backward, all in
 * the order in which they are met. */
#ifndef NS_SWEEP_H
#define NS_SWEEP_H

#include <stddef.h>

typedef struct ns_sweep {
    int n, blocks;
    const int *begin;    /* blocks+1: of the unknowns of a block, which has L if there are more than one */
    const int *row, *to; /* n: where unknown k takes its right-hand side, and leaves its value */
    const double *scale; /* n: that side is multiplied by */
    const int *l, *u;    /* n+1: column k of L (below the diagonal), of U (above it, other blocks included) */
    const int *li, *ui;
    const double *lx, *ux, *pivot; /* pivot, n: of U, reciprocal */
} ns_sweep;

/* b (n) becomes the solution; x (n): work. */
void ns_sweep_solve(const ns_sweep *s, double *b, double *x);

#endif
