/* src/newton/point.c - a model's functions and Jacobians at an iterate, and what they leave of the
 * step's equations:
 *
 *     R  = M (x - x_k) - h theta f - h(1-theta) f_k - h gamma g - h(1-gamma) r_k       differential rows
 *     R  = - f - g                                                                     algebraic rows
 *     Ry = y - h(x,lambda)
 *
 * With the relation at t_k+gamma, g, h and the algebraic rows are taken at x_k + gamma (x - x_k).
 */
#include <math.h>
#include <string.h>

#include "linalg/row_split.h"
#include "newton_internal.h"

static int evaluate(const ns_newton *s, ns_function f, const ns_point *at, size_t count, double *out) {
    if (f(at, s->model->data, out) != 0)
        return NS_DIVERGED;
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += 0 * out[i]; /* 0, or NaN */
    return sum == 0 ? NS_OK : NS_E_NUMBER;
}

/* Where f is taken; where the relation is. */
static ns_point end_point(const ns_newton *s, const ns_iterate *at) {
    return (ns_point){s->t1, at->x, at->lambda, s->z1};
}

static ns_point relation_point(ns_newton *s, const ns_iterate *at) {
    for (int i = 0; i < s->n; i++)
        s->xr[i] = s->cx == 1 ? at->x[i] : s->from[i] + s->cx * (at->x[i] - s->from[i]);
    return (ns_point){s->tr, s->xr, at->lambda, s->zr};
}

static int relation_is_elsewhere(const ns_newton *s) {
    return s->cx != 1 && s->rank < s->n;
}

/* out (n*columns) = T f, its algebraic rows from the relation's point. */
static int evaluate_f(ns_newton *s, ns_function f, int columns, const ns_point *end, const ns_point *relation,
                      double *out) {
    const int n = s->n;
    const size_t count = (size_t)n * (size_t)columns;
    int status = evaluate(s, f, end, count, s->work);
    if (status != NS_OK)
        return status;
    ns_linalg_row_split_apply(n, columns, s->T, s->work, out);
    if (!relation_is_elsewhere(s))
        return NS_OK;
    if ((status = evaluate(s, f, relation, count, s->work)) != NS_OK)
        return status;
    double *row = s->work + count; /* n: one column, combined */
    for (int j = 0; j < columns; j++) {
        ns_linalg_row_split_apply(n, 1, s->T, s->work + (size_t)j * (size_t)n, row);
        memcpy(out + s->rank + j * n, row + s->rank, sizeof(double) * (size_t)(n - s->rank));
    }
    return NS_OK;
}

int ns_newton_values(ns_newton *s, ns_iterate *at) {
    const size_t n = (size_t)s->n;
    const ns_point end = end_point(s, at), relation = relation_point(s, at);
    int status = NS_OK;
    if (n > 0) {
        s->counts.calls++;
        status = evaluate_f(s, s->model->f, 1, &end, &relation, at->f);
    }
    memset(at->r, 0, sizeof(double) * n);
    memset(at->g, 0, sizeof(double) * n);
    if (status != NS_OK || s->m == 0)
        return status;
    if ((status = evaluate(s, s->model->g, &relation, n, at->r)) != NS_OK) /* (S2) */
        return status;
    ns_linalg_row_split_apply(s->n, 1, s->T, at->r, at->g);
    return evaluate(s, s->model->h, &relation, (size_t)s->m, at->h); /* (S3) */
}

int ns_newton_jacobians(ns_newton *s, const ns_iterate *at) {
    const size_t n = (size_t)s->n, m = (size_t)s->m;
    const ns_point end = end_point(s, at), relation = relation_point(s, at);
    int status = n > 0 ? evaluate_f(s, s->model->A, s->n, &end, &relation, s->A) : NS_OK;
    if (status != NS_OK || m == 0)
        return status;
    if ((status = evaluate(s, s->model->B, &relation, n * m, s->work)) != NS_OK)
        return status;
    ns_linalg_row_split_apply(s->n, s->m, s->T, s->work, s->B);
    if (s->model->K && (status = evaluate(s, s->model->K, &relation, n * n, s->work)) == NS_OK)
        ns_linalg_row_split_apply(s->n, s->n, s->T, s->work, s->K);
    if (status == NS_OK)
        status = evaluate(s, s->model->C, &relation, m * n, s->C);
    if (status == NS_OK && s->model->D)
        status = evaluate(s, s->model->D, &relation, m * m, s->D);
    return status;
}

int ns_newton_slope(ns_newton *s) {
    if (s->has_fk || s->n == 0)
        return NS_OK;
    for (int i = 0; i < s->model->nz; i++)
        s->z1[i] = ns_signal_value(&s->model->z[i], s->t, NS_RIGHT);
    const ns_point at = {s->t, s->xk, s->lk, s->z1};
    s->counts.calls++;
    const int status = evaluate(s, s->model->f, &at, (size_t)s->n, s->work);
    if (status != NS_OK)
        return status;
    ns_linalg_row_split_apply(s->n, 1, s->T, s->work, s->fk);
    s->has_fk = 1;
    return NS_OK;
}

void ns_newton_residuals(ns_newton *s, ns_iterate *at) {
    const int n = s->n;
    for (int i = 0; i < s->rank; i++) {
        double sum = -s->past[i] - s->ht * at->f[i] - s->hg * at->g[i];
        for (int j = 0; j < n; j++)
            sum += s->M[i + j * n] * (at->x[j] - s->from[j]);
        at->R[i] = sum; /* (T2) less h(1-gamma) r_k and h gamma g */
    }
    for (int i = s->rank; i < n; i++)
        at->R[i] = -at->f[i] - at->g[i];
    for (int i = 0; i < s->m; i++)
        at->Ry[i] = at->y[i] - at->h[i];
}
