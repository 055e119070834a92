/* src/march/run_internal.h - shared by run.c and run_handover.c. */
#ifndef NS_MARCH_RUN_INTERNAL_H
#define NS_MARCH_RUN_INTERNAL_H

#include "march_internal.h"
#include "select.h"

typedef struct ns_run {
    ns_engine engine;
    /* what is integrated */
    const ns_system *s;
    ns_system *dense_copy; /* of a large system, once the dense engines were used; then it is s */
    ns_march_options options;
    /* by what */
    ns_engine *at_work;
    int is_dense; /* which of the two kinds that is */
    /* the next hand-over to the sparse engine */
    double retry_sparse_at; /* s */
    double retry_interval;  /* s; 0: the dense engines were the first */
    int counts_modes;       /* it matters whether modes recur */
    ns_recurrence seen;     /* when that was judged last */
    /* what is told */
    ns_counts before, sum; /* of the engines that were at work before; of all */
    ns_fault fault;        /* of dense engines that could not be made */
} ns_run;

/* run_handover.c: the engine that the options ask for is made.  Errors: as ns_march_create(). */
int ns_march_run_make_engine(ns_run *r, ns_fault *fault);
/* The dense engines in place of the sparse one, before a start at t.  Errors: as ns_march_create(). */
int ns_march_run_use_dense(ns_run *r, double t);
/* The dense engines go on from the accepted point of the sparse one.  Errors: also those of a start. */
int ns_march_run_leave_sparse(ns_run *r);
/* Starts the sparse engine from the accepted point of the dense ones if it is due (retry_sparse_at), if the
 * exact engine failed too often (dense_failed: 1), or if most modes are new.  If it refuses, the dense
 * engines go on, and it is asked again later. */
void ns_march_run_try_sparse(ns_run *r, int dense_failed);

#endif
