/* src/mlcp/solve.c - ns_mlcp_solve(): which start, which method, and whether to believe the answer. */
#include "mlcp_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "mlcp/infeasible/branch_and_bound.h"
#include "mlcp/verify/residual.h"

/* Of the largest lambda against q and the bounds, in units of W: */
static const double LARGE = 1e2; /* a proof is looked for that speaks against the answer */
static const double DOUBT = 1e7; /* its residual says little */
static const double HIDDEN =
    1e-11; /* of q, that a residual beside large lambda may hide: NS_MLCP_ACCEPT / 10 */
static const double RCOND = 1e-13; /* a basis must keep three digits */

/* The residual of s->lambda; y gets the sign that its mode asks for where it is rounding. */
static double measure(ns_mlcp_solver *s) {
    memcpy(s->y, s->now.q, (size_t)s->m * sizeof *s->y);
    ns_linalg_matvec_add(s->m, s->m, s->W, s->lambda, s->y);
    ns_mlcp_basis_clamp(s);
    return ns_mlcp_measure(&s->now, s->lambda, s->alike, s->rhs, NULL);
}

/* After branch and bound: its lambda, or the answer of its mode, whichever has the smaller residual. */
static int choose_nearer(ns_mlcp_solver *s, double *residual) {
    double exact = INFINITY, rcond;
    *residual = measure(s);
    ns_mlcp_save(s, &s->kept);
    if (ns_mlcp_basis_factor(s, &rcond) == NS_OK && rcond >= RCOND &&
        ns_mlcp_mode_answer(s, &exact) == NS_OK && exact <= *residual) {
        *residual = exact;
        return NS_OK;
    }
    ns_mlcp_restore(s, &s->kept);
    return *residual <= NS_MLCP_ACCEPT ? NS_OK : NS_E_RESIDUAL;
}

/* Whether y and mode are those of s->lambda, which was measured last. */
static int agrees(ns_mlcp_solver *s) {
    const double *y = s->rhs, *inverse = s->rhs + s->m;
    for (int i = 0; i < s->m; i++)
        s->g[i] = 1.0 / inverse[i];
    return !ns_mlcp_is_inconsistent(s, y, s->g);
}

/* One method, from a mode, on the problem as given; patient: of ns_mlcp_block(). */
static int apply(ns_mlcp_solver *s, ns_mlcp_method method, int patient, const ns_mode *mode,
                 double *residual) {
    s->method = (int)method;
    s->elim.nstuck = s->transform.settled = s->agrees = 0;
    ns_mlcp_units(s);
    ns_mlcp_take_given(s);
    if (method == NS_MLCP_LEMKE) {
        const int status = ns_mlcp_lemke_starts(s, mode, residual);
        s->agrees = status == NS_OK && agrees(s);
        return status == NS_E_SINGULAR && s->elim.nstuck > 0 ? ns_mlcp_proximal(s, mode, residual) : status;
    }
    ns_mlcp_start_from(s, mode);
    if (method == NS_MLCP_PIVOT && s->m > NS_QUICK)
        return ns_mlcp_block(s, patient, residual);
    const int status = method == NS_MLCP_PIVOT ? ns_mlcp_pivot(s) : ns_mlcp_branch_and_bound(s);
    if (status != NS_OK)
        return status;
    if (method == NS_MLCP_ENUMERATE)
        return choose_nearer(s, residual);
    *residual = measure(s);
    s->agrees = agrees(s);
    return *residual <= NS_MLCP_ACCEPT ? NS_OK : NS_E_RESIDUAL;
}

/* A ray or a runaway alone proves nothing, neither does an answer that has run away; a method may give up
 * where there is a proof. */
