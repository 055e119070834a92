/* src/exact/output_map.c - x and lambda of a state, (E1) at tau = 0, as one matrix. */
#include "linalg/simd.h"
#include "mode_kernel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* to (r) += the first r rows of a column, count times x */
static void add_column(const ns_theta *s, const double *restrict column, double x, double *restrict to) {
    const int r = x != 0 ? s->r : 0;
    int i = 0;
    for (; i + NS_LANES <= r; i += NS_LANES)
        *(ns_simd *)(to + i) += *(const ns_simd *)(column + i) * x;
    for (; i < r; i++)
        to[i] += column[i] * x;
}

/* rest (r) -= M x */
static void take_charges(const ns_theta *s, const double *x, double *rest) {
    for (int k = 0; k < s->stores; k++)
        rest[s->stored[k].charge] -= s->stored[k].value * x[s->stored[k].unknown];
}

/* Column j of A and B side by side. */
static const double *column_of(const ns_theta *s, size_t j) {
    const size_t n = (size_t)s->s->n;
    return j < n ? s->A + j * n : s->B + (j - n) * n;
}

/* Which x and lambda enter differential rows: how many. */
static int find_entering(const ns_theta *s, int *enters) {
    int count = 0;
    for (int j = 0; j < s->s->n + s->s->m; j++) {
        const double *column = column_of(s, (size_t)j);
        int i = 0;
        while (i < s->r && column[i] == 0)
            i++;
        if (i < s->r)
            enters[count++] = j;
    }
    return count;
}

/* The residual of the differential rows of the Euler step at (x, lambda) = at, for this sum.  enters: so many
 * of find_entering().  room: r + nv. */
static void find_residual(const ns_theta *s, const ns_input_states *e, double g, const double *sum,
                          const double *at, const int *enters, int count, double *residual, double *room) {
    const size_t n = (size_t)s->s->n;
    double *rate = room, *v = room + s->r;
    memcpy(v, sum + s->r, sizeof(double) * (size_t)e->nv);
    ns_inputs_states_stage(e, g, v);
    for (int i = 0; i < s->r; i++) {
        rate[i] = s->b[i] * v[0];
        for (int k = 0; k < s->s->nz; k++)
            for (int a = 0; a < e->nv && s->E[(size_t)i + (size_t)k * n] != 0; a++)
                rate[i] += s->E[(size_t)i + (size_t)k * n] * e->Z[k + a * s->s->nz] * v[a];
    }
    for (int k = 0; k < count; k++)
        add_column(s, column_of(s, (size_t)enters[k]), at[enters[k]], rate);
    memcpy(residual, sum, sizeof *residual * (size_t)s->r);
    take_charges(s, at, residual);
    for (int i = 0; i < s->r; i++)
        residual[i] += g * rate[i];
}

/* 1 if M times a column is not the unit vector that it belongs to, as where k is almost 1: currents of 1e6 A
 * for 1 Wb cancel in the flux. */
static int columns_cancel(const ns_theta *s, const ns_mode_kernel *k, double *rest) {
    static const double few = 1e-13;
    const size_t all = (size_t)s->s->n + (size_t)s->s->m;
    for (int j = 0; j < k->r; j++) {
        memset(rest, 0, sizeof *rest * (size_t)k->r);
        rest[j] = 1;
        take_charges(s, k->x_lambda_now + (size_t)j * all, rest);
        for (int i = 0; i < k->r; i++)
            if (fabs(rest[i]) * s->unit[j] > few * s->unit[i])
                return 1;
    }
    return 0;
}

/* 1 if the terms of a sum may be so large that less than six of its digits are no rounding. */
static int digits_cancel(const ns_mode_kernel *k, int all, const double *X, const double *x_lambda) {
    static const double large = 1e6;
    double terms = 0, most = 0;
    for (int j = 0; j < k->q; j++)
        terms += k->output_sizes[j] * fabs(X[j]);
    for (int i = 0; i < all; i++)
        most = ns_higher(most, fabs(x_lambda[i]));
    return terms > large * most;
}

int ns_exact_output_map_apply(ns_theta *s, const ns_input_states *e, ns_mode_kernel *k, const double *X,
                              double *x_lambda, double *residual) {
    const int all = s->s->n + s->s->m;
    if (ns_exact_output_columns_apply(s, e, k, X, x_lambda))
        return NS_OK;
    ns_linalg_matvec(all, k->q + e->output_only_inputs, k->x_lambda_now, X, x_lambda);
    if (digits_cancel(k, all, X, x_lambda)) {
        int status = k->output_asked ? NS_OK : ns_exact_output_rows(s, e, k);
        if (status == NS_OK && k->output_rows)
            status = ns_exact_output_columns(s, e, k);
        if (status != NS_OK)
            return status;
        if (k->output_rows && ns_exact_output_solve(s, e, k, X, x_lambda))
            return NS_OK;
    }
    if (!k->output_cancels)
        return NS_OK;
    memcpy(residual, X, sizeof *residual * (size_t)k->r);
    take_charges(s, x_lambda, residual);
    ns_linalg_matvec_add(all, k->r, k->x_lambda_now, residual, x_lambda);
    return NS_OK;
}

/* The largest entry of each column: k->output_sizes. */
static void find_sizes(const ns_mode_kernel *k, size_t all) {
    for (size_t j = 0; j < (size_t)k->q; j++) {
        k->output_sizes[j] = 0;
        for (size_t i = 0; i < all; i++)
            k->output_sizes[j] = ns_higher(k->output_sizes[j], fabs(k->x_lambda_now[i + j * all]));
    }
}

/* Where the mode constrains the charges, unit vectors have huge answers that cancel in the sum: one step of
 * refinement removes their rounding. */
int ns_exact_output_map(const ns_theta *s, const ns_input_states *e, ns_mode_kernel *k) {
    const size_t all = (size_t)s->s->n + (size_t)s->s->m, q = (size_t)k->q, r = (size_t)k->r;
    const size_t numbers = all * (q + (size_t)e->output_only_inputs) + q;
    double *now = calloc(numbers + 1, sizeof *now);
    double *sum = calloc(q + 2 * r + 2 * (size_t)k->nv + 1, sizeof *sum);
    int *enters = calloc(all + 1, sizeof *enters);
    if (!now || !sum || !enters) {
        free(now);
        free(sum);
        free(enters);
        return NS_E_MEMORY;
    }
    const int count = find_entering(s, enters);
    for (size_t j = 0; j < q; j++) {
        double *at = now + j * all, *residual = sum + q;
        ns_exact_output_images(k, e, (int)j, sum, residual + r);
        ns_linalg_matvec((int)all, k->q, k->step_x_lambda, sum, at);
        find_residual(s, e, k->g, sum, at, enters, count, residual, residual + r);
        ns_linalg_matvec_add((int)all, k->r, k->step_x_lambda, residual, at);
    }
    memcpy(now + q * all, k->step_x_lambda + q * all, sizeof *now * all * (size_t)e->output_only_inputs);
    k->x_lambda_now = now;
    for (int j = k->r; j < k->q; j++)
        if (ns_exact_kernel_leaves_off(s, k, j, sum))
            ns_linalg_matvec_add((int)all, k->r, now, k->D8 + (size_t)j * r, now + (size_t)j * all);
    k->output_sizes = now + numbers - q;
    find_sizes(k, all);
    k->output_cancels = columns_cancel(s, k, sum);
    free(sum);
    free(enters);
    k->bytes += sizeof *now * numbers;
    return NS_OK;
}
