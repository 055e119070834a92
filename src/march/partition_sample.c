/* src/march/partition_sample.c - points on the way of a trial of all islands. */
#include "partition_internal.h"

#include <math.h>

int ns_march_partition_sample(ns_engine *e, double t, double *x, double *lambda) {
    ns_partition_run *f = (ns_partition_run *)(void *)e;
    (void)t;
    (void)x;
    (void)lambda;
    return ns_march_partition_fail_here(f, NS_E_STATE);
}

double ns_march_partition_shortest(ns_engine *e, double t, double *until) {
    (void)e;
    (void)t;
    *until = INFINITY;
    return NAN;
}
