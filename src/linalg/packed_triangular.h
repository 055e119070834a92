/* src/linalg/packed_triangular.h - triangular factors packed for many solutions: each block's L forward and U
 * backward, in the order in which they are met.
 *
 * Unknowns that no other one enters (the current of what is open) are left out: they are zero where their
 * right-hand side is.
 */
#ifndef NS_LINALG_PACKED_TRIANGULAR_H
#define NS_LINALG_PACKED_TRIANGULAR_H

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

typedef struct ns_packed_triangular ns_packed_triangular;

/* NULL: no memory.  NULL may be freed. */
ns_packed_triangular *ns_linalg_packed_create(const ns_triangles *t);
void ns_linalg_packed_free(ns_packed_triangular *s);

/* b (n) becomes the solution; x (n): work.  0: what is left out is not zero, b is untouched. */
int ns_linalg_packed_solve(const ns_packed_triangular *s, double *b, double *x);

#endif
