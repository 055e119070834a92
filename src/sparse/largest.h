/* src/sparse/largest.h - the largest charges, fluxes, currents and voltages so far: errors and guards are
 * judged beside them. */
#ifndef NS_SPARSE_LARGEST_H
#define NS_SPARSE_LARGEST_H

#include "sparse_internal.h"

/* Nothing known; w and D w of a step taken in, returns the largest of all in units; lambda and y
 * at v of a step of that exponent taken in, then kept for later ones; saved, or restored. */
void ns_sparse_largest_reset(ns_sparse *m);
double ns_sparse_largest_w(ns_sparse *m, const ns_dense_step *step);
void ns_sparse_largest_guards(ns_sparse *m, const double *v, int exponent);
/* The same where a step ends after a part of its first Euler step, tau: what it is there by two stages.  A
 * steep edge of a source goes far beyond its end in that Euler step. */
double ns_sparse_largest_part(ns_sparse *m, const ns_dense_step *step, double tau);
/* lasts: the step takes time. */
void ns_sparse_largest_accept(ns_sparse *m, int exponent, int lasts);
void ns_sparse_largest_save(ns_sparse *m, ns_sparse_largest *to);
void ns_sparse_largest_restore(ns_sparse *m, const ns_sparse_largest *from);

/* The largest charge or flux that there is or was, in units; of those in `of`. */
double ns_sparse_largest_size(const ns_sparse *m);
double ns_sparse_largest_of(const ns_sparse *m, const double *of);
/* In units, what is rounding of the largest constant of a law, of a source, of an input: where no charge or
 * flux was ever larger there are none. */
double ns_sparse_largest_rounding(const ns_sparse *m);

#endif
