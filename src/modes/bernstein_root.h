/* src/modes/bernstein_root.h - where in a step a guard breaks: polynomials by Laguerre's (E1). */
#ifndef NS_MODES_BERNSTEIN_ROOT_H
#define NS_MODES_BERNSTEIN_ROOT_H

#include "laguerre.h"

enum { NS_SEARCH_TERMS = NS_ORDER + 1 };

/* A guard over a step as a polynomial of the share u of it, in [0, 1]: p[0] + p[1] u + ... */
typedef struct ns_curve {
    int terms;
    double p[NS_SEARCH_TERMS];
} ns_curve;

/* From the coefficients G of (-1)^i L_i(end u). */
void ns_modes_curve_of(int terms, const double *G, double end, ns_curve *c);

/* Its part up to share `end` of it, or from share `from` on, as a curve of its own. */
void ns_modes_curve_cut(const ns_curve *c, double end, ns_curve *part);
void ns_modes_curve_rest(const ns_curve *c, double from, ns_curve *part);

/* 1 if a bound tells that it is nowhere below -tol. */
int ns_modes_curve_holds(const ns_curve *c, double tol);

/* The first share from which on it is below -tol; NAN: it never is. */
double ns_modes_curve_below(const ns_curve *c, double tol);

/* The last share before a root near `at`, where it is about to be below zero; INFINITY: after the step. */
double ns_modes_curve_root(const ns_curve *c, double at);

double ns_modes_curve_slope(const ns_curve *c, double u);

typedef double ns_function(const void *data, double at);

/* Where f passes from zero or more at a to below zero at b: the last point before, by chords, to eps of it;
 * a: it is below zero there. */
double ns_modes_chords(ns_function *f, const void *data, double a, double b, double eps);

#endif
