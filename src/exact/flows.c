/* src/exact/flows.c - charges and fluxes that flow in a step, summed so that what does not flow stays.
 *
 * D w of a time scale that is fast is large numbers that cancel once what is fast has died out.  Each entry
 * of the matrix of a step is rounded by itself, so hundreds of short steps would add the same error to a
 * charge that nothing reaches.  The integrals of currents and voltages over the step, J X, are rounded too;
 * but each enters the charges by the circuit's own coefficients, and takes from one what it gives to another.
 */
#include "mode_kernel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Coefficient of flow c (x, lambda, z, 1) in the rate of differential row i. */
static double coefficient(const ns_theta *s, int i, int c) {
    const int n = s->s->n, m = s->s->m, nz = s->s->nz;
    if (c < n)
        return s->A[i + c * n];
    if (c < n + m)
        return s->B[i + (c - n) * n];
    return c < n + m + nz ? s->E[i + (c - n - m) * n] : s->b[i];
}

static int is_used(const ns_theta *s, int c) {
    for (int i = 0; i < s->r; i++)
        if (coefficient(s, i, c) != 0)
            return 1;
    return 0;
}

/* Row c of z (nz: of the constant 1), by v. */
static double input_row(const ns_input_states *e, int c, const double *v) {
    double sum = 0;
    if (c == e->s->nz)
        return v[0];
    for (int a = 0; a < e->nv; a++)
        sum += e->Z[c + a * e->s->nz] * v[a];
    return sum;
}

/* by (flows*q): the flows of the Euler step, by X; v: nv. */
static void fill_first(const ns_theta *s, const ns_input_states *e, const ns_mode_kernel *k,
                       const int *column, double *by, double *v) {
    const int all = s->s->n + s->s->m;
    for (int j = 0; j < k->q; j++) {
        for (int a = 0; a < k->nv; a++)
            v[a] = k->r + a == j;
        ns_inputs_states_stage(e, k->g, v);
        for (int c = 0; c < k->flows; c++)
            by[c + j * k->flows] = column[c] < all
                                       ? k->step_x_lambda[(size_t)column[c] + (size_t)j * (size_t)all]
                                       : input_row(e, column[c] - all, v);
    }
}

/* Flows of the images D^0 ... D^7 of unit vector j; image, next: q each. */
static void fill_column(const ns_input_states *e, ns_mode_kernel *k, const double *by, int j, double *image,
                        double *next) {
    const int r = k->r, count = k->flows, width = j < r ? r : k->q; /* w does not move inputs */
    memset(image, 0, sizeof *image * (size_t)k->q);
    image[j] = 1;
    for (int i = 0; i < NS_ORDER; i++) {
        const double *D = k->laguerre_powers + i * r + (size_t)j * (size_t)(NS_ORDER * r);
        ns_linalg_matvec(count, width, by, image,
                         k->flow_powers + i * count + (size_t)j * (size_t)(NS_ORDER * count));
        memcpy(image, D, sizeof *image * (size_t)r);
        if (j < r)
            continue;
        memcpy(next, image + r, sizeof *next * (size_t)k->nv);
        ns_inputs_states_stage(e, k->g, next);
        for (int a = 0; a < k->nv; a++)
            image[r + a] = next[a] - image[r + a];
    }
}

/* 1 if no flow of the Euler step is far larger than what it moves: then its rounding would be larger too. */
static int are_moderate(const ns_theta *s, const ns_mode_kernel *k) {
    static const double most = 8;
    for (int j = 0; j < k->r; j++)
        for (int c = 0; c < k->flows; c++) {
            const double flow = k->flow_powers[(size_t)c + (size_t)j * (size_t)(NS_ORDER * k->flows)];
            for (int i = 0; i < k->r; i++)
                if (fabs(k->flow_into[i + c * k->r] * flow) * s->unit[j] > most * s->unit[i])
                    return 0;
        }
    return 1;
}

