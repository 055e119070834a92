/* src/mlcp/infeasible/branch_and_bound.c - is there a solution at all?  Modes of some pairs at a time, the
 * others left aside.
 *
 * With complementarity left aside a problem is linear (phase1.c).  If that has no solution, neither has the
 * problem; if its solution is complementary, it is one; otherwise a pair that breaks its law is put into each
 * of its modes in turn.  A branch without a solution is cut with all modes below it.  Singular modes are no
 * exception here: what is asked is whether their equations and bounds are consistent.
 */
#include "branch_and_bound.h"

#include <math.h>
#include <string.h>

#include "mlcp/verify/residual.h"
#include "phase1.h"

/* Nodes looked at.  A problem of a step is asked again at other lengths: all of them together, since the last
 * answer, look at NODES_ALIKE, and each at NODES_EACH. */
enum { NODES = 20000, NODES_ALIKE = 1000, NODES_EACH = 50, REFINEMENTS = 3 };

typedef struct search {
    ns_mlcp_solver *s;
    ns_phase1 lp;
    double *value;  /* 2m: of lambda_i at 2i, of y_i at 2i+1 */
    int *basic;     /* 2m */
    double *weight; /* m: how much the proofs so far rested on each row */
    int nodes, limit;
} search;

static double below(const search *b, int i) {
    return b->value[2 * i] - b->s->tab.lo[i];
}

static double above(const search *b, int i) {
    return b->s->tab.hi[i] - b->value[2 * i];
}

/* Distance of lambda_i from the bound that y_i tells it to be at, or y_i, whichever is less. */
static double law_violation(const search *b, int i) {
    const double y = b->value[2 * i + 1];
    return fmin(fabs(y), y > 0.0 ? below(b, i) : above(b, i));
}

/* The open pair that breaks its law most, -1: none is open. */
static int most_violated_pair(const search *b) {
    int at = -1;
    double most = -INFINITY;
    for (int a = 0; a < b->s->np; a++) {
        const int i = b->s->pair[a];
        const double v = law_violation(b, i);
        if (b->lp.mode[i] != NS_OPEN || !(v > most))
            continue;
        most = v;
        at = i;
    }
    return at;
}

/* The mode that the simplex method's basis gives pair i. */
static ns_mode read_mode(const search *b, int i) {
    const double down = below(b, i), up = above(b, i);
    if (b->lp.mode[i] != NS_OPEN)
        return b->lp.mode[i];
    if (!b->basic[2 * i + 1])
        return NS_INSIDE;
    if (!b->basic[2 * i])
        return up <= 0.0 ? NS_UPPER : NS_LOWER;
    return fmin(down, up) > fabs(b->value[2 * i + 1]) ? NS_INSIDE : down < up ? NS_LOWER : NS_UPPER;
}

/* lambda and mode as the basis has them, and the factors of its equations. */
static int factor_basis(search *b) {
    ns_mlcp_solver *s = b->s;
    int nr = 0, nc = 0;
    ns_mlcp_start_from(s, NULL);
    for (int i = 0; i < s->m; i++) {
        s->lambda[i] = fmin(fmax(ldexp(b->value[2 * i], s->elim.col_exp[i]), s->p->l[i]), s->p->u[i]);
        if (!b->basic[2 * i + 1])
            s->rows[nr++] = i;
        if (b->basic[2 * i])
            s->cols[nc++] = i;
    }
    for (int a = 0; a < s->np; a++) {
        const int i = s->pair[a];
        s->mode[i] = ns_mlcp_fit_mode(s, i, read_mode(b, i));
        if (s->mode[i] != NS_INSIDE)
            s->lambda[i] = ns_mlcp_bound(s, i, s->mode[i]);
    }
    if (nr != nc)
        return NS_E_SINGULAR;
    s->k = nc;
    for (int j = 0; j < nc; j++)
        for (int i = 0; i < nc; i++)
            s->G[(size_t)i + (size_t)j * (size_t)nc] =
                s->W[(size_t)s->rows[i] + (size_t)s->cols[j] * (size_t)s->m];
    return ns_mlcp_basis_factor_of(s, nc, s->G, NULL);
}

/* OK if the simplex method's answer is one of the problem. */
static int is_solution(search *b) {
    ns_mlcp_solver *s = b->s;
    const int refined = factor_basis(b) == NS_OK;
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

static int visit_node(search *b);

/* Pair i in each of its modes, the one it is nearest to first. */
static int split_on_pair(search *b, int i) {
    int verdict = NS_E_INFEASIBLE;
    const ns_mode near = ns_mlcp_fit_mode(b->s, i, b->value[2 * i + 1] > 0.0 ? NS_LOWER : NS_UPPER);
    const ns_mode far = (ns_mode)-near, order[] = {near, NS_INSIDE, far};
    const int n = ns_mlcp_fit_mode(b->s, i, far) == far ? 3 : 2; /* or it has no such bound */
    for (int k = 0; k < n && verdict != NS_OK; k++) {
        ns_mlcp_phase1_put(&b->lp, i, order[k]);
        const int status = visit_node(b);
        verdict = status == NS_E_INFEASIBLE ? verdict : status;
    }
    ns_mlcp_phase1_put(&b->lp, i, NS_OPEN);
    return verdict;
}

/* Whether no solution is in the modes decided on: proved, and the rows that the proof rests on remembered. */
static int is_cut(search *b, int status) {
    ns_mlcp_solver *s = b->s;
    double top = 0.0;
    if (status != NS_E_INFEASIBLE || !ns_mlcp_farkas_proves(&b->lp, s->proof.v))
        return 0;
    for (int i = 0; i < s->m; i++)
        top = fmax(top, ldexp(fabs(s->proof.v[i]), -s->elim.row_exp[i]));
    for (int i = 0; i < s->m && top > 0.0; i++)
        b->weight[i] += ldexp(fabs(s->proof.v[i]), -s->elim.row_exp[i]) / top;
    return 1;
}

/* What the modes decided on allow: OK, INFEASIBLE, or LIMIT: not known. */
static int visit_node(search *b) {
    if (b->nodes++ >= b->limit || b->s->cut_off)
        return NS_E_LIMIT;
    const int status = ns_mlcp_phase1_run(&b->lp);
    if (is_cut(b, status))
        return NS_E_INFEASIBLE;
    ns_mlcp_phase1_read(&b->lp, b->value, b->basic);
    if (status == NS_OK && is_solution(b) == NS_OK)
        return NS_OK;
    const int i = most_violated_pair(b);
    return i < 0 ? NS_E_LIMIT : split_on_pair(b, i);
}

int ns_mlcp_branch_and_bound(ns_mlcp_solver *s) {
    const int left = NODES_ALIKE - s->nodes_alike;
    search b = {.s = s, .value = s->tab.unit, .basic = s->tab.where, .weight = s->tab.T, .limit = NODES};
    if (s->alike)
        b.limit = left > NODES_EACH ? left : NODES_EACH;
    if (s->np > NS_BRANCH_MAX)
        return NS_E_SIZE;
    memset(b.weight, 0, (size_t)s->m * sizeof *b.weight);
    ns_mlcp_phase1_start(&b.lp, s, 1, 0.0);
    b.lp.most = s->most;
    const int status = visit_node(&b);
    if (left > 0) /* or it counts for ever */
        s->nodes_alike += b.nodes;
    if (status != NS_E_INFEASIBLE)
        return status;
    for (int i = 0; i < s->m; i++)
        s->queue[i] = i;
    ns_mlcp_name(s, b.weight, s->m, s->queue);
    s->proof.found = b.nodes == 1; /* complementarity is not to blame */
    return status;
}
