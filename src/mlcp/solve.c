/* src/mlcp/solve.c - ns_mlcp_solve(): which start, which method, and whether to believe the answer. */
#include "mlcp_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "mlcp/verify/residual.h"

static const double LARGE = 1e2; /* lambda this large against q and the bounds, in units of W */
static const double HIDDEN =
    1e-11;                       /* of q, that the residual beside them may hide: a tenth of NS_MLCP_ACCEPT */
static const double DOUBT = 1e7; /* ... so large that no residual says much */
static const double HOPELESS = 1e12; /* ... so large that no digits of q are left beside it */
static const double LESS = 0.1;      /* of what is wrong: worth another answer */
enum { FEW = 8 };                    /* pairs */
static const double RCOND = 1e-13;   /* a basis must keep three digits */

/* y of s->lambda as it is, its sign mended where it is next to nothing. */
static double measure(ns_mlcp_solver *s) {
    memcpy(s->y, s->now.q, (size_t)s->m * sizeof *s->y);
    ns_linalg_matvec_add(s->m, s->m, s->W, s->lambda, s->y);
    ns_mlcp_basis_clamp(s);
    return ns_mlcp_measure(&s->now, s->lambda, s->alike, s->rhs, NULL);
}

/* After an iterative method: its lambda, or what its mode gives exactly, whichever is better. */
static int settle(ns_mlcp_solver *s, double *residual) {
    double exact = INFINITY, rcond;
    *residual = measure(s);
    ns_mlcp_keep(s);
    if (ns_mlcp_basis_factor(s, &rcond) == NS_OK && rcond >= RCOND &&
        ns_mlcp_mode_answer(s, &exact) == NS_OK && exact <= *residual) {
        *residual = exact;
        return NS_OK;
    }
    ns_mlcp_give_back(s);
    return *residual <= NS_MLCP_ACCEPT ? NS_OK : NS_E_RESIDUAL;
}

static int large(ns_mlcp_solver *s, double *residual) {
    int status = ns_mlcp_block(s, residual);
    if (status != NS_OK)
        ns_mlcp_note(s);
    return status;
}

/* Whether y and mode are those of s->lambda, which was measured last. */
static int agrees(ns_mlcp_solver *s) {
    const double *y = s->rhs, *inverse = s->rhs + s->m;
    for (int i = 0; i < s->m; i++)
        s->g[i] = 1.0 / inverse[i];
    return !ns_mlcp_differs(s, y, s->g);
}

/* One method, from a mode, on the problem as given. */
static int apply(ns_mlcp_solver *s, ns_mlcp_method method, const ns_mode *mode, double *residual) {
    static int (*const solver[NS_MLCP_METHODS])(ns_mlcp_solver *) = {
        [NS_MLCP_PIVOT] = ns_mlcp_pivot,         [NS_MLCP_NEWTON] = ns_mlcp_newton,
        [NS_MLCP_INTERIOR] = ns_mlcp_interior,   [NS_MLCP_PROJECTED] = ns_mlcp_projected,
        [NS_MLCP_ENUMERATE] = ns_mlcp_enumerate,
    };
    s->method = (int)method;
    s->elim.nstuck = s->transform.settled = s->agrees = 0;
    ns_mlcp_units(s);
    ns_mlcp_given(s);
    if (method == NS_MLCP_LEMKE) {
        int status = ns_mlcp_lemke_starts(s, mode, residual);
        s->agrees = status == NS_OK && agrees(s);
        if (status != NS_E_SINGULAR || s->elim.nstuck == 0)
            return status;
        /* first: where equalities contradict each other, lambda grows until its size hides that */
        return ns_mlcp_prove(s, NS_CAREFUL) ? NS_E_INFEASIBLE : ns_mlcp_proximal(s, mode, residual);
    }
    ns_mlcp_restart(s, mode);
    if (method == NS_MLCP_PIVOT && s->m > NS_QUICK)
        return large(s, residual);
    int status = solver[method](s);
    if (status == NS_OK && method == NS_MLCP_PIVOT) { /* exact already */
        *residual = measure(s);
        s->agrees = agrees(s);
        return *residual <= NS_MLCP_ACCEPT ? NS_OK : NS_E_RESIDUAL;
    }
    return status == NS_OK ? settle(s, residual) : status;
}

/* A ray or a runaway alone proves nothing, neither does an answer that has run away; a method may give up
 * where there is a proof. */
