/* src/theta/name_fault.h - what a failed problem names: unknowns and pairs of the system. */
#ifndef NS_THETA_NAME_FAULT_H
#define NS_THETA_NAME_FAULT_H

#include "linalg/dense.h"
#include "nonsmooth/mlcp.h"

/* (P1) unreduced: its first n rows are those of the system combined by T (n*n, ns_system_split()), the first
 * rank of them times h; then m pairs. */
typedef struct ns_fault_context {
    int n, m, rank;
    const double *T;
    double h;
} ns_fault_context;

/* Names in `to` what `from` names by indices of p: pairs, and for a row the unknown whose row of the system
 * it is.  Combined rows are taken apart by the solver's certificate, if it has one.  lu: work. */
void ns_theta_name_fault(const ns_fault_context *b, const ns_mlcp *p, const ns_mlcp_solver *solver,
                         const ns_fault *from, ns_lu *lu, ns_fault *to);

/* The first few (NS_FAULT_MAX) of v (n, or NULL) that are not finite, into index; how many. */
int ns_theta_name_infinite(int n, const double *v, int *index);

#endif
