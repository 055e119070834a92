/* src/exact/output_solve.c - x and lambda of a state by (P2) itself, where those of unit vectors cancel.
 *
 * The output map (output_map.c) adds up what each charge and each input makes of x and lambda.  Two ideal
 * sources of 200 V that 1e-10 ohm joins send 1e12 A each, and what is left of these is rounding.  Where coils
 * end in one floating node, their currents add up to zero, and the flux of one alone is an impulse in the
 * Euler step: L/g in that node's voltage, for a g of 1e-15 s.  So (P2) is solved for the state as a whole.  A
 * left null vector N of its matrix at g = 0 is such a constraint,
 *
 *     N_d w + N_a (what inputs are in algebraic rows) = 0,
 *
 * which the state obeys but for rounding.  Its rate, N_d (A x + B lambda + E z + b) + N_a (slopes) = 0, takes
 * the place of one row of charges: nothing is divided by g, and the rounding of the charges is not amplified.
 */
#include "linalg/residual.h"
#include "linalg/row_split.h"
#include "mode_kernel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct ns_output_rows {
    int size, inside;       /* n + pairs inside */
    int *pair, *list;       /* inside; size */
    int constraints, *row;  /* of the state: how many; the row of charges that each takes the place of */
    double *N;              /* size*constraints */
    double *K;              /* size*size: (P2) with these rows */
    double *images;         /* q*q: X -> the sum of (-1)^i D^i X, i < 8 (E1) */
    double *rhs, *y, *rest; /* size */
    double *sum;            /* q: that sum, inputs at the end of the Euler step */
    double *z, *slope;      /* nz */
    ns_lu *lu;
    double *room; /* what the arrays of numbers lie in */
};

void ns_exact_output_rows_free(ns_output_rows *o) {
    if (!o)
        return;
    ns_linalg_lu_free(o->lu);
    free(o->room);
    free(o->pair);
    free(o);
}

static ns_output_rows *allocate(const ns_theta *s, const ns_mode_kernel *k, int inside, size_t *bytes) {
    const size_t size = (size_t)s->s->n + (size_t)inside, q = (size_t)k->q, nz = (size_t)s->s->nz;
    const size_t numbers = 2 * size * size + q * q + 3 * size + q + 2 * nz;
    ns_output_rows *o = calloc(1, sizeof *o);
    if (!o)
        return NULL;
    *bytes = sizeof *o + sizeof(double) * (numbers + size * size);
    o->room = calloc(numbers + 1, sizeof *o->room);
    o->pair = calloc((size_t)inside + 2 * size + 1, sizeof *o->pair);
    if (!o->room || !o->pair || ns_linalg_lu_create((int)size, &o->lu) != NS_OK) {
        ns_exact_output_rows_free(o);
        return NULL;
    }
    o->size = (int)size;
    o->inside = inside;
    o->list = o->pair + inside;
    o->row = o->list + size;
    o->K = o->room;
    o->N = o->K + size * size;
    o->images = o->N + size * size;
    o->rhs = o->images + q * q;
    o->y = o->rhs + size;
    o->rest = o->y + size;
    o->sum = o->rest + size;
    o->z = o->sum + q;
    o->slope = o->z + nz;
    return o;
}

/* --- constraints --- */

static double largest_of_row(const ns_output_rows *o, const double *a, int i) {
    double most = 0;
    for (int j = 0; j < o->size; j++)
        most = fmax(most, fabs(a[i + j * o->size]));
    return most;
}

/* The row of charges that counts most in constraint c; -1: none does, and its rate is that of nothing. */
static int pivot_of(const ns_output_rows *o, const double *a, int r, int c) {
    static const double rounding = 1e-12;
    const double *N = o->N + (size_t)c * (size_t)o->size;
    double most = 0, all = 0;
    int best = -1;
    for (int i = 0; i < o->size; i++) {
        const double part = fabs(N[i]) * largest_of_row(o, a, i);
        all = fmax(all, part);
        if (i < r && part > most) {
            most = part;
            best = i;
        }
    }
    return most > rounding * all ? best : -1;
}

/* Constraint c no more has an entry in row p, which is that of `by`. */
static void take_out(const ns_output_rows *o, int c, int by, int p) {
    const double *from = o->N + (size_t)by * (size_t)o->size;
    double *N = o->N + (size_t)c * (size_t)o->size;
    const double f = N[p] / from[p];
    for (int i = 0; i < o->size && f != 0; i++)
        N[i] -= f * from[i];
    N[p] = 0;
}

/* a: (P2) at g = 0; T: room of as many.  Those of its left null vectors in which charges count. */
static int find_constraints(ns_output_rows *o, int r, const double *a, double *T) {
    int rank;
    const size_t size = (size_t)o->size;
    const int status = ns_linalg_row_split(o->size, a, T, &rank);
    if (status != NS_OK)
        return status;
    for (int k = rank; k < o->size; k++) {
        const int c = o->constraints;
        for (size_t i = 0; i < size; i++)
            o->N[i + (size_t)c * size] = T[(size_t)k + i * size];
        for (int b = 0; b < c; b++)
            take_out(o, c, b, o->row[b]);
        o->row[c] = pivot_of(o, a, r, c);
        o->constraints += o->row[c] >= 0;
    }
    return NS_OK;
}

