/* src/theta/undetermined.c - what the equations of a mode leave open, named in the fault of a step. */
#include <stdlib.h>

#include "linalg/null.h"
#include "theta_internal.h"

static const double most = 0.3; /* of the heaviest weight: what is named */

/* The heaviest that is left, of those next to the heaviest of all; -1: none. */
static int take_heaviest(int size, double *weight, double *heaviest) {
    int best = -1;
    for (int i = 0; i < size; i++)
        if (weight[i] > (best < 0 ? most * *heaviest : weight[best]))
            best = i;
    if (best < 0)
        return -1;
    *heaviest = *heaviest > 0 ? *heaviest : weight[best];
    weight[best] = 0;
    return best;
}

void ns_theta_name_undetermined(ns_theta *s, double h, int implicit) {
    const int n = s->s->n, size = n + ns_theta_map_matrix(s, h, implicit, s->trial.mode);
    ns_fault *f = &s->fault;
    double heaviest = 0, *weight = malloc(sizeof *weight * ((size_t)size + 1));
    f->npairs = f->nunknowns = 0;
    (void)ns_linalg_lu_factor(s->lu, size, s->K, NULL, NULL); /* for its scaling */
    if (!weight || ns_linalg_null_weights(size, s->K, ns_linalg_lu_rows(s->lu), ns_linalg_lu_units(s->lu),
                                          weight) != NS_OK) {
        free(weight);
        return;
    }
    for (int i; f->npairs + f->nunknowns < NS_FAULT_MAX && (i = take_heaviest(size, weight, &heaviest)) >= 0;)
        if (i < n)
            f->unknown[f->nunknowns++] = i;
        else
            f->pair[f->npairs++] = s->inside[i - n];
    free(weight);
}
