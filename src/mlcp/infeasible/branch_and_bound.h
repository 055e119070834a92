/* src/mlcp/infeasible/branch_and_bound.h - is there a solution at all? */
#ifndef NS_MLCP_BRANCH_AND_BOUND_H
#define NS_MLCP_BRANCH_AND_BOUND_H

#include "mlcp/mlcp_internal.h"

enum { NS_BRANCH_MAX = 16 };

/* Looks for a solution of s->now by cutting branches without any.  OK: s->lambda has natural residual <=
 * NS_MLCP_ACCEPT, s->mode is its mode.  INFEASIBLE: there is none, every mode has a proof; s->fault names
 * what they rest on; s->proof, s->proved where one proof holds for all.  LIMIT: not known.  SIZE: more than
 * NS_BRANCH_MAX pairs. */
int ns_mlcp_branch_and_bound(ns_mlcp_solver *s);

#endif
