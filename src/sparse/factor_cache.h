/* src/sparse/factor_cache.h - factors of (P2), by mode and length of step. */
#ifndef NS_SPARSE_FACTOR_CACHE_H
#define NS_SPARSE_FACTOR_CACHE_H

#include "assemble.h"
#include "equivalent_mode.h"
#include "linalg/sparse_lu.h"
#include "low_rank_update.h"
#include "modes/mode_table.h"
#include "regularise.h"

/* Factors of (P2) in one mode, for one length h of implicit Euler steps. */
typedef struct ns_cached_factors {
    ns_mode_entry of; /* which mode and length */
    ns_factors *factors;
    int has_leaks; /* the matrix is singular: these are factors with leaks, */
    double *scale; /* 2 (n+m): what brings its rows and unknowns near 1, and m: the leaks; NULL: it never
                      was singular */
    ns_null_known *null; /* what is known of its null space, or NULL */
    ns_low_rank *update; /* of working factors: to the mode they serve now; NULL: they are kept */
    long used;           /* of working factors: when, on the clock */
} ns_cached_factors;

enum { NS_SEEN = 4096, NS_WORKING = 6 };

/* Factors serve modes that differ in a few pairs as well (low_rank_update.h).  So there are a few working
 * factors, for short steps and for long ones, each of one length; new ones are made in their place when too
 * many pairs differ. A mode and length that is asked for again and again gets factors of its own, which are
 * kept. */
typedef struct ns_mode_factors {
    const ns_form *f;
    ns_klu *klu;
    int has_pivots; /* klu knows pivots for all modes */
    /* factors */
    ns_mode_table kept;
    ns_cached_factors working[2][NS_WORKING]; /* of long, and of short steps */
    ns_low_rank update[2][NS_WORKING];
    ns_cached_factors *last[2]; /* of working: asked for last, or NULL */
    ns_equivalents equivalents; /* of the mode asked for last */
    /* what was asked for */
    unsigned long long seen[NS_SEEN]; /* keys of modes and lengths, by their hash */
    unsigned char times[NS_SEEN];     /* how often each, up to a bound */
    double *seen_v;                   /* n+m: how large the unknowns were of late */
    /* work */
    double *value;          /* of K */
    double *work;           /* 2 (n+m) */
    ns_null_search *search; /* of null spaces, or NULL */
    int *row;               /* m */
    /* counts */
    long clock, made, evicted, updated;
    long leaky_solves; /* solutions by factors with leaks, in rounds and Krylov cycles */
} ns_mode_factors;

int ns_sparse_factors_create(const ns_form *f, size_t limit,
                             ns_mode_factors **out); /* limit: bytes.  Errors: MEMORY, SINGULAR */
void ns_sparse_factors_free(ns_mode_factors *q);     /* NULL is allowed */

/* Modes that differ by pairs across switches (count) share factors from now on.  Errors: MEMORY. */
int ns_sparse_factors_shared(ns_mode_factors *q, const ns_shared_branch *shared, int count);

/* Factors of the mode asked for and the length g, valid until the next call; brief: 1 for steps of negligible
 * length, 0 for long ones.  Errors: MEMORY, NUMBER, SINGULAR (even with leaks). */
int ns_sparse_factors_factor(ns_mode_factors *q, double g, const ns_mode *asked, int brief,
                             const ns_cached_factors **out);

/* v = K^-1 r.  Where K is singular: the limit of vanishing leaks.  Errors: SINGULAR (the equations contradict
 * each other; v is then what small leaks make of them). */
int ns_sparse_factors_solve(ns_mode_factors *q, const ns_cached_factors *k, const double *r, double *v);

/* The same of what rounding left of a right-hand side: what contradicts the equations in it is rounding too.
 */
int ns_sparse_factors_correct(ns_mode_factors *q, const ns_cached_factors *k, const double *rest, double *v);

#endif
