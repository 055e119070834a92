/* src/march/partition.h - marchers side by side: each island of a system on its own way.
 *
 * An island is asked for its next event once, and then flies over the events of others: these cost it no more
 * than its values there.  What has no event in common never waits for each other.
 */
#ifndef NS_MARCH_PARTITION_H
#define NS_MARCH_PARTITION_H

#include "nonsmooth/march.h"

typedef struct ns_partition_run ns_partition_run;

/* NULL in *out where the system is one island.  Otherwise as ns_march_create(), and so are the rest. */
int ns_march_partition_create(const ns_system *s, const ns_march_options *o, ns_partition_run **out,
                              ns_fault *fault);
void ns_march_partition_free(ns_partition_run *f);
int ns_march_partition_start(ns_partition_run *f, double t0, const double *w0);
int ns_march_partition_start_dc(ns_partition_run *f, double t0, int nhold, const int *hold,
                                const double *hold_x, double *x);
int ns_march_partition_try(ns_partition_run *f, double t, ns_until until, double *reached);
void ns_march_partition_drop(ns_partition_run *f); /* the trial */
int ns_march_partition_accept(ns_partition_run *f);
int ns_march_partition_read(ns_partition_run *f, double *t, double *x, double *lambda, double *y);
const ns_mode *ns_march_partition_mode(ns_partition_run *f);
int ns_march_partition_at_event(const ns_partition_run *f);
ns_method
ns_march_partition_engine(const ns_partition_run *f); /* the one furthest from exact that is at work in any */
const ns_counts *ns_march_partition_counts(ns_partition_run *f); /* sums */
const ns_fault *ns_march_partition_fault(const ns_partition_run *f);
int ns_march_partition_problem(const ns_partition_run *f, ns_mlcp *p,
                               double *h); /* of the island that failed */

#endif
