/* src/mlcp/transform.h - the principal pivot transform P of W, pivot by pivot.
 *
 *     basic = P nonbasic,   pair by pair  basic, nonbasic = lambda_i, y_i - q_i  where lambda_i is basic
 * (in[i]) y_i - q_i, lambda_i  elsewhere
 *
 * P = W while nothing is basic.  Each exchange of one pair is one rank-one update in place.
 */
#ifndef NS_TRANSFORM_H
#define NS_TRANSFORM_H

#include "mlcp_internal.h"

/* P = W. */
void ns_transform_start(ns_mlcp_solver *s);

/* How much of diagonal entry k is left of the terms it was summed from, 0..1: without units. */
double ns_transform_trust(const ns_mlcp_solver *s, int k);
/* The same of the determinant of {k, l}. */
double ns_transform_trust2(const ns_mlcp_solver *s, int k, int l);

/* Exchange pair k, or k and l at once; their trust is above 0. */
void ns_transform_pivot(ns_mlcp_solver *s, int k);
void ns_transform_pivot2(ns_mlcp_solver *s, int k, int l);

/* Exchanges the n pairs in list as far as that can be done in good faith; those that are left stand first
 * in list; returns how many. */
int ns_transform_exchange(ns_mlcp_solver *s, int n, int *list);

/* lambda and y of s->mode from P, and the sizes of the terms each basic value was summed from. */
void ns_transform_values(ns_mlcp_solver *s);

/* Corrects lambda by what is left of y where it should be 0. */
void ns_transform_correct(ns_mlcp_solver *s);

#endif
