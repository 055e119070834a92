/* src/theta/regularise.h - what the ideal laws do not determine, taken as the limit of real devices. */
#ifndef NS_THETA_REGULARISE_H
#define NS_THETA_REGULARISE_H

#include "theta_internal.h"

/* A conductance across pair j (siemens), a resistance in series with it (ohm): such that in a matrix K of
 * (P2) or of (P1) unreduced they are entries of that fraction, in the scaling of K (s->lu, to which K was
 * given last).  row: the row and column of pair j in K. */
double ns_theta_leak_across(const ns_theta *s, double ht, int j, double fraction);
double ns_theta_leak_series(const ns_theta *s, int row, double fraction);

/* The leaks of a matrix of (P2), G: their conductances, where a pair is inside its resistance. */
typedef struct ns_leaks {
    const ns_mode *mode;
    double ht;  /* factor of the differential rows of (P2) */
    double *of; /* m */
} ns_leaks;

/* Solves (P2) of this mode where its matrix, s->K (size n+nj), is singular: s->X holds nrhs right-hand sides
 * and gets the solutions, the limit for vanishing leaks.  On success leaks->of (m, the caller's) is known and
 * s->lu holds K_g = K + G, s->K is left as it was.  Errors: SINGULAR (the equations contradict each other, or
 * leaks do not determine them), MEMORY. */
int ns_theta_leak_solve(ns_theta *s, const ns_leaks *leaks, int nj, int nrhs);

/* out = G x (n+nj). */
void ns_theta_leak_times(const ns_theta *s, const ns_leaks *leaks, const double *x, double *out);

/* guard_rounding.c: the rounding of a map, after (P2) was solved: s->K, s->X and the factors; s->R holds the
 * right-hand sides; leaks: NULL, or those in the factors; exactly: as ns_theta_refine_residual(); fraction:
 * see ns_theta_map_build(). */
void ns_theta_map_rounding(ns_theta *s, ns_map *map, const ns_leaks *leaks, int nj, int exactly,
                           double fraction);

#endif
