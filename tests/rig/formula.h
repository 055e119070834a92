/* tests/rig/formula.h - one step of a linear system by (T1), (T6), (T7), (P1) and (T8), literally. */
#ifndef NONSMOOTH_TESTS_FORMULA_H
#define NONSMOOTH_TESTS_FORMULA_H

#include "dice.h"
#include "nonsmooth.h"

enum { FORMULA_N = 4, FORMULA_P = 3, FORMULA_Z = 2 };

/* Random, of these sizes; M regular, C = B' and D = 1, so that W_mlcp is a P-matrix; inputs 0. */
ns_system *formula_system(dice *d);

typedef struct formula_point {
    double x[FORMULA_N], lambda[FORMULA_P];
} formula_point;

typedef struct formula_inputs {
    double before[FORMULA_Z], end[FORMULA_Z], relation[FORMULA_Z]; /* at t_k, t_k+1, where the relation is */
} formula_inputs;

typedef struct formula_scheme {
    double h, theta, gamma;
    ns_relation relation;
} formula_scheme;

/* From k to next; x_free (N) may be NULL. */
void formula_step(const ns_system *s, const formula_scheme *o, const formula_point *k,
                  const formula_inputs *z, formula_point *next, double *x_free);

#endif
