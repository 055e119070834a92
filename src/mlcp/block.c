/* src/mlcp/block.c - principal pivoting by blocks, for many pairs: every round factors W_JJ of the mode anew
 * and flips all pairs whose guard is broken, as long as that lets their number fall every few rounds.  The
 * factors of the last mode are kept: a solve from there factors nothing.  Singular blocks are left to other
 * methods.
 */
#include <math.h>

#include "mlcp_internal.h"

enum { ROUNDS = 60, PATIENCE = 3 };
static const double RCOND = 1e-13; /* a basis must keep three digits */

/* Flips all whose guards are broken; returns how many. */
static int flip(ns_mlcp_solver *s) {
    int n = 0;
    for (int a = 0; a < s->np; a++) {
        const int i = s->pair[a];
        const ns_mode to = ns_basis_wanted(s, i);
        n += to != s->mode[i];
        s->mode[i] = to;
    }
    s->pivots += n;
    return n;
}

int ns_mlcp_block(ns_mlcp_solver *s) {
    int best = s->np + 1, patience = PATIENCE;
    double residual, rcond;
    for (int round = 0; round < ROUNDS && patience > 0; round++) {
        if (ns_basis_keep_factors(s, &rcond) != NS_OK || rcond < RCOND)
            return NS_E_SINGULAR;
        ns_basis_values(s, 1);
        ns_basis_sizes(s);
        if (isinf(ns_basis_violation(s)))
            return NS_E_SINGULAR;
        const int n = flip(s);
        if (n == 0)
            return ns_mlcp_judge(s, &residual);
        patience = n < best ? PATIENCE : patience - 1;
        best = n < best ? n : best;
    }
    return NS_E_LIMIT;
}