static int verdict(ns_mlcp_solver *s, int status, double *residual) {
    if (status == NS_OK && !s->agrees && !ns_mlcp_make_consistent(s, residual))
        status = NS_E_RESIDUAL;
    if (status == NS_OK && ns_mlcp_huge_multipliers_fail(s, DOUBT))
        status = NS_E_LIMIT;
    if (status == NS_OK || status == NS_E_SIZE)
        return status;
    if (status == NS_E_INFEASIBLE && (s->proof.found || s->method == NS_MLCP_ENUMERATE))
        return status;
    if (ns_mlcp_prove(s, NS_CAREFUL))
        return NS_E_INFEASIBLE;
    return status == NS_E_INFEASIBLE ? NS_E_LIMIT : status;
}

/* Pivoting takes half the time of Lemke's method or less, where it answers (tests/bench/bench_mlcp.c); that
 * answers nearly all of the rest.  Of many pairs proximal points that lead nowhere at first take ten times as
 * long as Lemke's method, and a proof takes five times: both come after it.  Branch and bound is for few
 * pairs, and what the equations leave open does not come out shortest there. */
static const struct {
    ns_mlcp_method method;
    int patient;
} order[] = {{NS_MLCP_PIVOT, 0}, {NS_MLCP_LEMKE, 0}, {NS_MLCP_PIVOT, 1}, {NS_MLCP_ENUMERATE, 0}};
enum { ORDER = sizeof order / sizeof *order };

/* An answer of the first pivoting; that it has none says nothing. */
static int first_answers(ns_mlcp_solver *s, int status, double *residual) {
    return status == NS_OK && (s->agrees || ns_mlcp_make_consistent(s, residual)) &&
           !ns_mlcp_huge_multipliers_fail(s, DOUBT);
}

/* The methods in turn: an answer or a proof ends it. */
static int automatic(ns_mlcp_solver *s, const ns_mode *mode, double *residual) {
    int first = NS_OK;
    for (int k = 0; k < ORDER; k++) {
        const int pivots = order[k].method == NS_MLCP_PIVOT;
        if (pivots && s->m <= NS_QUICK)
            continue;
        int status = apply(s, order[k].method, order[k].patient, mode, residual);
        if (k == 0 && !first_answers(s, status, residual))
            continue;
        status = k == 0 ? NS_OK : verdict(s, status, residual);
        if (status == NS_OK || status == NS_E_INFEASIBLE)
            return status;
        if (!pivots && first == NS_OK)
            first = status;
    }
    return first;
}

/* Whether s->lambda is an answer of the problem as given. */
static int is_answer(ns_mlcp_solver *s, double *residual) {
    double r = measure(s);
    if (!(r <= NS_MLCP_ACCEPT) || ns_mlcp_huge_multipliers(s, DOUBT) || !ns_mlcp_make_consistent(s, &r))
        return 0;
    *residual = r;
    return 1;
}

/* What is tried last: a point whose rounding was all that was wrong with it.  fault and method stay those of
 * what failed before, unless there is an answer. */
static int solve_otherwise(ns_mlcp_solver *s, double *residual) {
    const ns_fault fault = s->fault;
    const int method = s->method;
    if (ns_mlcp_zeros_recall(s) && is_answer(s, residual))
        return 1;
    s->fault = fault;
    s->method = method;
    return 0;
}

/* Where pivoting answers, no unit, proof or other method is needed, unless lambda of a new mode is huge. */
static int solve_by_pivoting(ns_mlcp_solver *s, const ns_mode *mode, double *residual) {
    if ((s->use != NS_MLCP_AUTO && s->use != NS_MLCP_PIVOT) || s->m > NS_QUICK ||
        ns_mlcp_pivot_from(s, mode, residual) != NS_OK)
        return 0;
    if (s->pivots + s->factors > 0 && ns_mlcp_huge_multipliers(s, DOUBT)) {
        s->transform.valid = 0; /* or its mode would not be new any more */
        return 0;
    }
    s->method = NS_MLCP_PIVOT;
    return 1;
}

/* Whether there is a proof against an answer of large lambda: its residual is small beside them, which may be
 * much against q, of all rows or (where units differ from row to row) of one. */
