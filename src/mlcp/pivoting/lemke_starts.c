/* src/mlcp/pivoting/lemke_starts.c - Lemke's method from different starting modes, with different covering
 * vectors, until one of them answers. */
#include "mlcp/mlcp_internal.h"

enum { ROUNDS = 2 }; /* runs of Lemke's method, each from the mode of the last (stress: mixed 359) */
static const double RCOND = 1e-13; /* a starting basis must keep three digits */

/* Factors a basis of s->mode, or of one near it. */
static int factor_or_reveal(ns_mlcp_solver *s) {
    double rcond;
    if (ns_mlcp_basis_factor(s, &rcond) == NS_OK && rcond >= RCOND)
        return NS_OK;
    return ns_mlcp_reveal(s) == NS_OK && ns_mlcp_basis_factor(s, NULL) == NS_OK ? NS_OK : NS_E_SINGULAR;
}

/* From s->mode, whose G is factored, to that of a solution. */
static int find_mode(ns_mlcp_solver *s, int all, int limit_factor) {
    ns_mlcp_basis_values(s, 0);
    ns_mlcp_basis_sizes(s);
    const double v = ns_mlcp_basis_violation(s);
    if (v <= NS_MLCP_GUARD)
        return NS_OK;
    if (isinf(v))
        return NS_E_OVERFLOW;
    ns_mlcp_tableau_start(s);
    const int status = ns_mlcp_lemke(s, all, limit_factor);
    return status == NS_OK && ns_mlcp_basis_factor(s, NULL) != NS_OK ? NS_E_SINGULAR : status;
}

/* From s->mode to an answer. */
static int solve_from_mode(ns_mlcp_solver *s, int all, int limit_factor, double *residual) {
    int status = factor_or_reveal(s);
    for (int round = 0; round < ROUNDS && status == NS_OK; round++) {
        status = find_mode(s, all, limit_factor);
        if (status == NS_OK && ns_mlcp_mode_answer(s, residual) == NS_OK)
            return NS_OK;
    }
    return status == NS_OK ? NS_E_RESIDUAL : status;
}

/* Different starts and covers, until one answers or ends in a ray of a problem without solution.  On problems
 * that are not monotone paths may be long, and of very different lengths: limit_factor comes last. */
int ns_mlcp_lemke_starts(ns_mlcp_solver *s, const ns_mode *mode, double *residual) {
    static const struct {
        int lower, all, limit_factor;
    } start[] = {{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1},  {1, 2, 4},  {0, 2, 4},
                 {1, 3, 4}, {0, 3, 4}, {1, 4, 4}, {1, 5, 16}, {1, 6, 16}, {1, 7, 16}};
    int first = NS_E_LIMIT;
    for (size_t k = 0; k < sizeof start / sizeof *start; k++) {
        ns_mlcp_start_from(s, start[k].lower ? NULL : mode);
        int status = solve_from_mode(s, start[k].all, start[k].limit_factor, residual);
        if (status == NS_OK)
            return NS_OK;
        if (status == NS_E_INFEASIBLE && ns_mlcp_prove(s, NS_CAREFUL))
            return status;
        if (k == 0)
            first = status;
    }
    return first;
}
