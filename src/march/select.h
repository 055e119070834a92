/* src/march/select.h - which engine a run uses: decisions only, nothing is changed. */
#ifndef NS_MARCH_SELECT_H
#define NS_MARCH_SELECT_H

#include "choice.h"
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
/* 1 if what the dense engines failed with is worth a try by the sparse one. */
int ns_march_leaves_dense(const ns_march_options *o, int status);

/* 1 if there are two engines of which the one is taken that costs less. */
int ns_march_chooses(const ns_system *s, const ns_march_options *o);
/* After how much work (ns_work) the second one is asked; is_dense: the first one is dense. */
double ns_march_first_question(const ns_system *s, int is_dense);

/* Work that the sparse (by_sparse: 1) or the dense engines need for an event. */
ns_choice_bounds ns_march_bounds_of_event(const ns_system *s, int by_sparse);

/* How long an engine is not tried again, after it failed or was wrong (before: 0 or what this returned last),
 * s.
 */
double ns_march_retry_interval(const ns_march_options *o, double before);

#endif
