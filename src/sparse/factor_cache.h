/* src/sparse/factor_cache.h - (P2) of modes, factored, kept and solved. */
#ifndef NS_SPARSE_FACTOR_CACHE_H
#define NS_SPARSE_FACTOR_CACHE_H

#include "assemble.h"
#include "equivalent_mode.h"
#include "linalg/sparse_lu.h"
#include "low_rank_update.h"

/* Of one mode and one length of implicit Euler step. */
typedef struct ns_cached_factors ns_cached_factors;
struct ns_cached_factors {
    double g;
    int leaky;     /* the matrix is singular, these are its factors with leaks, */
    double *scale; /* 2 size: and what brings its rows, and unknowns, near 1 (NULL: never needed) */
    unsigned long long key;
    ns_mode *mode; /* m */
    ns_factors *factors;
    size_t bytes;
    long used;               /* when */
    ns_cached_factors *next; /* of its bucket */
    ns_low_rank *update;     /* of a scratch one: the mode it serves may differ from its own */
};

enum { NS_CACHE_BUCKETS = 256, NS_SEEN = 4096, NS_SCRATCH = 3 };

/* Factors serve modes that differ in a few pairs as well (low_rank_update.h): a few scratch ones for short
 * steps, and for long ones, each of one length, are made over when too many differ; or, if the mode and the
 * length are asked for again, new ones are made for them and kept. */
typedef struct ns_mode_factors {
    const ns_form *f;
    ns_klu *klu;
    double *value;  /* of K */
    double *work;   /* 3 size */
    int *row;       /* m: work */
    double *seen_v; /* of it: how large the unknowns were of late */
    ns_cached_factors *bucket[NS_CACHE_BUCKETS];
    ns_cached_factors scratch[2][NS_SCRATCH];
    ns_low_rank update[2][NS_SCRATCH];
    ns_cached_factors *last[2];       /* of scratch: asked for last, or NULL */
    ns_equivalents stand_ins;         /* of the mode asked for last */
    unsigned long long seen[NS_SEEN]; /* what was asked for, */
    unsigned char times[NS_SEEN];     /* and how often updates served it */
    size_t bytes, limit;
    int chosen; /* pivots for all modes were looked for */
    long clock, made, evicted, updated;
} ns_mode_factors;

int ns_sparse_factors_create(const ns_form *f, size_t limit,
                             ns_mode_factors **out); /* Errors: MEMORY, SINGULAR */
void ns_sparse_factors_free(ns_mode_factors *q);     /* NULL is allowed */

/* Pairs across switches, whose modes then share factors.  Errors: MEMORY. */
int ns_sparse_factors_shared(ns_mode_factors *q, const ns_shared_branch *twin, int count);

/* Factors of the mode asked for and this length, good until the next call; brief: 1 for short steps, that
 * pass by.  Errors: MEMORY, NUMBER, SINGULAR (even with leaks). */
int ns_sparse_factors_factor(ns_mode_factors *q, double g, const ns_mode *asked, int brief,
                             const ns_cached_factors **out);

/* v = K^-1 r.  Where K is singular: the limit of vanishing leaks.  Errors: SINGULAR (the equations contradict
 * each other; v is then what small leaks make of them). */
int ns_sparse_factors_solve(ns_mode_factors *q, const ns_cached_factors *k, const double *r, double *v);

#endif