static int fill_flows(const ns_theta *s, const ns_input_states *e, ns_mode_kernel *k, const int *column) {
    const size_t q = (size_t)k->q;
    double *by = malloc(sizeof *by * (q * (size_t)k->flows + 2 * q + 1));
    if (!by)
        return NS_E_MEMORY;
    double *image = by + q * (size_t)k->flows;
    for (int c = 0; c < k->flows; c++)
        for (int i = 0; i < k->r; i++)
            k->flow_into[i + c * k->r] = k->g * coefficient(s, i, column[c]);
    fill_first(s, e, k, column, by, image);
    for (int j = 0; j < k->q; j++)
        fill_column(e, k, by, j, image, image + q);
    free(by);
    return NS_OK;
}

int ns_exact_kernel_flows(const ns_theta *s, const ns_input_states *e, ns_mode_kernel *k) {
    const int all = s->s->n + s->s->m + s->s->nz + 1;
    int *column = malloc(sizeof *column * (size_t)all);
    if (!column)
        return NS_E_MEMORY;
    k->flows = 0;
    for (int c = 0; c < all; c++)
        if (is_used(s, c))
            column[k->flows++] = c;
    const size_t flows = (size_t)k->flows, q = (size_t)k->q, r = (size_t)k->r;
    const size_t count = NS_ORDER * flows * q + r * flows;
    k->flow_powers = malloc((count + 1) * sizeof *k->flow_powers);
    int status = k->flow_powers ? NS_OK : NS_E_MEMORY;
    if (status == NS_OK) {
        k->flow_into = k->flow_powers + NS_ORDER * flows * q;
        status = fill_flows(s, e, k, column);
    }
    free(column);
    if (status != NS_OK || !are_moderate(s, k)) {
        free(k->flow_powers);
        k->flow_powers = NULL;
        return status;
    }
    k->bytes += count * sizeof *k->flow_powers;
    return NS_OK;
}

/* P: what the flows J behind it add to w. */
static void fill_moved(const ns_mode_kernel *k, double *P) {
    const double *J = P + (size_t)k->r * (size_t)k->q;
    for (int j = 0; j < k->q; j++)
        ns_linalg_matvec(k->r, k->flows, k->flow_into, J + (size_t)j * (size_t)k->flows,
                         P + (size_t)j * (size_t)k->r);
}

void ns_exact_kernel_flows_step(const ns_mode_kernel *k, double tau, double *P) {
    double b[NS_ORDER + 1], *J = P + (size_t)k->r * (size_t)k->q;
    ns_modes_laguerre_steps(tau / k->g, b);
    for (int j = 0; j < k->q; j++)
        for (int c = 0; c < k->flows; c++) {
            const double *from = k->flow_powers + c + (size_t)j * (size_t)(NS_ORDER * k->flows);
            double sum = 0;
            for (int order = NS_ORDER; order > 0; order--)
                sum += b[order] * from[(order - 1) * k->flows];
            J[c + j * k->flows] = sum; /* (E2) */
        }
    fill_moved(k, P);
}

void ns_exact_kernel_flows_compose(const ns_mode_kernel *k, const double *P2, const double *P1,
                                   const double *advance, double *P) {
    const int r = k->r, count = k->flows;
    const size_t moved = (size_t)r * (size_t)k->q;
    for (int j = 0; j < k->q; j++) {
        const size_t at = moved + (size_t)j * (size_t)count;
        ns_linalg_matvec(count, r, P2 + moved, P1 + (size_t)j * (size_t)r, P + at);
        for (int c = 0; c < count; c++)
            P[at + (size_t)c] += P1[at + (size_t)c] + (j < r ? P2[at + (size_t)c] : 0);
        if (j >= r)
            ns_linalg_matvec_add(count, k->nv, P2 + moved + (size_t)r * (size_t)count,
                                 advance + (size_t)(j - r) * (size_t)k->nv, P + at);
    }
    fill_moved(k, P);
}
