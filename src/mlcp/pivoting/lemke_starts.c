/* src/mlcp/pivoting/lemke_starts.c - Lemke's method from different starting modes, with different covering
 * vectors, until one of them answers. */
#include "mlcp/mlcp_internal.h"

enum { ROUNDS = 3 };               /* runs of Lemke's method, each from the mode of the last */
static const double RCOND = 1e-13; /* a starting basis must keep three digits */

/* From s->mode to an answer by at most ROUNDS runs of Lemke's method. */
static int attempt(ns_mlcp_solver *s, int all, int patience, double *residual) {
    double rcond;
    int status = ns_mlcp_basis_factor(s, &rcond);
    if (status != NS_OK || rcond < RCOND) {
        status = ns_mlcp_reveal(s);
        if (status == NS_OK)
            status = ns_mlcp_basis_factor(s, NULL);
        if (status != NS_OK)
            return NS_E_SINGULAR;
    }
    for (int round = 0; round < ROUNDS; round++) {
        ns_mlcp_basis_values(s, s->tab.refined);
        ns_mlcp_basis_sizes(s);
        double v = ns_mlcp_basis_violation(s);
        if (v > NS_MLCP_GUARD) {
            ns_mlcp_basis_values(s, 1 + s->tab.refined);
            v = ns_mlcp_basis_violation(s);
        }
        if (v > NS_MLCP_GUARD) {
            if (isinf(v))
                return NS_E_OVERFLOW;
            ns_mlcp_tableau_start(s);
            status = ns_mlcp_lemke(s, all, patience);
            if (status != NS_OK)
                return status;
            if (ns_mlcp_basis_factor(s, NULL) != NS_OK)
                return NS_E_SINGULAR;
        }
        status = ns_mlcp_mode_answer(s, residual);
        if (status == NS_OK)
            return NS_OK;
    }
    return status;
}

/* Different starts and covers, until one answers or ends in a ray of a problem without solution.  On problems
 * that are not monotone paths may be long, and of very different lengths: patience comes last. */
int ns_mlcp_lemke_starts(ns_mlcp_solver *s, const ns_mode *mode, double *residual) {
    static const struct {
        int lower, all, patience;
    } way[] = {{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1},  {1, 2, 4},  {0, 2, 4},
               {1, 3, 4}, {0, 3, 4}, {1, 4, 4}, {1, 5, 16}, {1, 6, 16}, {1, 7, 16}};
    int first = NS_E_LIMIT;
    for (size_t k = 0; k < sizeof way / sizeof *way; k++) {
        ns_mlcp_restart(s, way[k].lower ? NULL : mode);
        s->tab.refined = k > 0;
        int status = attempt(s, way[k].all, way[k].patience, residual);
        if (status == NS_OK)
            return NS_OK;
        if (status == NS_E_INFEASIBLE && ns_mlcp_prove(s, NS_CAREFUL))
            return status;
        if (s->elim.nstuck > 0)
            return NS_E_SINGULAR; /* no start will do */
        if (k == 0 || (first == NS_E_LIMIT && status != NS_E_SINGULAR && status != NS_E_OVERFLOW))
            first = status;
    }
    return first;
}
