/* src/verify/sizes.c - how large numbers were so far, and what they may be off by. */
#include "verify_internal.h"

#include <float.h>
#include <math.h>

/* y and lambda: of the largest that they had, and of the largest of all pairs. */
static const double of_largest = 1e-5, of_all = 1e-6;
/* What nobody looks at: V, A. */
static const double least_y = 1e-12, least_lambda = 1e-15;
/* Rows of (S1): what solvers leave of their terms.  Of the largest number that there is: its rounding, and
 * leaks. */
static const double of_law = 1e-8, of_number = 1e-12, leaks = 1e-10;
/* Charges and fluxes: of their largest terms; of the one of the largest energy; errors of so many steps. */
static const double of_charge = 1e-6, of_energy = 1e-9, steps = 10;

void ns_verify_sizes_numbers(ns_verify *v, const double *u) {
    const int count = v->s->n + v->s->m + v->s->nz;
    double most = v->most_number;
    for (int i = 0; i < count; i++)
        most = ns_verify_larger(fabs(u[i]), most);
    v->most_number = most;
}

void ns_verify_sizes_charges(ns_verify *v, const double *u) {
    for (int k = 0; k < v->storeds; k++) {
        const int i = v->stored[k];
        const double size = ns_verify_row(&v->charge, i, u).size;
        v->most_w[i] = ns_verify_larger(size, v->most_w[i]);
        v->most_energy = ns_verify_larger(size / v->unit[i], v->most_energy);
    }
}

double ns_verify_sizes_charge_off(const ns_verify *v, int i) {
    return v->times *
               ((of_charge + steps * v->o.reltol) * v->most_w[i] + of_energy * v->most_energy * v->unit[i] +
                of_number * v->most_number * v->charge.size[i]) +
           DBL_MIN;
}

double ns_verify_sizes_law_off(const ns_verify *v, int i) {
    return v->times * (of_law * v->most_law[i] + of_number * v->most_number * v->law.size[i]) + DBL_MIN;
}

double ns_verify_sizes_y_off(const ns_verify *v, int j) {
    return v->times * (of_largest * v->most_y[j] + of_all * v->most_any_y +
                       ns_verify_sizes_leak(v, &v->output, j) + least_y);
}

double ns_verify_sizes_lambda_off(const ns_verify *v, int j) {
    return v->times * (of_largest * v->most_lambda[j] + of_all * v->most_any_lambda + least_lambda);
}

double ns_verify_sizes_leak(const ns_verify *v, const ns_verify_rows *r, int i) {
    return leaks * v->most_number * r->size[i];
}

double ns_verify_sizes_rounding_around(const ns_verify *v, int j) {
    double most = 0;
    for (int i = 0; i < v->s->n; i++)
        for (int k = v->law.start[i]; k < v->law.start[i + 1]; k++)
            if (v->law.column[k] == v->s->n + j)
                most = ns_verify_larger(ns_verify_sizes_leak(v, &v->law, i) / fabs(v->law.value[k]), most);
    return v->times * most;
}
