/* src/modes/shared_branch.h - pairs across a switch: while it is closed, and has no resistance, they are
 * idle. */
#ifndef NS_MODES_SHARED_BRANCH_H
#define NS_MODES_SHARED_BRANCH_H

#include "nonsmooth/system.h"

/* A pair whose y is that of a commanded pair but for its sign and a forward drop, and whose lambda acts where
 * that one's does: with y = 0 by the switch it has y = 0 too, and lambda = 0 is as right as any share of the
 * current; with a drop it has y > 0, and lambda = 0 is the only one. */
typedef struct ns_shared_branch {
    int pair, of; /* of: the commanded pair */
    ns_mode idle; /* the bound that is zero */
} ns_shared_branch;

/* All of them, *count in *out (owned by the caller; NULL: none).  Errors: MEMORY. */
int ns_modes_shared_find(const ns_system *s, ns_shared_branch **out, int *count);

/* The same mode (m), with the pairs across closed switches idle. */
static inline void ns_modes_shared_rest(const ns_shared_branch *shared, int count, ns_mode *mode) {
    for (int i = 0; i < count; i++)
        if (mode[shared[i].of] == NS_INSIDE && mode[shared[i].pair] == NS_INSIDE)
            mode[shared[i].pair] = shared[i].idle;
}

#endif
