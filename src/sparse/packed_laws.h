/* src/sparse/packed_laws.h - the laws of all pairs in a mode, packed to be checked in one pass. */
#ifndef NS_SPARSE_PACKED_LAWS_H
#define NS_SPARSE_PACKED_LAWS_H

#include "assemble.h"

enum { NS_LAW_TERMS = 2 };

/* Of pair j: constant + sum of by v[at] must not be negative.  Laws with more terms, with inputs or with two
 * bounds are among the others. */
typedef struct ns_packed_laws {
    int count;        /* pairs */
    int *at;          /* NS_LAW_TERMS count */
    double *by;       /* NS_LAW_TERMS count */
    double *constant; /* count */
    int *other;       /* count */
    int others;
} ns_packed_laws;

int ns_sparse_laws_create(int pairs, ns_packed_laws *k); /* Errors: MEMORY */
void ns_sparse_laws_free(ns_packed_laws *k);

/* The laws of this mode, with these bounds (m each). */
void ns_sparse_laws_set(ns_packed_laws *k, const ns_form *f, const ns_mode *mode, const double *l,
                        const double *u);

/* 1 if none is negative at v; the others are not checked. */
int ns_sparse_laws_hold(const ns_packed_laws *k, const double *v);

#endif
