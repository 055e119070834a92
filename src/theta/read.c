/* src/theta/read.c - the accepted point as it is shown: x, lambda and y, mode, controls. */
#include "name_fault.h"
#include "theta_internal.h"

#include <math.h>
#include <string.h>

/* What only follows from the state may overflow before it does.  y may be NULL. */
static int check_read(ns_theta *s, const double *y) {
    const int n = s->s->n, m = s->s->m;
    ns_fault found = {.t = s->fault.t};
    found.nunknowns = ns_theta_name_infinite(n, s->sol, found.unknown);
    found.npairs = ns_theta_name_infinite(m, s->sol + n, found.pair);
    if (found.nunknowns + found.npairs == 0)
        found.npairs = ns_theta_name_infinite(m, y, found.pair);
    if (found.nunknowns + found.npairs == 0)
        return NS_OK;
    s->fault = found;
    return ns_theta_fail(s, NS_E_OVERFLOW);
}

/* x, lambda of the accepted point, into s->sol. */
static int solve_at(ns_theta *s) {
    const int all = s->s->n + s->s->m;
    ns_map *map;
    if (s->past.jumped) {
        memcpy(s->sol, s->past.x_lambda, sizeof(double) * (size_t)all);
        return NS_OK;
    }
    const int status = ns_theta_find_map(s, s->past.h, s->past.implicit, s->past.mode, &map);
    if (status == NS_OK)
        ns_linalg_matvec(all, s->q, map->full, s->past.in, s->sol);
    return status;
}

int ns_theta_read(ns_theta *s, double *x, double *lambda, double *y) {
    if (!s)
        return NS_E_NULL;
    if (!s->past.jumped && !(s->past.h > 0))
        return NS_E_STATE;
    const int status = solve_at(s);
    if (status != NS_OK)
        return ns_theta_fail(s, status);
    const int n = s->s->n, m = s->s->m;
    if (x)
        memcpy(x, s->sol, sizeof(double) * (size_t)n);
    if (lambda)
        memcpy(lambda, s->sol + n, sizeof(double) * (size_t)m);
    if (y) {
        ns_linalg_copy((size_t)m, s->s->e, y);
        ns_linalg_matvec_add(m, n, s->s->C, s->sol, y); /* (S3) */
        ns_linalg_matvec_add(m, m, s->s->D, s->sol + n, y);
        ns_linalg_matvec_add(m, s->s->nz, s->s->F, s->past.in + s->r, y);
    }
    return check_read(s, y);
}

const double *ns_theta_controls(const ns_theta *s) {
    return s->trial.out + s->r * (s->carry ? 2 : 1);
}

const ns_mode *ns_theta_mode(const ns_theta *s) {
    return s->past.mode;
}

const ns_counts *ns_theta_counts(const ns_theta *s) {
    return &s->counts;
}

void ns_theta_bound_search(ns_theta *s, double most) {
    s->search_left = most;
}

double ns_theta_search_left(const ns_theta *s) {
    return s->search_left;
}

/* Fitted, with what the exact engine makes of them, to CPU times of 68 circuits of tests/stress, as
 * instructions of the sparse engine that take as long: those of products of matrices take a third of it.
 */
static double work_of_factors(const ns_theta *s, long factors) {
    const double size = (double)s->s->n + (double)s->s->m;
    return (38 + 1.6 * s->q) * size * size * (double)factors;
}

double ns_theta_matrix_work(const ns_theta *s, const ns_counts *c) {
    const double size = (double)s->s->n + (double)s->s->m, square = size * size;
    return 50 * size * square + work_of_factors(s, c->factors - s->passing_factors) +
           (20 * square + 26.0 * s->r * s->r * s->q) * (double)c->maps;
}

double ns_theta_problem_work(const ns_theta *s) {
    return work_of_factors(s, s->passing_factors) + s->expanded + s->searched;
}

double ns_theta_searched(const ns_theta *s) {
    return s->searched;
}

const ns_fault *ns_theta_fault(const ns_theta *s) {
    return &s->fault;
}
