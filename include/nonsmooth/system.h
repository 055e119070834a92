/* nonsmooth/system.h - complementarity systems, linear form:
 *
 *   (S1)  M x' = A x + b + E z(t) + r        M may be singular (a circuit's DAE)
 *   (S2)  r    = B lambda
 *   (S3)  y    = C x + D lambda + F z(t) + e
 *   (S4)  -y in N_[l,u](lambda)
 *
 * and commanded pairs (switches): the pair of a command has the bounds of its state, closed
 * [-inf, inf] (an equality, y = 0) or open [0, 0] (lambda = 0); it closes when
 *   g = gx x + gz z(t) + g0   rises above on,   and opens when g falls below off (off <= on).
 */
#ifndef NONSMOOTH_SYSTEM_H
#define NONSMOOTH_SYSTEM_H

#include "nonsmooth/csc.h"
#include "nonsmooth/mlcp.h"
#include "nonsmooth/signal.h"

#ifdef __cplusplus
extern "C" {
#endif

/* When a commanded pair closes and opens; the control is g = gx x + gz z(t) + g0. */
typedef struct ns_command {
    int pair;   /* the commanded pair */
    double on;  /* the pair closes when g rises above this */
    double off; /* it opens when g falls below this; off <= on */
    double g0;  /* constant part of g */
    double *gx; /* n; NULL: g is a function of time only, and its instants are hit exactly */
    double *gz; /* nz; NULL: no input acts on g directly */
    int closed; /* 1: at a start it is closed where g is between off and on; 0: open */
} ns_command;

/* The matrices of a large system; the controls of its commands are the columns of gx and gz. */
typedef struct ns_large {
    ns_csc M, A, B, C, D, E, F;
    ns_csc gx, gz; /* n*nc, nz*nc; an empty column of gx: a function of time only */
} ns_large;

/* A system.  Every array belongs to it and is NULL where its size is zero.  The inputs z are functions of
 * time; constant sources belong in b and e.  If n+m is large, ns_circuit_system() makes a system whose M to
 * F, gx and gz are NULL and stand in `large` instead.  NS_AUTO, NS_SPARSE and NS_THETA with `capture` use it
 * as it is; up to 1500 unknowns and pairs the dense engines work on a copy. */
typedef struct ns_system {
    int n;               /* unknowns x */
    int m;               /* pairs */
    int nz;              /* inputs z(t) */
    int nc;              /* commands */
    double *M, *A;       /* n*n */
    double *B;           /* n*m */
    double *C;           /* m*n */
    double *D;           /* m*m */
    double *b, *E;       /* n, n*nz */
    double *e, *F;       /* m, m*nz */
    double *l, *u;       /* m; those of commanded pairs are ignored */
    ns_signal *z;        /* nz; PWL arrays owned */
    ns_command *command; /* nc */
    ns_large *large;     /* NULL, or owned */
    unsigned char
        *balance;   /* n; 1: row i is Kirchhoff's current law of a node, x_i its voltage; 0: not known */
    double *ground; /* n: the row of ground in A: with all balances column j adds up to 0; NAN: not known */
} ns_system;

/* A system of these sizes, all zero, l = 0, u = inf, commands with gx and gz NULL.
 * Errors: NULL, SIZE, MEMORY. */
int ns_system_create(int n, int m, int nz, int nc, ns_system **out);

/* The same with sparse matrices, `large`, in place of M to F, gx, gz; they are still empty (start NULL).
 * Errors: as ns_system_create(). */
int ns_system_create_large(int n, int m, int nz, int nc, ns_system **out);

/* Frees a system and all its arrays; half-built and NULL are allowed. */
void ns_system_free(ns_system *s);

/* Puts a copy of signal at z[i].  Errors: NULL, SIZE, MEMORY, those of ns_signal_check(). */
int ns_system_set_input(ns_system *s, int i, const ns_signal *signal);

/* Refuses what cannot be integrated: NaN, l > u, off > on, a pair commanded twice, wrong indices.
 * fault (may be NULL) names where.  Errors: NULL, SIZE, NUMBER, RANGE, BOUNDS. */
int ns_system_check(const ns_system *s, ns_fault *fault);

/* Writes z(t), from the left or from the right of t.  z: nz. */
void ns_system_inputs(const ns_system *s, double t, ns_side side, double *z);

/* Writes w = M x, the charges and fluxes.  x, w: n. */
void ns_system_charges(const ns_system *s, const double *x, double *w);

/* The rows of (S1) put in the order differential first, algebraic last: finds T (n*n), nonsingular,
 * such that rows r..n-1 of T M are exactly zero and rows 0..r-1 are linearly independent.  r goes to
 * *rank.  T sums KCL rows across loops of capacitors and the like: entries of a circuit's T are small
 * integers but for coupled inductors with K = 1.  Errors: NULL, MEMORY. */
int ns_system_split(const ns_system *s, double *T, int *rank);

#ifdef __cplusplus
}
#endif
#endif