/* Column j of A, or of B of a pair inside. */
static const double *column_of(const ns_theta *s, const ns_output_rows *o, int j) {
    const size_t n = (size_t)s->s->n;
    return j < s->s->n ? s->A + (size_t)j * n : s->B + (size_t)o->pair[j - s->s->n] * n;
}

static void put_rates(const ns_theta *s, const ns_output_rows *o) {
    for (int c = 0; c < o->constraints; c++) {
        const double *N = o->N + (size_t)c * (size_t)o->size;
        for (int j = 0; j < o->size; j++) {
            const double *column = column_of(s, o, j);
            double sum = 0;
            for (int i = 0; i < s->r; i++)
                sum -= N[i] * column[i];
            o->K[o->row[c] + j * o->size] = sum;
        }
    }
}

/* o->K is that of (P2): its constraints, and their rates in it. */
static int constrain(const ns_theta *s, ns_output_rows *o) {
    const size_t square = (size_t)o->size * (size_t)o->size;
    double *a = malloc(sizeof *a * (2 * square + 1));
    if (!a)
        return NS_E_MEMORY;
    memcpy(a, o->K, sizeof *a * square);
    for (int j = 0; j < o->size; j++)
        for (int i = 0; i < s->r; i++)
            a[i + j * o->size] = j < s->s->n ? s->M[i + j * s->s->n] : 0;
    const int status = find_constraints(o, s->r, a, a + square);
    free(a);
    if (status == NS_OK)
        put_rates(s, o);
    return status;
}

/* --- made --- */

void ns_exact_output_images(const ns_mode_kernel *k, const ns_input_states *e, int j, double *sum,
                            double *room) {
    const int r = k->r, nv = k->nv;
    double *image = room, *v = sum + r;
    memset(sum, 0, sizeof(double) * (size_t)k->q);
    memset(image, 0, sizeof(double) * (size_t)nv);
    sum[j] = 1;
    if (j >= r)
        image[j - r] = 1;
    double sign = -1;
    for (int order = 1; order < NS_ORDER; order++, sign = -sign) {
        const double *D = k->laguerre_powers + (order - 1) * r + (size_t)j * (size_t)(NS_ORDER * r);
        double *next = image + nv;
        for (int i = 0; i < r; i++)
            sum[i] += sign * D[i];
        if (j < r)
            continue;
        memcpy(next, image, sizeof(double) * (size_t)nv);
        ns_inputs_states_stage(e, k->g, next);
        for (int i = 0; i < nv; i++) {
            image[i] = next[i] - image[i];
            v[i] += sign * image[i];
        }
    }
}

/* room: r + 2 nv. */
static void fill_images(const ns_theta *s, const ns_input_states *e, const ns_mode_kernel *k,
                        const ns_output_rows *o, double *room) {
    const size_t r = (size_t)k->r, q = (size_t)k->q;
    for (size_t j = 0; j < q; j++)
        ns_exact_output_images(k, e, (int)j, o->images + j * q, room);
    for (size_t j = r; j < q; j++)
        if (ns_exact_kernel_leaves_off(s, k, (int)j, room))
            ns_linalg_matvec_add(k->q, k->r, o->images, k->D8 + j * r, o->images + j * q);
}

/* 1: K has digits.  Where devices leave something open it has none, and the limit of their leaks is that of
 * the map. */
static int factor(const ns_output_rows *o) {
    static const double least = 1e-14;
    double rcond;
    return ns_linalg_lu_factor(o->lu, o->size, o->K, &rcond) == NS_OK && rcond >= least;
}

static int slides(const ns_mode *mode, int m) {
    for (int j = 0; j < m; j++)
        if (ns_mode_slides(mode[j]))
            return 1;
    return 0;
}

int ns_exact_output_rows(ns_theta *s, const ns_input_states *e, ns_mode_kernel *k) {
    const int inside = ns_theta_map_matrix(s, k->g, 1, k->mode);
    size_t bytes;
    ns_theta_forget_failure(s);
    k->output_asked = 1;
    if (slides(k->mode, s->s->m)) /* its row is another one */
        return NS_OK;
    ns_output_rows *o = allocate(s, k, inside, &bytes);
    double *room = malloc(sizeof *room * ((size_t)k->r + 2 * (size_t)k->nv + 1));
    int status = o && room ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK) {
        memcpy(o->K, s->K, sizeof *o->K * (size_t)o->size * (size_t)o->size);
        memcpy(o->pair, s->inside, sizeof *o->pair * (size_t)inside);
        status = constrain(s, o);
    }
    if (status == NS_OK)
        fill_images(s, e, k, o, room);
    free(room);
    if (status != NS_OK || !factor(o)) {
        ns_exact_output_rows_free(o);
        k->output_asked = status == NS_OK;
        return status;
    }
    k->output_rows = o;
    k->bytes += bytes;
    return NS_OK;
}