static int is_disproved(ns_mlcp_solver *s, double residual) {
    const int is_huge = ns_mlcp_huge_multipliers(s, fmax(LARGE, HIDDEN / fmax(residual, DBL_EPSILON))) ||
                        (!s->alike && ns_mlcp_breaks_a_datum(s));
    return is_huge && ns_mlcp_prove(s, NS_AGAINST);
}

/* Solves *p, whose arrays are sound. */
static int solve_problem(ns_mlcp_solver *s, const ns_mlcp *p, const ns_mode *mode, double *residual) {
    s->pivots = s->factors = s->cut_off = 0;
    s->searched = 0;
    s->proof.effort = 0;
    s->noted.residual = INFINITY;
    memset(&s->fault, 0, sizeof s->fault);
    s->p = p;
    s->elim.nstuck = 0;
    if (ns_mlcp_fetch_all(s) != NS_OK)
        return NS_E_NUMBER;
    if (solve_by_pivoting(s, mode, residual))
        return NS_OK;
    int status = s->use == NS_MLCP_AUTO ? automatic(s, mode, residual)
                                        : verdict(s, apply(s, s->use, 1, mode, residual), residual);
    if (status != NS_OK && !s->proof.found && solve_otherwise(s, residual))
        status = NS_OK;
    if (status == NS_OK && is_disproved(s, *residual))
        status = NS_E_INFEASIBLE;
    if (status == NS_OK)
        s->fault.npairs = 0;
    else
        s->transform.valid = s->transform.settled = 0; /* asked once more, the answer is the same */
    return status;
}

/* Zero in place of what has lost its digits, as subnormal numbers have: the voltage of a capacitor that went
 * on decaying.  No residual is small beside them.  0: q has none. */
static int take_zeros(ns_mlcp_solver *s) {
    int any = 0;
    for (int i = 0; i < s->m; i++) {
        const double q = s->given.q[i];
        const int is_none = fpclassify(q) == FP_SUBNORMAL;
        s->own.q[i] = is_none ? 0.0 : q;
        any |= is_none;
    }
    if (any)
        s->given.q = s->own.q;
    return any;
}

static int refuse(ns_mlcp_solver *s, const ns_mlcp *p, const void *mode, const void *lambda, const void *y) {
    if (!s || !p || (p->m > 0 && (!mode || !lambda || !y)))
        return NS_E_NULL;
    return ns_mlcp_load(s, p);
}

int ns_mlcp_solve(ns_mlcp_solver *s, const ns_mlcp *p, ns_mode *mode, double *lambda, double *y,
                  ns_mlcp_info *info) {
    double residual = NAN;
    if (s)
        s->proof.found = 0;
    int status = refuse(s, p, mode, lambda, y), tried = status == NS_OK;
    if (tried)
        status = solve_problem(s, &s->given, mode, &residual);
    if (tried && status != NS_OK && status != NS_E_NUMBER && take_zeros(s))
        status = solve_problem(s, &s->given, mode, &residual);
    if (info) {
        memset(info, 0, sizeof *info);
        if (tried) {
            info->pivots = s->pivots;
            info->factors = s->factors;
            info->searched = s->searched;
            info->cut_off = s->cut_off;
            info->method = s->method;
            info->certified = status == NS_E_INFEASIBLE && s->proof.found;
            info->fault = s->fault;
        }
        info->residual = residual;
        info->fault.t = NAN;
        info->fault.status = (ns_status)status;
    }
    if (status != NS_OK || p->m == 0)
        return status;
    size_t m = (size_t)p->m;
    s->nodes_alike = 0;
    memcpy(mode, s->mode, m * sizeof *mode);
    memcpy(lambda, s->lambda, m * sizeof *lambda);
    memcpy(y, s->y, m * sizeof *y);
    return NS_OK;
}

const double *ns_mlcp_certificate(const ns_mlcp_solver *s) {
    return s && s->proof.found ? s->proof.v : NULL;
}
