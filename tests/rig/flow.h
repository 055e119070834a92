/* tests/rig/flow.h - an event-driven integrator that shares nothing with the library: matrix exponentials.
 *
 * x' = A x inside each mode (a constant input is one more unknown with a zero row); where a mode ends is
 * found by halving. */
#ifndef NONSMOOTH_TESTS_FLOW_H
#define NONSMOOTH_TESTS_FLOW_H

enum { FLOW_N = 6, FLOW_MODES = 4, FLOW_LEVELS = 40 };

typedef struct flow {
    int n, modes;
    double dt;
    double A[FLOW_MODES][FLOW_N * FLOW_N]; /* n*n, row by row */
    /* The mode that holds at x, for one who comes from `mode`: `mode` itself while it lasts. */
    int (*next)(int mode, const double *x);
    /* Puts x onto the constraints of a mode just entered; may be NULL. */
    void (*land)(int mode, double *x);
    double E[FLOW_MODES][FLOW_LEVELS + 1][FLOW_N * FLOW_N]; /* exp(A dt / 2^k), by flow_prepare() */
} flow;

void flow_prepare(flow *f);

/* steps of dt; mode and x are read and written.  Returns how often the mode changed. */
long flow_run(const flow *f, long steps, int *mode, double *x);

#endif
