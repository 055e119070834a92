/* src/linalg/sparse_pattern.h - the places of a sparse matrix that are not zero, and how KLU takes such a
 * matrix apart.
 *
 * Many matrices have the same places: of one mode, at steps of any length.  The last few patterns are kept,
 * and shared by all factors that have them.
 */
#ifndef NS_LINALG_SPARSE_PATTERN_H
#define NS_LINALG_SPARSE_PATTERN_H

#include <suitesparse/klu.h>

typedef struct ns_pattern {
    int uses;            /* of factors, and one while it is kept; the last that lets go frees it */
    int n, *start, *row; /* n+1; start[n] */
    int *from;           /* start[n]: the places in the matrix that it was taken from */
    klu_symbolic *symbolic;
} ns_pattern;

enum { NS_PATTERNS = 8 };

typedef struct ns_patterns {
    ns_pattern *kept[NS_PATTERNS];
    int next; /* the place of the next one */
} ns_patterns;

/* The pattern of the entries of a matrix (n columns, start, row) that are not zero; one use more.  NULL: no
 * memory, or, with status KLU_OK in c, a matrix so singular that no pivots exist. */
ns_pattern *ns_linalg_pattern_of(ns_patterns *all, int n, const int *start, const int *row,
                                 const double *value, klu_common *c);
/* One use less; NULL is none. */
void ns_linalg_pattern_free(ns_pattern *p, klu_common *c);
void ns_linalg_patterns_free(ns_patterns *all, klu_common *c);

#endif
