/* src/mlcp/pivoting/mode_answer.c - the answer of one mode, refined as often as that helps. */
#include "mlcp/mlcp_internal.h"

#include <math.h>

#include "mlcp/verify/residual.h"

enum { REFINEMENTS = 3 };

static double try_answer(ns_mlcp_solver *s, int refinements) {
    ns_mlcp_basis_values(s, refinements);
    for (int i = 0; i < s->m; i++)
        if (!isfinite(s->lambda[i]) || !isfinite(s->y[i]))
            return INFINITY;
    ns_mlcp_basis_clamp(s);
    return ns_mlcp_measure(&s->now, s->lambda, s->alike, s->rhs, NULL);
}

/* The number of refinements with the least residual is taken: one too many may spoil a row in which all terms
 * are rounding. */
int ns_mlcp_mode_answer(ns_mlcp_solver *s, double *residual) {
    int best = 0, last = 0;
    *residual = try_answer(s, 0);
    while (*residual > NS_MLCP_GOOD && last < REFINEMENTS) {
        double r = try_answer(s, ++last);
        if (r < *residual) {
            *residual = r;
            best = last;
        }
    }
    if (last != best)
        *residual = try_answer(s, best);
    return *residual <= NS_MLCP_ACCEPT ? NS_OK : NS_E_RESIDUAL;
}
