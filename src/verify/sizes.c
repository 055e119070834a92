/* src/verify/sizes.c - how large numbers were so far, and what they may be off by. */
#include "verify_internal.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* y and lambda: of the largest that they had, and of the largest of all pairs. */
static const double of_largest = 1e-4, of_all = 1e-5;
/* What a control may be beyond its threshold, of the largest that it was: events close together count as one.
 */
static const double of_control = 1e-3;
/* What nobody looks at: V, A. */
static const double least_y = 1e-12, least_lambda = 1e-15;
/* Rows of (S1): what solvers leave of their terms.  Of the largest number that there is: its rounding, and
 * leaks. */
static const double of_law = 1e-5, of_number = 1e-12, leaks = 1e-10;
/* Charges and fluxes: of their largest terms; of the one of the largest energy; errors of so many steps. */
static const double of_charge = 1e-5, of_energy = 1e-9, steps = 100;

void ns_verify_sizes_numbers(ns_verify *v, const double *u) {
    const int count = v->s->n + v->s->m + v->s->nz;
    double most = 0;
    for (int i = 0; i < count; i++)
        most = ns_verify_larger(fabs(u[i]), most);
    ns_verify_grow(v, &v->most_any[NS_VERIFY_ANY_NUMBER], most);
}

void ns_verify_sizes_charge(ns_verify *v, int i, double size) {
    if (!(size > v->most_w[i]))
        return;
    ns_verify_grow(v, &v->most_w[i], size);
    ns_verify_grow(v, &v->most_any[NS_VERIFY_ANY_ENERGY], size / v->unit[i]);
}

double ns_verify_most_charge(const ns_verify *v, int i) {
    return v->most_w[i];
}

static void loosen(ns_verify *v, ns_verify_finding *f) {
    if (f->pair >= 0)
        v->is_loose_pair[f->pair] = 1;
    if (f->unknown >= 0)
        v->is_loose_row[f->unknown] = 1;
    v->quick.is_old = 1;
    *f = ns_verify_nothing(f->t);
}

int ns_verify_sizes_end(ns_verify *v, ns_verify_finding *worst) {
    if (worst->cause != NS_VERIFY_RIGHT && worst->error <= ns_verify_wrong)
        loosen(v, worst);
    const int right = worst->cause == NS_VERIFY_RIGHT;
    if (v->grew && right) {
        memcpy(v->kept, v->most_law, sizeof *v->kept * ns_verify_sizes(v->s));
        v->quick.is_old = 1;
    } else if (v->grew)
        memcpy(v->most_law, v->kept, sizeof *v->kept * ns_verify_sizes(v->s));
    v->grew = 0;
    return right;
}

double ns_verify_sizes_charge_off(const ns_verify *v, int i) {
    return ns_verify_sizes_charge_off_of(v, i, v->most_w[i]);
}

double ns_verify_sizes_charge_off_of(const ns_verify *v, int i, double most) {
    return v->times * v->times_row[i] *
               ((of_charge + steps * v->o.reltol) * most +
                of_energy * v->most_any[NS_VERIFY_ANY_ENERGY] * v->unit[i] +
                ns_verify_sizes_leak(v, &v->charge, i)) +
           DBL_MIN;
}

double ns_verify_sizes_law_off(const ns_verify *v, int i) {
    return v->times * v->times_row[i] *
               (of_law * v->most_law[i] + of_number * v->most_any[NS_VERIFY_ANY_NUMBER] * v->law.size[i]) +
           DBL_MIN;
}

double ns_verify_sizes_held_off(const ns_verify *v, double value) {
    return of_law * fabs(value) + of_number * v->most_any[NS_VERIFY_ANY_NUMBER];
}

double ns_verify_sizes_y_off(const ns_verify *v, int j) {
    return v->times * v->times_pair[j] *
           (of_largest * v->most_y[j] + of_all * v->most_any[NS_VERIFY_ANY_Y] +
            ns_verify_sizes_leak(v, &v->output, j) + least_y);
}

double ns_verify_sizes_lambda_off(const ns_verify *v, int j) {
    return v->times * v->times_pair[j] *
           (of_largest * v->most_lambda[j] + of_all * v->most_any[NS_VERIFY_ANY_LAMBDA] + least_lambda);
}

double ns_verify_sizes_leak(const ns_verify *v, const ns_verify_rows *r, int i) {
    return leaks * v->most_any[NS_VERIFY_ANY_NUMBER] * r->size[i];
}

double ns_verify_sizes_rounding_around(const ns_verify *v, int j) {
    double most = 0;
    for (int i = 0; i < v->s->n; i++)
        for (int k = v->law.start[i]; k < v->law.start[i + 1]; k++)
            if (v->law.column[k] == v->s->n + j)
                most = ns_verify_larger(ns_verify_sizes_leak(v, &v->law, i) / fabs(v->law.value[k]), most);
    return v->times * v->times_pair[j] * most;
}

double ns_verify_sizes_control_off(const ns_verify *v, int c) {
    const ns_command *k = &v->s->command[c];
    return of_control * ns_verify_larger(v->most_control[c], ns_verify_larger(fabs(k->on), fabs(k->off))) +
           of_number * v->most_any[NS_VERIFY_ANY_NUMBER] * v->control.size[c];
}
