/* src/reinit/order_expansion.c - the orders in 1/h of a mode's step as h -> 0: impulses, values, rates.
 *
 * A step of length h with theta = gamma = 1 in a mode is (P2), K(h) Z = R(h), Z = (x, lambda_J), and
 *
 *     K(h) = K0 + h K1,   R(h) = R0 + h R1,   Z(h) = Z1/h + Z0 + h Z2 + ...
 *     K0 = [ M; -A -B_J; C_J D_JJ ],   K1 = [ -A -B_J; 0; 0 ]   (differential rows; algebraic rows; pairs)
 *
 * whose orders 1/h, 1, h, h^2 are these, and the condition that there is one more:
 *
 *     K0 Z1 = 0,   K0 Z0 + K1 Z1 = R0,   K0 Z2 + K1 Z0 = R1,   K0 . + K1 Z2 = 0
 */
#include "order_expansion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int ns_reinit_orders_create(ns_theta *s, const double *w, ns_order_expansion *k) {
    const size_t m = (size_t)s->s->m, all = (size_t)s->s->n + m, square = all * all;
    double **const vectors[] = {&k->R0,      &k->R1,    &k->terms,    &k->terms_w,  &k->guess,    &k->Z1,
                                &k->Z0,      &k->Z2,    &k->E1,       &k->E0,       &k->E2,       &k->at[0],
                                &k->at[1],   &k->at[2], &k->error[0], &k->error[1], &k->error[2], &k->jump[0],
                                &k->jump[1], &k->v,     &k->rest,     &k->few};
    const size_t count = sizeof vectors / sizeof *vectors;
    memset(k, 0, sizeof *k);
    k->s = s;
    k->K0 = calloc(7 * square + (count + 2 + 5) * all + 1, sizeof(double));
    k->fine = calloc(6 * all + 1, sizeof *k->fine);
    k->inside = calloc(m + 1, sizeof *k->inside + 2 * sizeof *k->mode);
    if (!k->K0 || !k->fine || !k->inside)
        return NS_E_MEMORY;
    k->w = k->fine + 5 * all;
    k->mode = (ns_mode *)(k->inside + m);
    k->left_mode = k->mode + m;
    k->K1 = k->K0 + square;
    k->S0 = k->K1 + square;
    k->G = k->S0 + square;
    k->SG = k->G + square;
    k->V = k->SG + square;
    k->H = k->V + square;
    for (size_t i = 0, at = 0; i < count; i++, at += all)
        *vectors[i] = k->H + square + at;
    k->work = k->few + 3 * all;
    memcpy(k->left_mode, s->past.mode, m);
    for (int i = 0; i < s->r; i++) {
        k->w[i] = w[i];
        k->terms_w[i] = fabs(w[i]);
    }
    return NS_OK;
}

void ns_reinit_orders_free(ns_order_expansion *k) {
    ns_linalg_ranked_free(k->zero);
    ns_linalg_ranked_free(k->gap);
    free(k->K0);
    free(k->fine);
    free(k->inside);
}

/* One row of (P2) without its matrix: what is given of order 1, with the sizes of its terms. */
static double given_in_row(const ns_order_expansion *k, int i, const double *z, double *terms) {
    const ns_theta *s = k->s;
    const int n = s->s->n, m = s->s->m, pair = i < n ? 0 : k->inside[i - n];
    double sum = i < n ? s->b[i] : -s->s->e[pair];
    *terms = fabs(sum);
    for (int c = 0; z && c < s->s->nz; c++) {
        const double t = z[c] * (i < n ? s->E[i + c * n] : -s->s->F[pair + c * m]);
        sum += t;
        *terms += fabs(t);
    }
    for (int j = 0; j < m; j++) {
        const ns_mode mode = k->mode[j];
        if (mode == NS_INSIDE)
            continue;
        const double bound = mode == NS_LOWER ? s->l[j] : s->u[j];
        const double t = bound * (i < n ? s->B[i + j * n] : -s->s->D[pair + j * m]);
        sum += t;
        *terms += fabs(t);
    }
    return sum;
}

/* What is given of order h: charge flows, sources move. */
static double given_next_in_row(const ns_order_expansion *k, int i, const double *z, const double *slope) {
    const ns_theta *s = k->s;
    const int n = s->s->n, m = s->s->m;
    double sum = 0;
    if (i < s->r)
        return given_in_row(k, i, z, &sum);
    for (int c = 0; slope && c < s->s->nz; c++)
        sum += slope[c] * (i < n ? s->E[i + c * n] : -s->s->F[k->inside[i - n] + c * m]);
    return sum;
}

