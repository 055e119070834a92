/* src/theta/undetermined.c - what the equations of a mode do not determine, named in the fault of a step. */
#include <stdlib.h>

#include "linalg/null.h"
#include "theta_internal.h"

/* An unknown is named if its weight in the null space is at least this part of the largest. */
static const double named_from = 0.3;

/* The index of the largest weight left, if it is to be named, else -1; the weight becomes 0.  *largest: of
 * all, 0 at first. */
static int take_largest(int size, double *weight, double *largest) {
    int best = -1;
    for (int i = 0; i < size; i++)
        if (weight[i] > (best < 0 ? named_from * *largest : weight[best]))
            best = i;
    if (best < 0)
        return -1;
    *largest = *largest > 0 ? *largest : weight[best];
    weight[best] = 0;
    return best;
}

void ns_theta_name_undetermined(ns_theta *s, double h, int implicit) {
    const int n = s->s->n, size = n + ns_theta_map_matrix(s, h, implicit, s->trial.mode);
    ns_fault *f = &s->fault;
    double largest = 0, *weight = malloc(sizeof *weight * ((size_t)size + 1));
    f->npairs = f->nunknowns = 0;
    (void)ns_linalg_lu_factor(s->lu, size, s->K, NULL, NULL); /* for its scaling */
    if (!weight || ns_linalg_null_weights(size, s->K, ns_linalg_lu_rows(s->lu), ns_linalg_lu_units(s->lu),
                                          weight) != NS_OK) {
        free(weight);
        return;
    }
    for (int i; f->npairs + f->nunknowns < NS_FAULT_MAX && (i = take_largest(size, weight, &largest)) >= 0;)
        if (i < n)
            f->unknown[f->nunknowns++] = i;
        else
            f->pair[f->npairs++] = s->inside[i - n];
    free(weight);
}
