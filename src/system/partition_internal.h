/* src/system/partition_internal.h - shared by partition.c (which belong to one island) and partition_build.c
 * (the islands' systems). */
#ifndef NS_SYSTEM_PARTITION_INTERNAL_H
#define NS_SYSTEM_PARTITION_INTERNAL_H

#include "each_entry.h"
#include "partition.h"
#include "union_find.h"

/* The role of an unknown: of one island; known as a function of time (its row is a balance); in a balance
 * only, where each island has a part of it (its row is the law of a known one). */
enum { NS_OWN, NS_KNOWN, NS_SHARED };

typedef struct ns_plan {
    const ns_system *s;
    unsigned char *bytes; /* the block that the next four are in */
    int *ints;            /* the block of those below */
    /* of rows and unknowns, n each */
    unsigned char *role;    /* NS_OWN, ... */
    unsigned char *lawless; /* rows with charges or pairs */
    unsigned char *matters; /* unknowns with a charge, or that a guard or a control sees */
    unsigned char *barred;  /* rows that are not taken for laws */
    int *count, *last;      /* of a row: how many unknowns are not known, and the last of them */
    int *law;               /* of a known unknown: the row that determines it */
    /* of unknowns and pairs, n+m each */
    int *of;     /* union-find */
    int *number; /* of a top: its island */
    int retry;   /* rows were barred: roles are to be found anew */
} ns_plan;

/* The group that unknown i, or pair i - n, is in: known and shared unknowns form groups of
 * their own. */
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
