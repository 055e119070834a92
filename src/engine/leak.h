/* src/engine/leak.h - what the ideal laws leave open, settled as the limit of real devices. */
#ifndef NS_LEAK_H
#define NS_LEAK_H

#include "stepper.h"

/* A conductance across pair j (siemens), a resistance in series with it (ohm): such that in a matrix K of
 * (P2) or of (P1) unreduced they are entries of that share, in the scaling of K (s->lu, to which K was given
 * last).  row: the row and column of pair j in K. */
double ns_leak_across(const ns_theta *s, double ht, int j, double share);
double ns_leak_series(const ns_theta *s, int row, double share);

/* Solves (P2) of this mode where its matrix, s->K (size n+nj), is singular: s->X holds nrhs right-hand sides
 * and gets the solutions, the limit for vanishing leaks.  Errors: SINGULAR (the equations contradict each
 * other, or leaks do not settle them), MEMORY. */
int ns_leak_solve(ns_theta *s, double h, int implicit, const ns_mode *mode, int nj, int nrhs);

#endif
