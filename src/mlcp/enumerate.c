/* src/mlcp/enumerate.c - every mode in turn: placeholder. */
#include "mlcp_internal.h"

#include <math.h>

enum { MODES = 2048 };
static const double GUARD = 1e-12;

int ns_mlcp_enumerate(ns_mlcp_solver *s, double accept) {
    long modes = 1;
    double residual = 0.0;
    for (int a = 0; a < s->np && modes <= MODES; a++)
        modes *= isfinite(s->p->l[s->pair[a]]) && isfinite(s->p->u[s->pair[a]]) ? 3 : 2;
    if (modes > MODES)
        return NS_E_SIZE;
    for (long k = 0; k < modes; k++) {
        long code = k;
        for (int a = 0; a < s->np; a++) {
            int i = s->pair[a], base = isfinite(s->p->l[i]) && isfinite(s->p->u[i]) ? 3 : 2;
            s->mode[i] = ns_mlcp_mend(s, i, (ns_mode)(code % base == 0 ? NS_INSIDE : 2 * (code % base) - 3));
            code /= base;
        }
        if (ns_basis_factor(s, NULL) != NS_OK)
            continue;
        ns_basis_values(s, 1);
        ns_basis_sizes(s);
        if (ns_basis_violation(s) <= GUARD && ns_mlcp_judge(s, &residual) == NS_OK && residual <= accept)
            return NS_OK;
    }
    return NS_E_INFEASIBLE;
}
