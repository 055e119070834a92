/* src/exact/output_columns.c - what output_solve.c makes of unit vectors, as a matrix: where the answers of
 * the output map cancel, those of (P2) with its constraints in place seldom do, and then one product is the
 * solution of any state. */
#include "linalg/simd.h"
#include "mode_kernel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* 1 if the terms of the sum may be so much larger than what is left of them that digits are lost.  Those of
 * charges may: charges are rounded themselves, and no solution for them is nearer than that. */
static int digits_cancel(const ns_mode_kernel *k, int all, int columns, const double *X, const double *sum) {
    static const double large = 1e3;
    const double *size = k->solved + (size_t)all * (size_t)columns;
    double terms = 0, of_charges = 0, most = 0;
    for (int j = 0; j < columns; j++) {
        terms += size[j] * fabs(X[j]);
        if (j < k->r)
            of_charges += size[j] * fabs(X[j]);
    }
    for (int i = 0; i < all; i++)
        most = ns_higher(most, fabs(sum[i]));
    return !(terms <= large * ns_higher(most, of_charges));
}

/* Columns one after another, each with its size; 0: one of them has no solution. X: the unit vectors. */
static int fill(const ns_theta *s, const ns_input_states *e, const ns_mode_kernel *k, double *X, double *to) {
    const size_t all = (size_t)s->s->n + (size_t)s->s->m;
    const size_t columns = (size_t)k->q + (size_t)e->output_only_inputs;
    double *size = to + all * columns;
    for (size_t j = 0; j < columns; j++) {
        double *at = to + j * all;
        memset(X, 0, sizeof *X * columns);
        X[j] = 1;
        memcpy(at, k->x_lambda_now + j * all, sizeof *at * all); /* of pairs at bounds */
        if (!ns_exact_output_solve(s, e, k, X, at))
            return 0;
        for (size_t i = 0; i < all; i++)
            size[j] = ns_higher(size[j], fabs(at[i]));
    }
    return 1;
}

int ns_exact_output_columns(const ns_theta *s, const ns_input_states *e, ns_mode_kernel *k) {
    const size_t all = (size_t)s->s->n + (size_t)s->s->m;
    const size_t columns = (size_t)k->q + (size_t)e->output_only_inputs, numbers = (all + 1) * columns;
    if (k->solved || k->solves < 0 || k->solves++ < (int)columns) /* not before it may be worth it */
        return NS_OK;
    double *to = calloc(numbers + 1, sizeof *to), *X = calloc(columns + 1, sizeof *X);
    const int status = to && X ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK && fill(s, e, k, X, to)) {
        k->solved = to;
        k->bytes += sizeof *to * numbers;
        to = NULL;
    } else if (status == NS_OK) {
        k->solves = -1;
    }
    free(to);
    free(X);
    return status;
}

int ns_exact_output_columns_apply(const ns_theta *s, const ns_input_states *e, const ns_mode_kernel *k,
                                  const double *X, double *x_lambda) {
    const int all = s->s->n + s->s->m, columns = k->q + e->output_only_inputs;
    if (!k->solved)
        return 0;
    ns_linalg_matvec(all, columns, k->solved, X, x_lambda);
    return !digits_cancel(k, all, columns, X, x_lambda);
}
