/* src/mlcp/infeasible/fault.c - which pairs a failure is about. */
#include "mlcp/mlcp_internal.h"

#include <math.h>

void ns_mlcp_name(ns_mlcp_solver *s, const double *weight, int n, const int *index) {
    const double none = 1e-9; /* of the largest: rounding */
    double top = 0.0;
    s->fault.npairs = 0;
    for (int k = 0; k < n; k++)
        top = fmax(top, weight[k]);
    for (int count = 0; count < n && count < NS_FAULT_MAX; count++) {
        int best = -1;
        for (int k = 0; k < n; k++) {
            int taken = 0;
            for (int f = 0; f < count; f++)
                taken |= s->fault.pair[f] == index[k];
            if (!taken && weight[k] > none * top && (best < 0 || weight[k] > weight[best]))
                best = k;
        }
        if (best < 0)
            return;
        s->fault.pair[s->fault.npairs++] = index[best];
    }
}

void ns_mlcp_list(ns_mlcp_solver *s, int n, const int *index) {
    s->fault.npairs = n < NS_FAULT_MAX ? n : NS_FAULT_MAX;
    for (int k = 0; k < s->fault.npairs; k++)
        s->fault.pair[k] = index[k];
}
