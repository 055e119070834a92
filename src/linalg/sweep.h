/* src/linalg/sweep.h - triangular factors packed for many solutions: each block's L forward and U backward,
 * in the order in which they are met.
 *
 * Unknowns that no other one enters (the current of what is open) are left out: they are zero where their
 * right-hand side is.
 */
#ifndef NS_SWEEP_H
#define NS_SWEEP_H

#include <stddef.h>

/* P (A / Rs) Q = L U + F, L and U in blocks on the diagonal, F above them, as klu_extract() gives them:
 * columns with their diagonals. */
typedef struct ns_triangles {
    int n, blocks;
    int often_zero; /* rows of A from here on may be left out */
    int *R, *P, *Q; /* blocks+1, n, n */
    double *Rs;     /* n, by rows of L */
    int *Lp, *Li, *Up, *Ui, *Fp, *Fi;
    double *Lx, *Ux, *Fx;
} ns_triangles;

typedef struct ns_sweep ns_sweep;

/* NULL: no memory.  NULL may be freed. */
ns_sweep *ns_sweep_create(const ns_triangles *t);
void ns_sweep_free(ns_sweep *s);

/* b (n) becomes the solution; x (n): work.  0: what is left out is not zero, b is untouched. */
int ns_sweep_solve(const ns_sweep *s, double *b, double *x);

#endif
