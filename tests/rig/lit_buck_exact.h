/* tests/rig/lit_buck_exact.h - the buck converter of the literature integrated without complementarity. */
#ifndef NONSMOOTH_TESTS_LIT_BUCK_EXACT_H
#define NONSMOOTH_TESTS_LIT_BUCK_EXACT_H

#include "literature.h"

/* x at every, 2 every, ... samples*every (X: samples * LIT_BUCK_N), from rest.  gain is that of the
 * comparator, 15 in the circuit.  An explicit Runge-Kutta pair (5,4) with local errors below tolerance,
 * relative to the sizes of the states, on
 *     x' = f(x, t, v(D)),  v(D) the root of KCL at D, which is piecewise linear and monotone in v(D). */
void lit_buck_exact(int hinges, lit_set set, double gain, double tolerance, double every, int samples,
                    double *X);

#endif
