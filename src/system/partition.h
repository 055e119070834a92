/* src/system/partition.h - a system taken apart: islands that have in common nothing but stiff sources.
 *
 * Two converters at one ideal supply: the voltage of the supply is known whatever they do, and its current is
 * the sum of theirs.  Each island gets a copy of the supply, and the current that is its share; what else
 * hangs on the supply alone counts in one of them, its home.
 */
#ifndef NS_SYSTEM_PARTITION_H
#define NS_SYSTEM_PARTITION_H

#include "nonsmooth/system.h"

/* One: a system of its own, and what its indices are in the whole one. */
typedef struct ns_island {
    ns_system *s;
    int *unknown; /* s->n; rows of (S1) likewise */
    int *pair;    /* s->m */
    int *input;   /* s->nz */
} ns_island;

typedef struct ns_islands {
    int count; /* 0: it is all one, or not worth it */
    ns_island *island;
    unsigned char *shared; /* n: unknowns that are the sum of what islands have of them; others are alike */
} ns_islands;

enum { NS_MOST_ISLANDS = 64 };

/* Islands with pairs, where there are at least two (and at most NS_MOST_ISLANDS), and all that has none as
 * one more.  s must be checked (ns_system_check()).  Nothing is to be freed on failure.  Errors: MEMORY. */
int ns_system_partition(const ns_system *s, ns_islands *out);
void ns_system_partition_free(ns_islands *a);

#endif
