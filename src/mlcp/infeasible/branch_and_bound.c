/* src/mlcp/infeasible/branch_and_bound.c - is there a solution at all?  Modes of some pairs at a time, the
 * others left aside.
 *
 * With complementarity left aside a problem is linear (feasible.c).  If that has no solution, neither has the
 * problem; if its solution is complementary, it is one; otherwise a pair that breaks its law is put into each
 * of its modes in turn.  A branch without a solution is cut with all modes below it.  Singular modes are no
 * exception here: what is asked is whether their equations and bounds are consistent.
 */
#include "branch_and_bound.h"

#include <math.h>
#include <string.h>

#include "feasible.h"
#include "mlcp/verify/residual.h"

/* Nodes looked at.  A problem of a step is asked again at other lengths: all of them together, since the last
 * answer, look at NODES_ALIKE, and each at NODES_EACH. */
enum { NODES = 20000, NODES_ALIKE = 1000, NODES_EACH = 50, REFINEMENTS = 3, OPEN = 2 };

typedef struct search {
    ns_mlcp_solver *s;
    ns_simplex lp;
    signed char decided[NS_BRANCH_MAX]; /* mode of pair a, or OPEN */
    int nodes, limit;
} search;

/* Distance of lambda_i from the bound that y_i tells it to be at, or y_i, whichever is less. */
static double broken(const ns_simplex *p, int i, double l, double u) {
    double y = p->value[p->m + i], x = p->value[i];
    if (y > 0.0)
        return fmin(y, isinf(l) ? y : x - p->lo[i]);
    return fmin(-y, isinf(u) ? -y : p->hi[i] - x);
}

/* The open pair that breaks its law most, if any is open. */
static int worst(const search *b) {
    int at = -1;
    double most = -INFINITY;
    for (int a = 0; a < b->s->np; a++) {
        int i = b->s->pair[a];
        double v = broken(&b->lp, i, b->s->p->l[i], b->s->p->u[i]);
        if (b->decided[a] != OPEN || !(v > most))
            continue;
        most = v;
        at = a;
    }
    return at;
}

/* The mode that the simplex method's basis gives pair a. */
static ns_mode read_mode(const search *b, int a) {
    const ns_simplex *p = &b->lp;
    int i = b->s->pair[a];
    if (b->decided[a] != OPEN)
        return (ns_mode)b->decided[a];
    if (p->where[p->m + i] < 0)
        return NS_INSIDE;
    if (p->where[i] < 0)
        return p->value[i] >= p->hi[i] ? NS_UPPER : NS_LOWER;
    double y = p->value[p->m + i], down = p->value[i] - p->lo[i], up = p->hi[i] - p->value[i];
    return fmin(down, up) > fabs(y) ? NS_INSIDE : down < up ? NS_LOWER : NS_UPPER;
}

/* lambda and mode as the basis has them, and the factors of its equations. */
static int take(search *b) {
    ns_mlcp_solver *s = b->s;
    const ns_simplex *p = &b->lp;
    ns_mlcp_restart(s, NULL);
    for (int a = 0; a < s->np; a++)
        s->mode[s->pair[a]] = ns_mlcp_mend(s, s->pair[a], read_mode(b, a));
    int nr = 0, nc = 0;
    for (int i = 0; i < s->m; i++) {
        double v = ldexp(p->value[i], s->c[i] + p->shift);
        s->lambda[i] = fmin(fmax(v, s->p->l[i]), s->p->u[i]);
        if (p->where[p->m + i] < 0)
            s->rows[nr++] = i;
        if (p->where[i] >= 0)
            s->cols[nc++] = i;
    }
    for (int a = 0; a < s->np; a++)
        if (s->mode[s->pair[a]] != NS_INSIDE)
            s->lambda[s->pair[a]] = ns_mlcp_bound(s, s->pair[a], s->mode[s->pair[a]]);
    s->k = nc;
    for (int j = 0; j < nc; j++)
        for (int i = 0; i < nc; i++)
            s->G[(size_t)i + (size_t)j * (size_t)nc] =
                s->W[(size_t)s->rows[i] + (size_t)s->cols[j] * (size_t)s->m];
    s->factors++;
    s->have_factors = 0;
    return nr == nc ? ns_linalg_lu_factor(s->lu, nc, s->G, NULL, NULL) : NS_E_SINGULAR;
}

