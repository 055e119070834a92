/* src/sparse/local_lcp.c - the mode after an event where changing broken pairs finds none: (P1) of the pairs
 * touched in that search, all others held in their modes.
 *
 * With the pairs S of the problem at a bound, y_S = W lambda_S + q, a column of W by one solve.  Pairs that
 * its answer breaks join them.
 */
#include "guards.h"
#include "step.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Up to FEW pairs in all, all of them take part; at most MOST may; rounds of pairs that join. */
enum { FEW = 64, MOST = 400, ROUNDS = 8 };
/* Pairs of a loop carry more than this fraction of its largest current. */
static const double loop_fraction = 1e-3;
/* An entry of W below this fraction of the largest unknown may be its rounding; it is not, where a correction
 * of these unknowns changes it by no more than this part of it. */
static const double may_be_rounding = 1e-9, most_change = 1e-3;

typedef struct local {
    int count;
    int *pair; /* count */
    double *W, *q, *l, *u, *lambda, *y;
    ns_mode *mode;
    ns_mlcp_solver *solver;
} local;

/* 1 if pair j is not commanded. */
static int has_law(const ns_sparse *m, int j) {
    return m->l[j] < m->u[j] && (isfinite(m->l[j]) || isfinite(m->u[j]));
}

/* Marks the pairs that take part in m->touched; how many. */
static int choose_pairs(ns_sparse *m) {
    int all = 0, count = 0;
    for (int j = 0; j < m->f->m; j++)
        all += has_law(m, j);
    for (int j = 0; j < m->f->m; j++) {
        m->touched[j] = (unsigned char)((m->touched[j] || all <= FEW) && has_law(m, j));
        count += m->touched[j];
    }
    return count;
}

static void free_problem(local *p) {
    free(p->pair);
    free(p->W);
    free(p->mode);
    ns_mlcp_free(p->solver);
}

static int create_problem(const ns_sparse *m, int count, local *p) {
    const size_t s = (size_t)count;
    *p = (local){.count = 0};
    p->pair = calloc(s + 1, sizeof(int));
    p->W = calloc(s * s + 5 * s + 1, sizeof(double));
    p->mode = calloc(s + 1, sizeof(ns_mode));
    if (!p->pair || !p->W || !p->mode || ns_mlcp_create(count, &p->solver) != NS_OK) {
        free_problem(p);
        return NS_E_MEMORY;
    }
    p->q = p->W + s * s;
    p->l = p->q + s;
    p->u = p->l + s;
    p->lambda = p->u + s;
    p->y = p->lambda + s;
    for (int j = 0; j < m->f->m; j++)
        if (m->touched[j]) {
            p->l[p->count] = m->l[j];
            p->u[p->count] = m->u[j];
            p->mode[p->count] = m->mode[j];
            p->pair[p->count++] = j;
        }
    return NS_OK;
}

/* 1 if what lambda_j = 1 does to y_j, in its column v, is but the rounding of v: closed pairs hold its
 * branch.  Taken for a resistance it would let currents of 1e13 A close a loop that has a forward drop. */
static int is_rounding(ns_sparse *m, const ns_cached_factors *k, double g, int j, const double *v) {
    const double entry = fabs(ns_linalg_csc_dot(&m->f->Ct, j, v));
    double largest = 0;
    for (int i = 0; i < m->f->size; i++)
        largest = fmax(largest, fabs(v[i]));
    if (entry == 0 || entry > may_be_rounding * largest)
        return 0;
    memset(m->r, 0, sizeof(double) * (size_t)m->f->size);
    m->r[m->f->n + j] = 1;
    ns_sparse_form_subtract(m->f, g, m->mode, v, m->r);
    return ns_sparse_factors_correct(m->q, k, m->r, m->work.v) != NS_OK ||
           fabs(ns_linalg_csc_dot(&m->f->Ct, j, m->work.v)) > most_change * entry;
}