/* Sizes of the terms that row i of T sums up in a column. */
static double summed(const ns_theta *s, int i, const double *column) {
    double size = 0;
    for (int j = 0; j < s->s->n; j++)
        size += fabs(s->T[i + j * s->s->n] * column[j]);
    return size;
}

/* (P2) in k->mode, by powers of h. */
static void form_powers(ns_order_expansion *k, const double *z, const double *slope) {
    ns_theta *s = k->s;
    const int n = s->s->n, m = s->s->m, r = s->r;
    k->nj = 0;
    for (int j = 0; j < m; j++)
        if (k->mode[j] == NS_INSIDE)
            k->inside[k->nj++] = j;
    const int size = k->size = n + k->nj;
    for (int j = 0; j < size; j++) {
        const int pair = j < n ? 0 : k->inside[j - n];
        const double *flow = j < n ? s->A + (size_t)j * (size_t)n : s->B + (size_t)pair * (size_t)n;
        double *zero = k->K0 + (size_t)j * (size_t)size, *one = k->K1 + (size_t)j * (size_t)size;
        double *terms = k->S0 + (size_t)j * (size_t)size;
        memset(one, 0, sizeof(double) * (size_t)size);
        for (int i = 0; i < n; i++) {
            zero[i] = i >= r ? -flow[i] : j < n ? s->M[i + j * n] : 0;
            one[i] = i < r ? -flow[i] : 0;
            terms[i] =
                i < r ? fabs(zero[i])
                      : summed(s, i,
                               j < n ? s->s->A + (size_t)j * (size_t)n : s->s->B + (size_t)pair * (size_t)n);
        }
        for (int i = 0; i < k->nj; i++)
            terms[n + i] = zero[n + i] =
                j < n ? s->s->C[k->inside[i] + j * m] : s->s->D[k->inside[i] + pair * m];
    }
    for (int i = 0; i < size; i++) {
        k->R0[i] = i < r ? (double)k->w[i] : given_in_row(k, i, z, &k->terms[i]);
        if (i < r)
            k->terms[i] = k->terms_w[i];
        k->R1[i] = given_next_in_row(k, i, z, slope);
    }
}

/* All orders with all pairs. */
static void spread_to_pairs(ns_order_expansion *k) {
    const ns_theta *s = k->s;
    const int n = s->s->n, m = s->s->m;
    const double *const from[] = {k->Z1, k->Z0, k->Z2, k->E1, k->E0, k->E2};
    double *const to[] = {k->at[0], k->at[1], k->at[2], k->error[0], k->error[1], k->error[2]};
    for (int v = 0; v < 6; v++) {
        memcpy(to[v], from[v], sizeof(double) * (size_t)n);
        memset(to[v] + n, 0, sizeof(double) * (size_t)m);
        for (int i = 0; i < k->nj; i++)
            to[v][n + k->inside[i]] = from[v][n + i];
    }
    for (int j = 0; j < m; j++)
        if (k->mode[j] != NS_INSIDE)
            k->at[NS_VALUE][n + j] = k->mode[j] == NS_LOWER ? s->l[j] : s->u[j];
}

/* Instructions for a square of the size, for a cube: fitted to what callgrind counted in four circuits of
 * tests/stress, of 15 to 37 unknowns. */
static const double a_square = 2800, a_cube = 32;

int ns_reinit_orders_expand(ns_order_expansion *k, const double *z, const double *slope) {
    form_powers(k, z, slope);
    k->s->expanded += (a_square + a_cube * k->size) * k->size * k->size;
    const int status = ns_reinit_orders_solve(k);
    if (status == NS_OK)
        spread_to_pairs(k);
    return status;
}

double ns_reinit_orders_rate(ns_order_expansion *k) {
    ns_theta *s = k->s;
    const int all = s->s->n + s->s->m;
    double rate = 0;
    memset(k->mode, NS_INSIDE, (size_t)s->s->m);
    form_powers(k, NULL, NULL);
    (void)ns_linalg_lu_scale(s->lu, all, k->K0);
    const double *rows = ns_linalg_lu_rows(s->lu), *units = ns_linalg_lu_units(s->lu);
    for (int j = 0; j < all; j++) {
        int given = 0;
        for (int i = 0; i < all; i++)
            given |= k->K0[i + j * all] != 0;
        for (int i = 0; i < all && given; i++)
            rate = fmax(rate, rows[i] * fabs(k->K1[i + j * all]) * units[j]);
    }
    return rate;
}
