/* nonsmooth/model.h - complementarity systems in general form:
 *
 *   (S1)  M x' = f(x,t) + r              M constant, may be singular
 *   (S2)  r    = g(x,lambda,t)
 *   (S3)  y    = h(x,lambda,t)
 *   (S4)  -y in N_[l,u](lambda)
 *
 * f, g, h are callbacks, with callbacks for their Jacobians A = df/dx, K = dg/dx, B = dg/dlambda,
 * C = dh/dx, D = dh/dlambda.  For a linear system use an ns_system: it needs no callbacks and no Newton loop.
 * ns_model_of_system() makes a model of one.
 */
#ifndef NONSMOOTH_MODEL_H
#define NONSMOOTH_MODEL_H

#include "nonsmooth/system.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The point at which a function is evaluated. */
typedef struct ns_point {
    double t;             /* s */
    const double *x;      /* n */
    const double *lambda; /* m */
    const double *z;      /* nz: the inputs at t */
} ns_point;

/* Writes a value or a Jacobian, all entries of it (column by column).  0: done; anything else: the point is
 * outside the domain of the function, and a shorter step is tried. */
typedef int (*ns_function)(const ns_point *at, void *data, double *out);

/* A model; everything in it belongs to the caller. */
typedef struct ns_model {
    int n, m, nz;        /* unknowns, pairs, inputs */
    const double *M;     /* n*n */
    const double *l, *u; /* m */
    const ns_signal *z;  /* nz */
    void *data;          /* handed to the callbacks */
    ns_function f, A;    /* n, n*n */
    ns_function g, B;    /* n, n*m;  NULL where m is 0 */
    ns_function h, C;    /* m, m*n;  NULL where m is 0 */
    ns_function K;       /* n*n; NULL: g does not depend on x */
    ns_function D;       /* m*m; NULL: h does not depend on lambda */
} ns_model;

/* Refuses what cannot be integrated.  fault (may be NULL) names where.
 * Errors: NULL, SIZE, NUMBER, BOUNDS, those of ns_signal_check(). */
int ns_model_check(const ns_model *model, ns_fault *fault);

/* The functions of a model whose Jacobian is being checked. */
typedef enum ns_jacobian {
    NS_JACOBIAN_A,
    NS_JACOBIAN_K,
    NS_JACOBIAN_B,
    NS_JACOBIAN_C,
    NS_JACOBIAN_D
} ns_jacobian;

typedef struct ns_jacobian_error {
    double error; /* largest disagreement beyond what the differences themselves are uncertain by, relative to
                     the entry: 0 to 1e-8 if right, 1 where an entry is missing, 2 where its sign is wrong */
    ns_jacobian which; /* where it is */
    int row, column;
    double given, expected; /* the entry as the callback has it, and as differences of the function have it */
} ns_jacobian_error;

/* Compares all Jacobians at a point (x: n, lambda: m) with central differences of f, g and h.
 * Errors: those of ns_model_check(), MEMORY, NUMBER (a callback gave NaN or refused the point). */
int ns_model_check_jacobians(const ns_model *model, double t, const double *x, const double *lambda,
                             ns_jacobian_error *worst);

/* Makes a model of s; its data is s, which must outlive it.  Errors: SIZE (s has commanded pairs). */
int ns_model_of_system(const ns_system *s, ns_model *out);

#ifdef __cplusplus
}
#endif
#endif