/* OK if the simplex method's answer is one of the problem. */
static int answers(search *b) {
    ns_mlcp_solver *s = b->s;
    int refined = take(b) == NS_OK;
    for (int k = 0; k <= REFINEMENTS; k++) {
        for (int i = 0; i < s->m; i++)
            if (!isfinite(s->lambda[i]))
                return NS_E_LIMIT;
        for (int i = 0; i < s->m; i++)
            s->lambda[i] = fmin(fmax(s->lambda[i], s->p->l[i]), s->p->u[i]);
        if (ns_mlcp_measure(&s->now, s->lambda, s->alike, s->rhs, NULL) <= NS_MLCP_ACCEPT)
            return NS_OK;
        if (!refined)
            return NS_E_LIMIT;
        ns_mlcp_basis_correct(s);
    }
    return NS_E_LIMIT;
}

static int visit(search *b);

/* Pair a in each of its modes, the one it is nearest to first. */
static int split(search *b, int a) {
    int i = b->s->pair[a], verdict = NS_E_INFEASIBLE;
    double y = b->lp.value[b->lp.m + i];
    ns_mode near = ns_mlcp_mend(b->s, i, y > 0.0 ? NS_LOWER : NS_UPPER), far = (ns_mode)-near;
    if (ns_mlcp_mend(b->s, i, far) != far)
        far = NS_INSIDE; /* it has no such bound */
    const ns_mode order[] = {near, NS_INSIDE, far};
    int n = far == NS_INSIDE ? 2 : 3;
    for (int k = 0; k < n && verdict != NS_OK; k++) {
        b->decided[a] = order[k];
        ns_mlcp_simplex_fix(b->s, &b->lp, i, order[k]);
        int status = visit(b);
        verdict = status == NS_E_INFEASIBLE ? verdict : status;
    }
    b->decided[a] = OPEN;
    ns_mlcp_simplex_release(b->s, &b->lp, i);
    return verdict;
}

/* What the modes decided on allow: OK, INFEASIBLE, or LIMIT: not known. */
static int visit(search *b) {
    if (b->nodes++ >= b->limit)
        return NS_E_LIMIT;
    int status = ns_mlcp_simplex_run(b->s, &b->lp);
    if (status == NS_E_INFEASIBLE)
        return status;
    if (status == NS_OK && answers(b) == NS_OK)
        return NS_OK;
    int a = worst(b);
    return a < 0 ? NS_E_LIMIT : split(b, a);
}

/* The proof that complementarity is not to blame, in the units of the problem. */
static void certify(ns_mlcp_solver *s, const ns_simplex *p) {
    for (int i = 0; i < s->m; i++)
        s->proof[i] = -ldexp(p->v[i], s->r[i]);
    s->proved = ns_mlcp_certify(s->p, s->proof) > 0.0;
}

static void name(ns_mlcp_solver *s, const ns_simplex *p) {
    for (int i = 0; i < s->m; i++)
        s->queue[i] = i;
    ns_mlcp_name(s, p->weight, s->m, s->queue);
}

int ns_mlcp_branch(ns_mlcp_solver *s) {
    const int left = NODES_ALIKE - s->looked_at;
    search b = {.s = s, .limit = NODES};
    if (s->alike)
        b.limit = left > NODES_EACH ? left : NODES_EACH;
    if (s->np > NS_BRANCH_MAX)
        return NS_E_SIZE;
    memset(b.decided, OPEN, sizeof b.decided);
    ns_mlcp_simplex_start(s, &b.lp);
    int status = visit(&b);
    if (left > 0) /* or it counts for ever */
        s->looked_at += b.nodes;
    if (status != NS_E_INFEASIBLE)
        return status;
    name(s, &b.lp);
    if (b.nodes == 1)
        certify(s, &b.lp);
    return status;
}
