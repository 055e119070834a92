/* src/mlcp/optional/crossover.c - from a mode that is nearly right to the answer, to rounding.
 *
 * The equations of the mode are solved; guards that are broken say which pairs to flip, all of them at once,
 * and in the later rounds only the one of highest index (Murty's rule: no cycle on P-matrices).
 */
#include <math.h>

#include "mlcp/verify/residual.h"
#include "scaled.h"

enum { BLOCKS = 6, SINGLES = 12, REVEALS = 2, IDLE = 3, LARGE = 250 };
static const double RCOND = 1e-13; /* a basis must keep three digits */

/* Factors a basis of s->mode, or of one close to it; that costs more than all else, so it is
 * rarely done, and never for large problems: the iteration has an answer of its own for redundant equations.
 */
static int factor_or_reveal(ns_mlcp_solver *s, int *reveals) {
    double rcond;
    int status = ns_mlcp_basis_factor(s, &rcond);
    if (status == NS_OK && rcond >= RCOND)
        return NS_OK;
    if (++*reveals > REVEALS || s->m > LARGE || ns_mlcp_reveal(s) != NS_OK)
        return NS_E_SINGULAR;
    return ns_mlcp_basis_factor(s, NULL);
}

/* Returns how many guards were broken. */
static int flip_violated(ns_mlcp_solver *s, int all) {
    int broken = 0;
    for (int a = s->np - 1; a >= 0; a--) {
        int i = s->pair[a];
        ns_mode mode = ns_mlcp_basis_wanted(s, i);
        if (mode == s->mode[i])
            continue;
        if (all || broken == 0)
            s->mode[i] = mode;
        broken++;
    }
    return broken;
}

/* The answer of the mode, refined as long as that helps. */
static double refine_answer(ns_mlcp_solver *s) {
    double best = INFINITY;
    for (int pass = 0; pass <= 3; pass++) {
        ns_mlcp_basis_values(s, pass);
        ns_mlcp_basis_clamp(s);
        double r = ns_mlcp_measure(&s->now, s->lambda, s->alike, s->rhs, NULL);
        if (r <= NS_MLCP_GOOD)
            return r;
        if (r <= NS_MLCP_ACCEPT && r > 0.5 * best)
            return r;
        best = fmin(best, r);
    }
    return best;
}

int ns_mlcp_crossover(ns_mlcp_solver *s) {
    int reveals = 0, least = s->np + 1, idle = 0;
    for (int round = 0; round < BLOCKS + SINGLES; round++) {
        if (factor_or_reveal(s, &reveals) != NS_OK)
            return NS_E_SINGULAR;
        ns_mlcp_basis_values(s, 1);
        ns_mlcp_basis_sizes(s);
        double v = ns_mlcp_basis_violation(s);
        if (isinf(v))
            return NS_E_SINGULAR;
        if (v <= NS_MLCP_ACCEPT) {
            if (refine_answer(s) <= NS_MLCP_ACCEPT)
                return NS_OK;
            ns_mlcp_basis_values(s, 1);
        }
        if (v <= NS_MLCP_GUARD)
            return NS_E_LIMIT; /* right, but not to be had to the accuracy asked for */
        int broken = flip_violated(s, round < BLOCKS && idle == 0);
        idle = broken < least ? 0 : idle + 1;
        least = broken < least ? broken : least;
        if (idle > IDLE)
            return NS_E_LIMIT; /* as far from right as ever */
    }
    return NS_E_LIMIT;
}
