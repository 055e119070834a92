/* src/engine/sparse_factors.h - (P2) of modes, factored, kept and solved. */
#ifndef NS_SPARSE_FACTORS_H
#define NS_SPARSE_FACTORS_H

#include "../linalg/sparse_lu.h"
#include "sparse_form.h"
#include "sparse_stand_in.h"
#include "sparse_update.h"

/* Of one mode and one length of implicit Euler step. */
typedef struct ns_kept ns_kept;
struct ns_kept {
    double g;
    int leaky;     /* the matrix is singular, these are its factors with leaks, */
    double *scale; /* 2 size: and what brings its rows, and unknowns, near 1 (NULL: never needed) */
    unsigned long long key;
    ns_mode *mode; /* m */
    ns_factors *factors;
    size_t bytes;
    long used;         /* when */
    ns_kept *next;     /* of its bucket */
    ns_update *update; /* of a scratch one: the mode it serves may differ from its own */
};

enum { NS_KEPT_BUCKETS = 256, NS_SEEN = 4096, NS_SCRATCH = 3 };

/* Factors serve modes that differ in a few pairs as well (sparse_update.h): a few scratch ones for short
 * steps, and for long ones, each of one length, are made over when too many differ; or, if the mode and the
 * length are asked for again, new ones are made for them and kept. */
typedef struct ns_modal {
    const ns_form *f;
    ns_klu *klu;
    double *value;  /* of K */
    double *work;   /* 3 size */
    int *row;       /* m: work */
    double *seen_v; /* of it: how large the unknowns were of late */
    ns_kept *bucket[NS_KEPT_BUCKETS];
    ns_kept scratch[2][NS_SCRATCH];
    ns_update update[2][NS_SCRATCH];
    ns_kept *last[2];                 /* of scratch: asked for last, or NULL */
    ns_stand_ins stand_ins;           /* of the mode asked for last */
    unsigned long long seen[NS_SEEN]; /* what was asked for, */
    unsigned char times[NS_SEEN];     /* and how often updates served it */
    size_t bytes, limit;
    int chosen; /* pivots for all modes were looked for */
    long clock, made, evicted, updated;
} ns_modal;

int ns_modal_create(const ns_form *f, size_t limit, ns_modal **out); /* Errors: MEMORY, SINGULAR */
void ns_modal_free(ns_modal *q);                                     /* NULL is allowed */

/* Pairs across switches, whose modes then share factors.  Errors: MEMORY. */
int ns_modal_twins(ns_modal *q, const ns_twin *twin, int count);

/* Factors of the mode asked for and this length, good until the next call; brief: 1 for short steps, that
 * pass by.  Errors: MEMORY, NUMBER, SINGULAR (even with leaks). */
int ns_modal_factor(ns_modal *q, double g, const ns_mode *asked, int brief, const ns_kept **out);

/* v = K^-1 r.  Where K is singular: the limit of vanishing leaks.  Errors: SINGULAR (the equations contradict
 * each other; v is then what small leaks make of them). */
int ns_modal_solve(ns_modal *q, const ns_kept *k, const double *r, double *v);

#endif
