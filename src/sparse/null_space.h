/* src/sparse/null_space.h - what (P2) leaves open, and what it asks of its right-hand side, in a mode whose
 * matrix K is singular: its null spaces, found by inverse iteration with the factors of K with leaks.
 */
#ifndef NS_SPARSE_NULL_SPACE_H
#define NS_SPARSE_NULL_SPACE_H

#include "assemble.h"
#include "linalg/dense.h"
#include "linalg/sparse_lu.h"

/* Vectors are in the units of ns_sparse_leaks_find(): of length 1 and at right angles to each other. */
typedef struct ns_null_space {
    int count;     /* its dimension */
    double *right; /* count vectors (size): K v = 0 */
    double *left;  /* count vectors (size): l K = 0, so l r = 0 wherever K v = r has a solution */
    ns_lu *shares; /* of left G right, G the leaks; NULL: leaks do not settle all of it */
} ns_null_space;

/* What searches need: the pattern of K, transposed. */
typedef struct ns_null_search ns_null_search;

int ns_sparse_null_search_create(const ns_form *f, ns_null_search **out); /* Errors: MEMORY, SINGULAR */
void ns_sparse_null_search_free(ns_null_search *s);                       /* NULL is allowed */

/* K in one mode for one length g, and factors of it with leaks. */
typedef struct ns_sparse_leaks {
    const ns_form *f;
    double g;
    const ns_mode *mode;
    const double *scale, *unit, *leak; /* size, size, m: of ns_sparse_leaks_find() */
    ns_klu *klu;
    ns_factors *factors;
} ns_sparse_leaks;

/* The null space of K, to be freed; of dimension 0 where K is only close to singular.  Errors: MEMORY,
 * SINGULAR, NUMBER (it was not found). */
int ns_sparse_null_find(ns_null_search *s, const ns_sparse_leaks *k, ns_null_space **out);
void ns_sparse_null_free(ns_null_space *z); /* NULL is allowed */

/* Takes out of r (size) what no v gives: then K v = r has a solution. */
void ns_sparse_null_make_solvable(const ns_sparse_leaks *k, const ns_null_space *z, double *r);

/* Of v (size), a solution, what K leaves open becomes what the leaks make of it. */
void ns_sparse_null_settle(const ns_sparse_leaks *k, const ns_null_space *z, double *v);

#endif
