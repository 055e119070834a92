/* src/system/partition_internal.h - shared by partition.c (what goes together) and partition_build.c (their
 * systems).
 */
#ifndef NS_SYSTEM_PARTITION_INTERNAL_H
#define NS_SYSTEM_PARTITION_INTERNAL_H

#include "partition.h"

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

#define NS_CSC_OF(s, which) ((s)->large ? &(s)->large->which : NULL)

/* Entries that are not zero, of an array or a sparse matrix (either may be NULL); of all controls' gx. */
typedef void ns_visit(void *context, int row, int column, double value);
void ns_system_each_entry(const double *dense, const ns_csc *sparse, int rows, int columns, ns_visit *visit,
                          void *context);
void ns_system_each_control(const ns_system *s, ns_visit *visit, void *context);

/* The island of unknown i, or of pair i - n; -1: known or shared.  What is known or shared together has one
 * group. */
int ns_system_plan_island(const ns_plan *p, int i);
int ns_system_plan_group(const ns_plan *p, int i);

/* partition_build.c.  Errors: MEMORY. */
int ns_system_partition_build(const ns_plan *p, int count, ns_islands *out);

#endif
