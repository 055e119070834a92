/* src/sparse/equivalent_mode.h - modes that are one but for who carries a current.
 *
 * A switch that is open while a pair across it (shared_branch.h), which has no resistance, conducts: (P2) is
 * that of the closed switch, whose lambda is the pair's, but for signs.  So factors of the one serve the
 * other, and where a diode takes over from its switch nothing is factored.
 */
#ifndef NS_SPARSE_EQUIVALENT_MODE_H
#define NS_SPARSE_EQUIVALENT_MODE_H

#include "assemble.h"
#include "modes/shared_branch.h"

typedef struct ns_equivalent {
    int pair, of;     /* of: the switch */
    ns_mode idle;     /* of the pair */
    double y, lambda; /* signs: those of the switch are so many times the pair's */
} ns_equivalent;

typedef struct ns_equivalents {
    int m, n, count;
    ns_equivalent *all; /* count */
    int *now, nows;     /* those that take part in the mode asked for last */
    ns_mode *mode;      /* m */
    double *r;          /* n + m */
} ns_equivalents;

/* Of these twins.  Errors: MEMORY. */
int ns_sparse_equivalent_create(const ns_form *f, const ns_shared_branch *twin, int count, ns_equivalents *s);
void ns_sparse_equivalent_free(ns_equivalents *s);

/* The mode (m) whose factors serve this one: itself, or one that stays valid until the next call. */
const ns_mode *ns_sparse_equivalent_mode(ns_equivalents *s, const ns_mode *mode);

/* Right-hand sides of (P2) for that mode, itself or one that stays until the next call; its solution for the
 * mode asked for. */
const double *ns_sparse_equivalent_right(ns_equivalents *s, const double *r);
void ns_sparse_equivalent_back(const ns_equivalents *s, double *v);

#endif
