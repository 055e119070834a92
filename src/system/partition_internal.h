/* src/system/partition_internal.h - shared by partition.c (what goes together) and partition_build.c (their
 * systems).
 */
#ifndef NS_SYSTEM_PARTITION_INTERNAL_H
#define NS_SYSTEM_PARTITION_INTERNAL_H

#include "each_entry.h"
#include "partition.h"
#include "union_find.h"

/* Of an unknown: of one island; known (its row a balance); the share of one in a balance (its row a law). */
enum { NS_OWN, NS_KNOWN, NS_SHARED };

typedef struct ns_plan {
    const ns_system *s;
    unsigned char *bytes, *role; /* n */
    unsigned char *lawless;      /* n: rows with charges or pairs */
    unsigned char *matters;      /* n: unknowns with a charge, or that a guard or a control sees */
    unsigned char *barred;       /* n: rows that are not taken for laws */
    int *ints, *count, *last;    /* n: unknowns of a row that are not known, the last of them */
    int *law;                    /* n: the row that tells a known one */
    int *of, *number;            /* n+m: unknowns and pairs; the island of a top */
    int again;
} ns_plan;

/* The group that unknown i, or pair i - n, is in: what is known or shared together has one. */
static inline int ns_system_plan_group(const ns_plan *p, int i) {
    return ns_system_union_top(p->of, i);
}

/* The island of it; -1: known or shared. */
static inline int ns_system_plan_island(const ns_plan *p, int i) {
    return i < p->s->n && p->role[i] != NS_OWN ? -1 : p->number[ns_system_plan_group(p, i)];
}

/* partition_build.c.  Errors: MEMORY. */
int ns_system_partition_build(const ns_plan *p, int count, ns_islands *out);

#endif