/* W and q, from the mode with all of them at a bound. */
static int form_problem(ns_sparse *m, double t, double g, const double *w, double *v, double *by, local *p) {
    const ns_form *f = m->f;
    const ns_cached_factors *k;
    for (int i = 0; i < p->count; i++)
        ns_sparse_guard_set_pair(m, p->pair[i], isfinite(p->l[i]) ? NS_LOWER : NS_UPPER);
    int status = ns_sparse_step_euler(m, t, g, w, 1, v, by);
    if (status != NS_OK && status != NS_E_SINGULAR)
        return status;
    for (int i = 0; i < p->count; i++)
        p->q[i] = ns_sparse_form_y(f, p->pair[i], v, m->z, 1);
    status = ns_sparse_factors_factor(m->q, g, m->mode, 1, &k);
    for (int c = 0; c < p->count && status == NS_OK; c++) {
        memset(m->r, 0, sizeof(double) * (size_t)f->size);
        m->r[f->n + p->pair[c]] = 1;
        status = ns_sparse_factors_solve(m->q, k, m->r, v);
        status = status == NS_E_SINGULAR ? NS_OK : status; /* v is then what small leaks make of it */
        const double bound = isfinite(p->l[c]) ? p->l[c] : p->u[c];
        const int no_own = is_rounding(m, k, g, p->pair[c], v);
        for (int i = 0; i < p->count; i++) {
            const double entry = i == c && no_own ? 0 : ns_linalg_csc_dot(&f->Ct, p->pair[i], v);
            p->W[i + c * p->count] = entry;
            p->q[i] -= entry * bound;
        }
    }
    return status;
}

/* What branch and bound, and a proof that there is no mode, may take of what the engine may. */
static double search_left(ns_sparse *m) {
    const double most = m->engine.most_work;
    return most > 0 ? fmax(0, most - ns_engine_work(&m->engine).all) : INFINITY;
}

static int solve_problem(ns_sparse *m, local *p) {
    const ns_mlcp of = {.m = p->count, .W = p->W, .q = p->q, .l = p->l, .u = p->u};
    ns_mlcp_info info = {0};
    (void)ns_mlcp_limit(p->solver, search_left(m));
    const int status = ns_mlcp_solve(p->solver, &of, p->mode, p->lambda, p->y, &info);
    m->counts.pivots += info.pivots;
    m->searched += info.searched;
    for (int i = 0; i < p->count && status == NS_OK; i++)
        ns_sparse_guard_set_pair(m, p->pair[i], p->mode[i]);
    if (status == NS_OK)
        return status;
    m->fault.npairs = info.fault.npairs;
    for (int i = 0; i < info.fault.npairs; i++)
        m->fault.pair[i] = p->pair[info.fault.pair[i]];
    return status;
}

static int solve_once(ns_sparse *m, int count, double t, double g, const double *w, double *v, double *by) {
    local p;
    int status = create_problem(m, count, &p);
    if (status != NS_OK)
        return status;
    status = form_problem(m, t, g, w, v, by, &p);
    if (status == NS_OK)
        status = solve_problem(m, &p);
    free_problem(&p);
    return status;
}

/* Broken pairs that took no part do so from now on; how many. */
static int add_broken(ns_sparse *m, const double *v, const double *w, double g) {
    int count = 0;
    if (ns_sparse_guard_broken(m, v, w, g, 1) == 0)
        return 0;
    for (int j = 0; j < m->f->m; j++)
        if (m->flip[j] && !m->touched[j]) {
            m->touched[j] = 1;
            count++;
        }
    return count;
}

/* Closed pairs contradict each other: names those with the largest currents by small leaks. */
static int name_loop(ns_sparse *m, const double *v) {
    double largest = 0;
    for (int j = 0; j < m->f->m; j++)
        largest = m->mode[j] == NS_INSIDE ? fmax(largest, fabs(v[m->f->n + j])) : largest;
    m->fault.npairs = 0;
    for (int j = 0; j < m->f->m && m->fault.npairs < NS_FAULT_MAX; j++)
        if (m->mode[j] == NS_INSIDE && fabs(v[m->f->n + j]) > loop_fraction * largest)
            m->fault.pair[m->fault.npairs++] = j;
    return NS_E_INFEASIBLE;
}

int ns_sparse_local_lcp(ns_sparse *m, double t, double g, const double *w, double *v, double *by) {
    for (int round = 0; round < ROUNDS; round++) {
        const int count = choose_pairs(m);
        if (count == 0 || count > MOST) /* none: the equations contradict each other, whatever pairs do */
            return count == 0 ? NS_E_INFEASIBLE : NS_E_LIMIT;
        int status = solve_once(m, count, t, g, w, v, by);
        if (status != NS_OK)
            return status;
        status = ns_sparse_step_euler(m, t, g, w, 1, v, by);
        if (status != NS_OK && status != NS_E_SINGULAR)
            return status;
        if (add_broken(m, v, w, g) == 0) /* a guard that the solver calls zero is not broken */
            return status == NS_OK ? status : name_loop(m, v);
    }
    return NS_E_LIMIT;
}