static int verdict(ns_mlcp_solver *s, int status, double *residual) {
    if (status == NS_OK && !s->agrees && !ns_mlcp_agree(s, residual))
        status = NS_E_RESIDUAL;
    if (status == NS_OK && ns_mlcp_lost(s, DOUBT))
        status = NS_E_LIMIT;
    if (status == NS_OK || status == NS_E_SIZE)
        return status;
    if (status == NS_E_INFEASIBLE && (s->proof.found || s->method == NS_MLCP_ENUMERATE))
        return status;
    if (ns_mlcp_prove(s, NS_CAREFUL) || ns_mlcp_prove(s, NS_BOLD))
        return NS_E_INFEASIBLE;
    return status == NS_E_INFEASIBLE ? NS_E_LIMIT : status;
}

/* By tests/bench/bench_mlcp.c, whose cheapest of all orders is at most a quarter cheaper: pivoting takes half
 * the time of Lemke's method or less, where it answers; that answers nearly all of the rest; interior point
 * and Newton take two to ten times as long, and answer what is left.  Enumeration is for few pairs, and what
 * the equations leave open does not come out shortest there. */
static const struct {
    ns_mlcp_method method;
    int as_given; /* units: those of volts and amperes tell noise better in a network that spans decades */
} order[] = {{NS_MLCP_PIVOT, 0},    {NS_MLCP_LEMKE, 0},  {NS_MLCP_LEMKE, 1},
             {NS_MLCP_INTERIOR, 0}, {NS_MLCP_NEWTON, 0}, {NS_MLCP_ENUMERATE, 0}};
enum { ORDER = sizeof order / sizeof *order };

static int apply_next(ns_mlcp_solver *s, int k, const ns_mode *mode, double *residual) {
    s->as_given = order[k].as_given ^ s->alike;
    const int status = apply(s, order[k].method, mode, residual);
    s->as_given = s->alike;
    return status;
}

/* Whether method k has an answer that breaks rows less than one that breaks them by *broken. */
static int better(ns_mlcp_solver *s, int k, const ns_mode *mode, double *broken, double *residual) {
    double r;
    if ((order[k].method == NS_MLCP_ENUMERATE && s->np > FEW) || apply_next(s, k, mode, &r) != NS_OK ||
        (!s->agrees && !ns_mlcp_agree(s, &r)) || ns_mlcp_lost(s, DOUBT))
        return 0;
    const double now = ns_mlcp_broken(s);
    if (!(now <= LESS * *broken))
        return 0;
    *broken = now;
    *residual = r;
    return 1;
}

/* The answer of method k, or of one behind it in the order: where rows are broken by their own terms, which
 * passed as a lambda that has no part in them is large, another may have kept that small. */
static void reconsider(ns_mlcp_solver *s, int k, const ns_mode *mode, double *residual) {
    if (s->m > NS_QUICK || !ns_mlcp_doubtful(s, LARGE))
        return;
    double broken = ns_mlcp_broken(s);
    const int asked = s->proof.effort;
    ns_mlcp_set_aside(s);
    s->noting = 0;
    while (broken > NS_MLCP_ACCEPT && ++k < ORDER)
        if (better(s, k, mode, &broken, residual))
            ns_mlcp_set_aside(s);
    ns_mlcp_bring_back(s);
    s->proof.effort = asked; /* proofs against methods that failed are none against the answer */
    s->proof.found = 0;
}

/* The methods in turn: an answer or a proof ends it. */
static int automatic(ns_mlcp_solver *s, const ns_mode *mode, double *residual) {
    int first = NS_OK;
    for (int k = s->m <= NS_QUICK; k < ORDER; k++) {
        const int status = verdict(s, apply_next(s, k, mode, residual), residual);
        if (status == NS_OK)
            reconsider(s, k, mode, residual);
        if (status == NS_OK || status == NS_E_INFEASIBLE)
            return status;
        if (order[k].method != NS_MLCP_PIVOT && first == NS_OK)
            first = status;
    }
    return first;
}

/* No lambda makes terms large against q: one whose terms in some row are below DOUBT |q| is below DOUBT in
 * the units of ns_mlcp_doubtful().  yterms are those of the answer. */
static int plain(const ns_mlcp_solver *s) {
    int n = 0;
    for (int i = 0; i < s->m; i++)
        n += s->transform.yterms[i] > DOUBT * fabs(s->given.q[i]);
    return n == 0;
}

