/* src/mlcp/verify/consistent_answer.c - y and mode as lambda, the one that is returned, has them.
 *
 * Lambda is put into its bounds when its equations are solved.  Where a box is narrower than what is rounding
 * beside lambda, that moves it from one bound to the other, and the natural residual, a distance in lambda,
 * does not see y there: lambda may lie anywhere in the box, its pair inside, and y be of any size.  So y is
 * read once more, from W, q and lambda as they are, and where it is not the one of the mode, its sign says at
 * which bound lambda is.  And a pair whose lambda was moved off its bound, as one that is degenerate may be
 * (branch_and_bound.c), is not at it.
 */
#include <math.h>

#include "mlcp/mlcp_internal.h"
#include "residual.h"
#include "residual_bound.h"

enum { ROUNDS = 4 };

/* Of equalities the residual says all. */
static inline int row_differs(const ns_mlcp_solver *s, int i, double y, double size) {
    const int equality = isinf(s->p->l[i]) && isinf(s->p->u[i]);
    return !equality && fabs(y - s->y[i]) > NS_MLCP_ACCEPT * size;
}

/* The pairs and given lambda whose y is not s->ray: list gets them. */
static int list_differing(const ns_mlcp_solver *s, int *list) {
    int n = 0;
    for (int i = 0; i < s->m; i++)
        if (row_differs(s, i, s->ray[i], s->ysize[i]))
            list[n++] = i;
    return n;
}

int ns_mlcp_is_inconsistent(const ns_mlcp_solver *s, const double *y, const double *size) {
    int n = 0;
    for (int i = 0; i < s->m; i++)
        n += row_differs(s, i, y[i], size[i]);
    return n > 0;
}

/* The same with s->ray read anew; rows whose terms are all rounding differ in nothing. */
static int list_rows_that_differ(ns_mlcp_solver *s, int *list) {
    ns_mlcp_sum_terms(s->p, NULL, s->lambda, s->ray, s->ysize);
    const int n = list_differing(s, list);
    if (n == 0)
        return 0;
    ns_mlcp_units(s);
    ns_mlcp_basis_floor_sizes(s);
    return list_differing(s, list);
}

/* Lambda and mode of pair i, as its y asks for; of 0 it asks for nothing.  0: there is no such bound. */
static int move_to_bound(ns_mlcp_solver *s, int i) {
    if (fabs(s->ray[i]) <= NS_MLCP_ACCEPT * s->ysize[i])
        return 1;
    const ns_mode to = s->ray[i] > 0.0 ? NS_LOWER : NS_UPPER;
    const double bound = ns_mlcp_bound(s, i, to);
    if (isinf(bound))
        return 0;
    if (s->p->l[i] != s->p->u[i])
        s->mode[i] = to;
    s->lambda[i] = bound;
    return 1;
}

/* Modes at a bound where lambda is not, and y says nothing. */
static void fit_modes(ns_mlcp_solver *s) {
    for (int i = 0; i < s->m; i++) {
        const double l = s->p->l[i], u = s->p->u[i], v = s->lambda[i];
        if (s->mode[i] == NS_INSIDE || v == ns_mlcp_bound(s, i, s->mode[i]) ||
            fabs(s->y[i]) > NS_MLCP_ACCEPT * s->ysize[i])
            continue;
        s->mode[i] = v == l ? NS_LOWER : v == u ? NS_UPPER : NS_INSIDE;
        s->y[i] = 0.0;
    }
}

static int iterate_bounds(ns_mlcp_solver *s, double *residual) {
    int *list = s->queue, n = list_rows_that_differ(s, list);
    if (n == 0)
        return 1;
    for (int round = 0; round < ROUNDS && n > 0; round++) {
        for (int k = 0; k < n; k++)
            if (!move_to_bound(s, list[k]))
                return 0;
        ns_mlcp_sum_terms(s->p, NULL, s->lambda, s->y, s->ysize);
        ns_mlcp_basis_clamp(s);
        n = list_rows_that_differ(s, list);
    }
    *residual = ns_mlcp_measure(s->p, s->lambda, s->alike, s->rhs, NULL);
    return n == 0 && *residual <= NS_MLCP_ACCEPT;
}

int ns_mlcp_make_consistent(ns_mlcp_solver *s, double *residual) {
    if (!iterate_bounds(s, residual))
        return 0;
    fit_modes(s);
    return 1;
}
