/* tests/bench/oracle.h - references for piecewise linear circuits: power series in long double, which share
 * nothing with the library.
 *
 * In a mode x' is a linear function of (x, u), and so are of (x, x', u) the guards, positive while it holds;
 * u are inputs as power series.  The coefficients of x follow one from another,
 *
 *     (k+1) c_(k+1) = rates(c_k, u_k),      g_k = guards(c_k, (k+1) c_(k+1), u_k),
 *
 * and a mode ends at the first root of a guard's polynomial, found by halving.  Ideal devices leave nothing
 * stiff, so that steps of about a radian or a time constant are exact to rounding at this order. */
#ifndef NONSMOOTH_TESTS_ORACLE_H
#define NONSMOOTH_TESTS_ORACLE_H

typedef long double real;

enum { ORACLE_TERMS = 25 }; /* of a series */

typedef struct oracle {
    int n, nu, ng; /* states, inputs, guards */
    real h;        /* longest step, s */
    void *data;    /* handed to the callbacks; holds the mode */
    /* u: ORACLE_TERMS*nu, the coefficients of (t-t0)^k, k by k; NULL where nu is 0 */
    void (*inputs)(void *data, real t0, real *u);
    void (*rates)(void *data, const real *x, const real *u, real *dx);
    void (*guards)(void *data, const real *x, const real *dx, const real *u, real *g); /* NULL: none */
    /* The mode from t on: a guard (>= 0) broke, or a corner (-1) came; may put x onto a constraint. */
    void (*enter)(void *data, real t, int guard, real *x);
    real (*corner)(void *data, real t); /* the next after t at which inputs or commands change; NULL: none */
} oracle;

/* From x at t = 0 (after an enter() of the caller's) to times, ascending; out: count*n.  Returns how many
 * modes it saw; gives up with -1 where modes change without end. */
long oracle_run(const oracle *o, real *x, int count, const double *times, real *out);

/* Coefficients of a sine vo + va sin(2 pi freq t + phase) at t0, `stride` apart. */
void oracle_sine(real vo, real va, real freq, real degrees, real t0, int stride, real *u);

#endif
