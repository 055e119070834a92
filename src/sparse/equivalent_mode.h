/* src/sparse/equivalent_mode.h - modes that differ only in which pair of a branch carries the current.
 *
 * While a switch is open and a pair across it (shared_branch.h), which has no resistance, conducts, (P2) is
 * that of the closed switch, with its lambda that of the pair, but for signs.  So the same factors serve
 * both, and where a diode takes over from its switch nothing is factored.
 */
#ifndef NS_SPARSE_EQUIVALENT_MODE_H
#define NS_SPARSE_EQUIVALENT_MODE_H

#include "assemble.h"
#include "modes/shared_branch.h"

typedef struct ns_equivalent {
    int pair, of;     /* of: the switch */
    ns_mode idle;     /* of the pair */
    double y, lambda; /* 1 or -1: those of the switch over those of the pair */
} ns_equivalent;

typedef struct ns_equivalents {
    int m, n, count;
    ns_equivalent *all; /* count */
    int *active;        /* those that apply to the mode asked for last, */
    int active_count;   /* so many */
    ns_mode *mode;      /* m */
    double *r;          /* n + m */
} ns_equivalents;

/* Of these pairs across switches.  Errors: MEMORY. */
int ns_sparse_equivalent_create(const ns_form *f, const ns_shared_branch *shared, int count,
                                ns_equivalents *s);
void ns_sparse_equivalent_free(ns_equivalents *s);

/* The mode (m) whose factors serve this one: itself, or one that is valid until the next call. */
const ns_mode *ns_sparse_equivalent_mode(ns_equivalents *s, const ns_mode *mode);

/* The right-hand side r of (P2) for that mode: r itself, or one that is valid until the next call; its
 * solution v made that of the mode asked for. */
const double *ns_sparse_equivalent_right(ns_equivalents *s, const double *r);
void ns_sparse_equivalent_back(const ns_equivalents *s, double *v);

#endif
