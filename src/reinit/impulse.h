/* src/reinit/impulse.h - the impulse problem for the engines. */
#ifndef NS_REINIT_IMPULSE_H
#define NS_REINIT_IMPULSE_H

#include "theta/theta_internal.h"

/* ns_theta_impulse(), but what the laws do not determine of values is as near to `near` (n+m: x, lambda) as
 * it can be (NULL: to zero).  *jumps: there are impulses. */
int ns_reinit_impulse_solve(ns_theta *s, const double *z, const double *slope, const double *near,
                            const ns_impulse *out, int *jumps);

#endif
