/* src/linalg/rank_revealing.h - a square matrix of any rank: what it annuls, and a solution where there is
 * one. */
#ifndef NS_LINALG_RANK_REVEALING_H
#define NS_LINALG_RANK_REVEALING_H

#include "dense.h"

typedef struct ns_ranked {
    int n, rank;
    const double *a;      /* n*n, the caller's */
    double *left, *right; /* n*n; rows rank..n-1 are a basis of the left and of the right null vectors */
    int *row, *column;    /* rank: a choice of independent rows, and of independent columns */
    double *core;         /* rank*rank: a at these */
    double *work;         /* 2 n */
    ns_lu *lu;
} ns_ranked;

/* Takes a apart, whose entries were summed from terms of these sizes (n*n).  a must outlive the result and
 * not change.  Errors: MEMORY; SINGULAR if row rank and column rank differ by rounding.  On failure *out is
 * NULL. */
int ns_linalg_ranked_create(int n, const double *a, const double *size, ns_ranked **out);
void ns_linalg_ranked_free(ns_ranked *f); /* NULL is allowed */

/* x (n) with a x = b on the independent rows, zero outside the independent columns. */
void ns_linalg_ranked_solve(ns_ranked *f, const double *b, double *x);

/* v' b for left null vector k = 0..n-rank-1, v; zero where that is rounding of the terms, whose sizes are
 * those of b and size (n, NULL: none).  *terms (may be NULL) gets their sum. */
double ns_linalg_ranked_left(const ns_ranked *f, int k, const double *b, const double *size, double *terms);

/* x (n) += share times right null vector k. */
void ns_linalg_ranked_add_right(const ns_ranked *f, int k, double share, double *x);

#endif
