/* src/mlcp/pivoting/transform.h - the principal pivot transform P of W, of some pairs only.
 *
 *     basic = P nonbasic
 *
 * with basic_i = lambda_i and nonbasic_i = y_i - q_i where lambda_i is basic (in[i]); the other way round
 * elsewhere.
 *
 * Of the pairs whose lambda is basic P is the inverse of their block of W; that is what is kept.  Others are
 * looked at when an exchange of theirs is asked for, and forgotten after it.  Each exchange is one rank-one
 * update in place.
 */
#ifndef NS_MLCP_TRANSFORM_H
#define NS_MLCP_TRANSFORM_H

#include "mlcp/mlcp_internal.h"

/* Nothing is basic. */
void ns_mlcp_transform_start(ns_mlcp_solver *s);

/* How much of diagonal entry i is left of the largest term it was summed from: without units; 0: nothing.
 * Looks at i. */
double ns_mlcp_transform_trust(ns_mlcp_solver *s, int i);
/* The same of the determinant of {i, j}. */
double ns_mlcp_transform_trust2(ns_mlcp_solver *s, int i, int j);

/* Column i, at all pairs: how fast the basic variables change with the nonbasic one of i (that of i itself
 * where lambda_i is not basic: P_ii).  Looks at i. */
void ns_mlcp_transform_column(ns_mlcp_solver *s, int i, double *rate);

/* Moves the basic variable of pair i to where its mode has it, with lambda of the basic pairs and y of the n
 * in list.  Before the exchange of i. */
void ns_mlcp_transform_move(ns_mlcp_solver *s, int i, int n, const int *list);

/* Exchange pair i, or i and j at once; they were looked at, and their trust is above 0. */
void ns_mlcp_transform_pivot(ns_mlcp_solver *s, int i);
void ns_mlcp_transform_pivot2(ns_mlcp_solver *s, int i, int j);

/* Exchanges the n pairs in list as far as that can be done in good faith; those that are left stand first
 * in list; returns how many. */
int ns_mlcp_transform_exchange(ns_mlcp_solver *s, int n, int *list);

/* Forgets the pairs whose lambda is not basic. */
void ns_mlcp_transform_tidy(ns_mlcp_solver *s);

/* lambda of s->mode, and lterms of the basic ones. */
void ns_mlcp_transform_values(ns_mlcp_solver *s);

/* Corrects lambda by what is left of y where it should be 0. */
void ns_mlcp_transform_correct(ns_mlcp_solver *s);

#endif
