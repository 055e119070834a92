/* tests/rig/matrices.h - random matrices of the classes that the theory of (P1) knows, into s->W. */
#ifndef NONSMOOTH_TESTS_MATRICES_H
#define NONSMOOTH_TESTS_MATRICES_H

#include "sample.h"

/* P: every principal minor is positive. */
void matrix_dominant(sample *s, double least, double density); /* rows, by at least `least` */
void matrix_definite(sample *s, double ridge, double skew);    /* V V'/m + ridge I + skew part */
void matrix_triangular(sample *s);                             /* symmetrically permuted */
void matrix_totally_positive(sample *s, int which);            /* 0 Cauchy, 1 min(i,j), 2 Pascal */
void matrix_inverse_dominant(sample *s);
void matrix_scale(sample *s, double decades); /* W := D1 W D2, D1, D2 > 0: P stays P, M stays M */

/* Positive semidefinite: V V' of the rank plus a skew part. */
void matrix_semidefinite(sample *s, int rank, int skew);

/* M: off the diagonal nothing positive. */
void matrix_m_dominant(sample *s, double least, double density);
void matrix_laplacian(sample *s, double lo, double hi, int grounded); /* conductances of 10^lo .. 10^hi */
void matrix_grid(sample *s, double ground);                           /* the obstacle problem's */
void matrix_leontief(sample *s);                                      /* I - N, row sums of N below 1 */

/* Copositive-plus. */
void matrix_strictly_copositive(sample *s, int rank); /* positive diagonal, nothing negative; + V V' */
void matrix_add_skew(sample *s);
void matrix_program(sample *s, int n,
                    int copositive);  /* [Q -A'; A 0], Q n*n, semidefinite or copositive-plus */
void matrix_blocks(sample *s, int n); /* nonnegative n*n, semidefinite rest, skew coupling */

#endif
