/* src/theta/undetermined.c - what the equations of a mode do not determine, named in the fault of a step. */
#include <stdlib.h>

#include "linalg/null.h"
#include "theta_internal.h"

/* An unknown is named if its weight in the null space is at least this part of the largest. */
static const double named_from = 0.3;

static int index_of_largest(int size, const double *weight) {
    int best = 0;
    for (int i = 1; i < size; i++)
        if (weight[i] > weight[best])
            best = i;
    return best;
}

void ns_theta_name_undetermined(ns_theta *s, double h, int implicit) {
    const int n = s->s->n, size = n + ns_theta_map_matrix(s, h, implicit, s->trial.mode);
    ns_fault *f = &s->fault;
    double *weight = calloc((size_t)size + 1, sizeof *weight);
    f->npairs = f->nunknowns = 0;
    (void)ns_linalg_lu_scale(s->lu, size, s->K);
    if (!weight || ns_linalg_null_weights(size, s->K, ns_linalg_lu_rows(s->lu), ns_linalg_lu_units(s->lu),
                                          weight) != NS_OK) {
        free(weight);
        return;
    }
    const double least = named_from * weight[index_of_largest(size, weight)];
    while (f->npairs + f->nunknowns < NS_FAULT_MAX) {
        const int i = index_of_largest(size, weight);
        if (!(weight[i] > 0 && weight[i] >= least))
            break;
        weight[i] = 0;
        if (i < n)
            f->unknown[f->nunknowns++] = i;
        else
            f->pair[f->npairs++] = s->inside[i - n];
    }
    free(weight);
}
