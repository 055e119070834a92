/* src/march/select.h - which engine a run uses: decisions only, nothing is changed. */
#ifndef NS_MARCH_SELECT_H
#define NS_MARCH_SELECT_H

#include "march_internal.h"
#include "sparse/sparse.h"

/* 1 if a large system has too many unknowns and pairs to be written out as dense matrices. */
int ns_march_too_large(const ns_system *s);

/* 1 if the run is to begin with the sparse engine; then its options. */
int ns_march_begins_sparse(const ns_system *s, const ns_march_options *o, ns_sparse_options *sparse);
/* The options of the sparse engine's own steps of high order. */
ns_sparse_options ns_march_sparse_options(const ns_march_options *o);

/* 1 if what the sparse engine failed with is worth a try by the dense engines. */
int ns_march_leaves_sparse(const ns_system *s, const ns_march_options *o, int status);

/* 1 if the system is so large that it matters whether its modes recur. */
int ns_march_counts_modes(const ns_system *s);
/* 1 if of the events since *seen most came to modes that matrices had to be made for; then, or after enough
 * events, *seen becomes now. */
int ns_march_modes_do_not_recur(const ns_recurrence *now, ns_recurrence *seen);

/* How long the sparse engine is not tried again, after it was left (before: 0 or what this returned last), s.
 */
double ns_march_retry_interval(const ns_march_options *o, double before);

#endif
