/* src/mlcp/solve.c - ns_mlcp_solve(): which start, which method, and whether to believe the answer. */
#include "mlcp_internal.h"

#include <math.h>
#include <string.h>

#include "residual.h"

/* Guards hold if no y or lambda is outside by more than this part of its size: the terms of a sum leave
 * 1e-16 of it each, a solve with some dozen unknowns 1e-14; two decades are for the condition. */
static const double GUARD = 1e-12;
static const double ACCEPT = 1e-10; /* natural residual of an answer */
static const double GOOD = 1e-13;   /* nothing to gain by refining below this */
enum { REFINEMENTS = 3, MODES = 2048 };
static const double RCOND = 1e-13; /* a starting basis must keep three digits */

static double try_answer(ns_mlcp_solver *s, int refinements) {
    ns_basis_values(s, refinements);
    for (int i = 0; i < s->m; i++)
        if (!isfinite(s->lambda[i]) || !isfinite(s->y[i]))
            return INFINITY;
    ns_basis_clamp(s);
    return ns_mlcp_measure(&s->now, s->lambda, s->rhs, NULL);
}

/* The answer in s->mode, whose G is factored: clamped, judged, refined as often as that helps (a step too
 * many may spoil a row in which next to nothing flows). */
static int judge(ns_mlcp_solver *s, double *residual) {
    int best = 0, last = 0;
    *residual = try_answer(s, 0);
    while (*residual > GOOD && last < REFINEMENTS) {
        double r = try_answer(s, ++last);
        if (r < *residual) {
            *residual = r;
            best = last;
        }
    }
    if (last != best)
        *residual = try_answer(s, best);
    return *residual <= ACCEPT ? NS_OK : NS_E_RESIDUAL;
}

/* From s->mode to an answer by at most `rounds` runs of Lemke's method. */
static int attempt(ns_mlcp_solver *s, int all, int rounds, double *residual) {
    double rcond;
    int status = ns_basis_factor(s, &rcond);
    if (status != NS_OK || rcond < RCOND) {
        status = ns_reveal(s);
        if (status == NS_OK)
            status = ns_basis_factor(s, NULL);
        if (status != NS_OK)
            return NS_E_SINGULAR;
    }
    for (int round = 0; round < rounds; round++) {
        ns_basis_values(s, s->careful);
        ns_basis_sizes(s);
        double v = ns_basis_violation(s);
        if (v > GUARD) {
            ns_basis_values(s, 1 + s->careful);
            v = ns_basis_violation(s);
        }
        if (v > GUARD) {
            if (isinf(v))
                return NS_E_SINGULAR;
            ns_tableau_start(s);
            status = ns_lemke(s, all);
            if (status != NS_OK)
                return status;
            if (ns_basis_factor(s, NULL) != NS_OK)
                return NS_E_SINGULAR;
        }
        status = judge(s, residual);
        if (status == NS_OK)
            return NS_OK;
    }
    return status;
}

/* Different starts and covers, until one answers or proves that nothing can. */
int ns_mlcp_search(ns_mlcp_solver *s, const ns_mode *mode, double *residual) {
    static const struct {
        int lower, all;
    } way[] = {{0, 0}, {0, 1}, {1, 1}, {1, 0}, {1, 2}, {0, 2}, {1, 3}, {0, 3}};
    int first = NS_E_LIMIT;
    for (size_t k = 0; k < sizeof way / sizeof *way; k++) {
        ns_mlcp_restart(s, way[k].lower ? NULL : mode);
        s->careful = k > 0;
        int status = attempt(s, way[k].all, 3, residual);
        if (status == NS_OK)
            return NS_OK;
        if (status == NS_E_INFEASIBLE && ns_farkas(s)) {
            s->proved = 1;
            return status;
        }
        if (s->nstuck > 0)
            return NS_E_SINGULAR; /* no start will do */
        if (k == 0 || (first == NS_E_LIMIT && status != NS_E_SINGULAR))
            first = status;
    }
    return first;
}

/* Last resort for few pairs and any W: every mode in turn.  Afterwards "no solution" is no longer a guess
 * (up to solutions that exist in singular modes only). */
static int every_mode(ns_mlcp_solver *s, double *residual) {
    long modes = 1;
    for (int a = 0; a < s->np && modes <= MODES; a++)
        modes *= isfinite(s->p->l[s->pair[a]]) && isfinite(s->p->u[s->pair[a]]) ? 3 : 2;
    for (long k = 0; k < modes && modes <= MODES; k++) {
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
        if (ns_basis_violation(s) <= GUARD && judge(s, residual) == NS_OK)
            return NS_OK;
    }
    return NS_E_INFEASIBLE;
}

/* Solves *p, whose arrays are sound. */
static int solve(ns_mlcp_solver *s, const ns_mlcp *p, const ns_mode *mode, double *residual) {
    s->pivots = s->factors = 0;
    s->proved = 0;
    memset(&s->fault, 0, sizeof s->fault);
    ns_mlcp_sort(s, p);
    int status = ns_mlcp_search(s, mode, residual);
    if (status != NS_OK && s->nstuck == 0 && !s->proved && every_mode(s, residual) == NS_OK)
        status = NS_OK;
    if (status == NS_E_SINGULAR && s->nstuck > 0)
        status = ns_proximal(s, mode, ACCEPT, residual);
    if (status == NS_OK)
        s->fault.npairs = 0;
    return status;
}

static int refuse(const ns_mlcp_solver *s, const ns_mlcp *p, const void *mode, const void *lambda,
                  const void *y) {
    if (!s || !p || (p->m > 0 && (!mode || !lambda || !y)))
        return NS_E_NULL;
    return ns_mlcp_check(s, p);
}

int ns_mlcp_solve(ns_mlcp_solver *s, const ns_mlcp *p, ns_mode *mode, double *lambda, double *y,
                  ns_mlcp_info *info) {
    double residual = NAN;
    int status = refuse(s, p, mode, lambda, y), tried = status == NS_OK;
    if (tried)
        status = solve(s, p, mode, &residual);
    if (info) {
        memset(info, 0, sizeof *info);
        if (tried) {
            info->pivots = s->pivots;
            info->factors = s->factors;
            info->fault = s->fault;
        }
        info->residual = residual;
        info->fault.t = NAN;
        info->fault.status = (ns_status)status;
    }
    if (status != NS_OK || p->m == 0)
        return status;
    size_t m = (size_t)p->m;
    memcpy(mode, s->mode, m * sizeof *mode);
    memcpy(lambda, s->lambda, m * sizeof *lambda);
    memcpy(y, s->y, m * sizeof *y);
    return NS_OK;
}
