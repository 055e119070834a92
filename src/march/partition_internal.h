/* src/march/partition_internal.h - shared by partition_run.c, partition_advance.c and partition_read.c. */
#ifndef NS_MARCH_PARTITION_INTERNAL_H
#define NS_MARCH_PARTITION_INTERNAL_H

#include "march_internal.h"
#include "system/partition.h"

#include <float.h>
#include <math.h>

/* The run of one island. */
typedef struct ns_part_run {
    ns_engine *run;
    const ns_island *island;
    int shares;             /* 1: one of its unknowns is the sum of what several islands have of it */
    double accepted, trial; /* s: times of the accepted point; of the last trial */
    int at_event;           /* the accepted point is the left side of an event */
    int tried;              /* there is a trial, */
    int is_step;            /* made with NS_TO_STEP, */
    int passes;             /* or from the left side of an event to its right side */
    int lags;               /* the accepted point of the whole is on the way of that trial */
    double seen;            /* s: if it is beyond accepted, events are known up to here: */
    int event;              /* there is one right there, or none so far */
} ns_part_run;

/* Events of islands that are not further apart than this, relative to their time, are one. */
static const double ns_march_partition_same = 4 * DBL_EPSILON;

typedef struct ns_partition_run {
    ns_engine engine;
    /* what is integrated */
    const ns_system *s;
    ns_islands islands;
    ns_part_run *part; /* islands.count */
    /* values of one island, and of all */
    double *numbers, *x, *lambda, *y, *z; /* the block; n, m, m, nz */
    ns_mode *mode;                        /* m */
    unsigned char *seen;                  /* n: unknowns written so far */
    unsigned char *closed;                /* nc of an island: switches that are closed */
    /* the accepted point and the trial */
    double accepted, trial; /* s */
    int started, has_trial, at_event;
    double asked; /* s: what the last trial was asked for */
    ns_until until;
    /* what is told */
    int failed; /* the part that did, -1: none */
    ns_counts counts;
    ns_fault fault;
} ns_partition_run;

/* partition_fault.c: the fault of a part is kept, in indices of the whole; and the trial is gone, for a
 * failure of a part, or of none; returns the status. */
void ns_march_partition_keep_fault(ns_partition_run *f, int part);
int ns_march_partition_fail(ns_partition_run *f, int part, int status);
int ns_march_partition_fail_here(ns_partition_run *f, int status);

/* 1 if t is inside of the way of an island's trial, and not at its end. */
static inline int ns_march_partition_is_on_way(const ns_part_run *s, double t) {
    return s->tried && s->is_step && s->trial - t > ns_march_partition_same * fabs(t);
}

/* partition_read.c: x (n of the whole) gets f->x of an island, added to what is shared with those in f->seen.
 * And of the table. */
void ns_march_partition_put(ns_partition_run *f, int island, double *x);
int ns_march_partition_read(ns_engine *e, double *t, double *x, double *lambda, double *y);
int ns_march_partition_impulse(ns_engine *e, double *x, double *lambda);
const ns_mode *ns_march_partition_mode(ns_engine *e);
int ns_march_partition_at_event(const ns_engine *e);
ns_method ns_march_partition_method(const ns_engine *e);
int ns_march_partition_sample(ns_engine *e, double t, double *x, double *lambda);
double ns_march_partition_shortest(ns_engine *e, double t, double *until);

/* partition_advance.c: of the table. */
int ns_march_partition_try(ns_engine *e, double t, ns_until until, double *reached);
void ns_march_partition_drop(ns_engine *e);
int ns_march_partition_accept(ns_engine *e);
int ns_march_partition_set_input(ns_engine *e, int input, const ns_signal *signal);

#endif
