/* src/engine/leak.h - what the ideal laws leave open, settled as the limit of real devices. */
#ifndef NS_LEAK_H
#define NS_LEAK_H

#include "stepper.h"

/* Fills g (m, siemens) and rho (m, ohm): for each pair a conductance across it and a resistance in series
 * with it that are share times what the step of length h sees at its terminals. */
void ns_leak_sizes(const ns_theta *s, double h, int implicit, double share, double *g, double *rho);

/* Solves K X = X in place, K = s->K of (P2) for this mode, size n+nj, nrhs columns, where K is singular: X is
 * the limit for vanishing leaks.  Errors: SINGULAR (the equations contradict each other, or leaks do not
 * settle them), MEMORY. */
int ns_leak_solve(ns_theta *s, double h, int implicit, const ns_mode *mode, int nj, int nrhs);

#endif
