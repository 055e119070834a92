/* src/theta/floating_dc.h - parts of a circuit that only capacitors tie to the rest, at the operating point.
 */
#ifndef NS_THETA_FLOATING_DC_H
#define NS_THETA_FLOATING_DC_H

#include "theta_internal.h"

/* The parts, found by the first call; zeros before that. */
typedef struct ns_floating_parts {
    double *null; /* count*count: left null vectors of the rows without pairs, from row `rank` on */
    int rank;
} ns_floating_parts;

/* s->K, s->rhs: the problem of the operating point, with nhold unknowns held, the same ones in all calls with
 * these parts.  Rows that follow from others become: the charge of a part that floats is zero, the flux of a
 * loop of inductors is zero.  The caller frees parts->null, also after a failure.  Errors: MEMORY. */
int ns_theta_floating_dc(ns_theta *s, int nhold, const int *hold, ns_floating_parts *parts);

#endif