/* --- used --- */

/* z and its slopes at the end of the Euler step: o->z, o->slope. */
static void find_inputs(const ns_input_states *e, const ns_output_rows *o, const double *v) {
    const int nz = e->s->nz;
    memset(o->z, 0, sizeof *o->z * 2 * (size_t)nz);
    for (int a = 0; a < e->nv; a++) {
        const double rate = ns_inputs_states_slope(e, a, v);
        for (int i = 0; i < nz; i++) {
            o->z[i] += e->Z[i + a * nz] * v[a];
            o->slope[i] += e->Z[i + a * nz] * rate;
        }
    }
}

/* What inputs z (nz), constants (`one` times) and lambda of pairs at bounds (x_lambda) add to row i. */
static double given(const ns_theta *s, const ns_output_rows *o, int i, const double *z, double one,
                    const double *lambda) {
    const int n = s->s->n, m = s->s->m, nz = s->s->nz;
    const int pair = i < n ? -1 : o->pair[i - n];
    double sum = one * (i < n ? s->b[i] : -s->s->e[pair]);
    for (int k = 0; k < nz; k++)
        sum += (i < n ? s->E[i + k * n] : -s->s->F[pair + k * m]) * z[k];
    for (int j = 0, next = 0; j < m && one != 0; j++) {
        if (next < o->inside && o->pair[next] == j)
            next++;
        else
            sum += (i < n ? s->B[i + j * n] : -s->s->D[pair + j * m]) * lambda[j];
    }
    return sum;
}

static void fill_rhs(const ns_theta *s, const ns_output_rows *o, double g, double one, const double *lambda) {
    for (int i = 0; i < o->size; i++) {
        const double of = given(s, o, i, o->z, one, lambda);
        o->rhs[i] = i < s->r ? o->sum[i] + g * of : of;
    }
    for (int c = 0; c < o->constraints; c++) {
        const double *N = o->N + (size_t)c * (size_t)o->size;
        double sum = 0;
        for (int i = 0; i < o->size; i++)
            if (N[i] != 0)
                sum += N[i] *
                       (i < s->r ? given(s, o, i, o->z, one, lambda) : given(s, o, i, o->slope, 0, lambda));
        o->rhs[o->row[c]] = sum;
    }
}

/* o->y (size) from o->rhs; 0: it does not converge. */
static int solve(const ns_output_rows *o) {
    enum { ROUNDS = 5 };
    static const double enough = 1e-13;
    const size_t bytes = sizeof *o->y * (size_t)o->size;
    memset(o->y, 0, bytes);
    memcpy(o->rest, o->rhs, bytes);
    for (int round = 0; round < ROUNDS; round++) {
        ns_linalg_lu_solve(o->lu, 1, o->rest);
        const double moved = ns_linalg_lu_largest(o->lu, o->rest);
        for (int i = 0; i < o->size; i++)
            o->y[i] += o->rest[i];
        if (moved <= enough * ns_linalg_lu_largest(o->lu, o->y))
            return 1;
        for (int i = 0; i < o->size; i++) {
            int count = 0;
            for (int j = 0; j < o->size; j++)
                if (o->K[i + j * o->size] != 0)
                    o->list[count++] = j;
            o->rest[i] = ns_linalg_residual(o->rhs[i], count, o->list, o->K + i, (size_t)o->size, o->y);
        }
    }
    return 0;
}

/* Charges are those of X to their last bits: what the sum of images is off by is added to it. */
static void keep_charges(const ns_theta *s, const ns_output_rows *o, const double *X) {
    memset(o->rest, 0, sizeof *o->rest * (size_t)o->size);
    memcpy(o->rest, X, sizeof *X * (size_t)s->r);
    for (int k = 0; k < s->stores; k++)
        o->rest[s->stored[k].charge] -= s->stored[k].value * o->y[s->stored[k].unknown];
    for (int c = 0; c < o->constraints; c++)
        o->rest[o->row[c]] = 0;
    ns_linalg_lu_solve(o->lu, 1, o->rest);
    for (int i = 0; i < o->size; i++)
        o->y[i] += o->rest[i];
}

int ns_exact_output_solve(const ns_theta *s, const ns_input_states *e, const ns_mode_kernel *k,
                          const double *X, double *x_lambda) {
    const ns_output_rows *o = k->output_rows;
    const int n = s->s->n;
    ns_linalg_matvec(k->q, k->q, o->images, X, o->sum);
    ns_inputs_states_stage(e, k->g, o->sum + k->r);
    find_inputs(e, o, o->sum + k->r);
    for (int i = 0; i < e->output_only_inputs; i++)
        o->z[e->output_only_input[i]] = X[k->q + i];
    fill_rhs(s, o, k->g, X[k->r], x_lambda + n);
    if (!solve(o))
        return 0;
    keep_charges(s, o, X);
    memcpy(x_lambda, o->y, sizeof *x_lambda * (size_t)n);
    for (int i = 0; i < o->inside; i++)
        x_lambda[n + o->pair[i]] = o->y[n + i];
    return 1;
}
