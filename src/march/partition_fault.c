/* src/march/partition_fault.c - what failed in the run of an island, told of the whole. */
#include "partition_internal.h"

/* A fault of an island, in indices of the whole. */
static void translate(const ns_island *i, ns_fault *fault) {
    for (int k = 0; k < fault->npairs; k++)
        fault->pair[k] = i->pair[fault->pair[k]];
    for (int k = 0; k < fault->nunknowns; k++)
        fault->unknown[k] = i->unknown[fault->unknown[k]];
}

void ns_march_partition_keep_fault(ns_partition_run *f, int part) {
    f->fault = *ns_engine_fault(f->part[part].run);
    translate(f->part[part].island, &f->fault);
    f->failed = part;
}

int ns_march_partition_fail(ns_partition_run *f, int part, int status) {
    ns_march_partition_keep_fault(f, part);
    f->has_trial = 0;
    return status;
}

int ns_march_partition_fail_here(ns_partition_run *f, int status) {
    f->fault = (ns_fault){.status = (ns_status)status, .t = f->accepted};
    f->failed = -1;
    return status;
}
