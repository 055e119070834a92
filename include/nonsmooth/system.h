/* nonsmooth/system.h - complementarity systems, linear form:
 *
 *   (S1)  M x' = A x + b + E z(t) + r        M may be singular (a circuit's DAE)
 *   (S2)  r    = B lambda
 *   (S3)  y    = C x + D lambda + F z(t) + e
 *   (S4)  -y in N_[l,u](lambda)
 *
 * and commanded pairs (switches): pair k of a command has the bounds of its state, closed
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

typedef struct ns_command {
    int pair;   /* the commanded pair */
    double on;  /* closes above, */
    double off; /* opens below; off <= on */
    double g0;
    double
        *gx; /* n, or NULL where the control is a function of time only: its instants are then hit exactly */
    double *gz; /* nz, or NULL where no input acts on it directly */
} ns_command;

/* The matrices of a large system, and as columns the controls of its commands. */
typedef struct ns_large {
    ns_csc M, A, B, C, D, E, F;
    ns_csc gx, gz; /* n*nc, nz*nc; an empty column of gx: a function of time only */
} ns_large;

/* Every array belongs to the system and is NULL where its size is zero.  z entries are functions of
 * time; constant sources belong in b and e.  Where n+m is large, ns_circuit_system() makes a system whose
 * M to F, gx and gz are NULL and that has them in `large`: for NS_AUTO, NS_SPARSE, NS_THETA with `capture`,
 * and, up to 1500 unknowns and pairs, for the marcher's dense engines, which take a copy. */
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
} ns_system;

/* A system of these sizes, all zero, l = 0, u = inf, commands with gx and gz NULL.
 * Errors: NULL, SIZE, MEMORY. */
int ns_system_create(int n, int m, int nz, int nc, ns_system **out);

/* The same with `large`, whose matrices are empty (start NULL) still, in place of the arrays.  Errors: as
 * ns_system_create(). */
int ns_system_create_large(int n, int m, int nz, int nc, ns_system **out);

/* Frees a system and all its arrays; half-built and NULL are allowed. */
void ns_system_free(ns_system *s);

/* Puts a copy of signal at z[i].  Errors: NULL, SIZE, MEMORY, those of ns_signal_check(). */
int ns_system_set_input(ns_system *s, int i, const ns_signal *signal);

/* Refuses what cannot be integrated: NaN, l > u, off > on, a pair commanded twice, wrong indices.
 * fault (may be NULL) names where.  Errors: NULL, SIZE, NUMBER, RANGE, BOUNDS. */
int ns_system_check(const ns_system *s, ns_fault *fault);

/* z(t) seen from one side of t.  z: nz. */
void ns_system_inputs(const ns_system *s, double t, ns_side side, double *z);

/* w = M x: charges and fluxes.  x, w: n. */
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