/* The last resort: in units of the problem's own.  The answer is measured in those it is written in. */
static int in_own_units(ns_mlcp_solver *s, const ns_mode *mode, double *residual) {
    const double before = *residual;
    const ns_fault fault = s->fault;
    const int method = s->method;
    if (!ns_mlcp_rescale(s))
        return NS_E_LIMIT;
    s->noting = 0; /* its lambda are in other units */
    int status = apply(s, NS_MLCP_PIVOT, mode, residual);
    if (status != NS_OK)
        status = apply(s, NS_MLCP_LEMKE, mode, residual);
    ns_mlcp_scale_back(s);
    if (status == NS_OK)
        *residual = measure(s);
    if (status == NS_OK && *residual <= NS_MLCP_ACCEPT && !ns_mlcp_doubtful(s, DOUBT) &&
        ns_mlcp_agree(s, residual))
        return NS_OK;
    *residual = before;
    s->fault = fault;
    s->method = method;
    return NS_E_LIMIT;
}

/* A point whose rounding was all that was wrong with it. */
static int remembered(ns_mlcp_solver *s, double *residual) {
    const double before = *residual;
    const int method = s->method;
    if (!ns_mlcp_recall(s))
        return NS_E_LIMIT;
    *residual = measure(s);
    if (*residual <= NS_MLCP_ACCEPT && !ns_mlcp_doubtful(s, DOUBT) && ns_mlcp_agree(s, residual))
        return NS_OK;
    *residual = before;
    s->method = method;
    return NS_E_LIMIT;
}

/* Where it answers, nothing else is looked at, unless a mode found on the way gives a doubtful answer. */
static int quickly(ns_mlcp_solver *s, const ns_mode *mode, double *residual) {
    if ((s->use != NS_MLCP_AUTO && s->use != NS_MLCP_PIVOT) || s->m > NS_QUICK ||
        ns_mlcp_quick(s, mode, residual) != NS_OK ||
        (s->pivots + s->factors > 0 && !plain(s) && ns_mlcp_doubtful(s, DOUBT)))
        return 0;
    s->method = NS_MLCP_PIVOT;
    return 1;
}

/* Whether there is a proof against an answer of large lambda: its residual is small beside them, which may be
 * much against q. */
static int disproved(ns_mlcp_solver *s, double residual) {
    if (!ns_mlcp_doubtful(s, fmax(LARGE, HIDDEN / fmax(residual, DBL_EPSILON))))
        return 0;
    return (ns_mlcp_doubtful(s, DOUBT) && ns_mlcp_prove(s, NS_CAREFUL)) ||
           (ns_mlcp_doubtful(s, HOPELESS) && ns_mlcp_prove(s, NS_BOLD)) || ns_mlcp_prove(s, NS_AGAINST);
}

/* Solves *p, whose arrays are sound. */
static int solve(ns_mlcp_solver *s, const ns_mlcp *p, const ns_mode *mode, double *residual) {
    s->pivots = s->factors = s->iterations = 0;
    s->proof.effort = 0;
    s->noting = 1;
    s->noted.residual = INFINITY;
    memset(&s->fault, 0, sizeof s->fault);
    s->p = p;
    s->elim.nstuck = 0;
    if (ns_mlcp_fetch_all(s) != NS_OK)
        return NS_E_NUMBER;
    if (quickly(s, mode, residual))
        return NS_OK;
    int status = s->use == NS_MLCP_AUTO ? automatic(s, mode, residual)
                                        : verdict(s, apply(s, s->use, mode, residual), residual);
    if (s->use == NS_MLCP_AUTO && status != NS_OK && status != NS_E_INFEASIBLE &&
        in_own_units(s, mode, residual) == NS_OK)
        status = NS_OK;
    if (status != NS_OK && !s->proof.found && remembered(s, residual) == NS_OK)
        status = NS_OK;
    if (status == NS_OK && disproved(s, *residual))
        return NS_E_INFEASIBLE;
    if (status == NS_OK)
        s->fault.npairs = 0;
    return status;
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
        status = solve(s, &s->given, mode, &residual);
    if (info) {
        memset(info, 0, sizeof *info);
        if (tried) {
            info->pivots = s->pivots;
            info->factors = s->factors;
            info->iterations = s->iterations;
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
