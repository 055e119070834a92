/* src/march/partition_internal.h - shared by partition_run.c and partition_advance.c. */
#ifndef NS_MARCH_PARTITION_INTERNAL_H
#define NS_MARCH_PARTITION_INTERNAL_H

#include "march_internal.h"
#include "partition.h"
#include "system/partition.h"

typedef struct ship {
    ns_march *march;
    const ns_island *island;
    double kept, live; /* of the accepted point; of the last trial */
    int at_event;      /* the accepted point is the left side of one */
    int tried, passes; /* an event where it stands */
    double seen;       /* up to here it was looked ahead: */
    int event;         /* there is one right there, or none so far */
} ship;

struct ns_partition_run {
    const ns_system *s;
    ns_islands islands;
    ship *ship;
    double *numbers, *x, *lambda, *y; /* n, m, m: of one island */
    ns_mode *mode;                    /* m */
    unsigned char *seen;              /* n */
    double kept, live;
    int started, has_trial, at_event;
    int failed; /* the ship that did, -1: none */
    double asked;
    ns_until until;
    ns_counts counts;
    ns_fault fault;
};

/* A failure of a ship, or of none: keeps what it says, in indices of the whole; returns the status. */
int ns_march_partition_fail(ns_partition_run *f, int ship, int status);
int ns_march_partition_fail_here(ns_partition_run *f, int status);

#endif
