/* src/theta/floating_dc.h - parts of a circuit that only capacitors tie to the rest, at the operating point.
 */
#ifndef NS_THETA_FLOATING_DC_H
#define NS_THETA_FLOATING_DC_H

#include "theta_internal.h"

/* s->K, s->rhs: the problem of the operating point, with nhold unknowns held.  Rows that follow from others
 * become: the charge of a part that floats is zero, the flux of a loop of inductors is zero.  Errors: MEMORY.
 */
int ns_theta_floating_dc(ns_theta *s, int nhold, const int *hold);

#endif
