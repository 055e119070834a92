/* src/modes/mode.h - all values of a mode, and the one function that changes the mode of a system. */
#ifndef NS_MODES_MODE_H
#define NS_MODES_MODE_H

#include <math.h>

#include "shared_branch.h"

/* Besides NS_LOWER, NS_INSIDE and NS_UPPER (nonsmooth/mlcp.h), the modes that (P1) knows and that callers
 * see: */
enum {
    /* A switch without hysteresis keeps its control at the threshold, by a lambda and a -y that are both
     * positive (up), or both negative (down).  ns_march_mode() shows NS_INSIDE (sparse) or
     * this value (exact). */
    NS_SLIDES_UP = 2,
    NS_SLIDES_DOWN = 3,
    /* Not a mode but the target of a command: a closed switch opens, another one closes. */
    NS_TARGET_TOGGLE = 9
};

static inline int ns_mode_slides(ns_mode mode) {
    return mode == NS_SLIDES_UP || mode == NS_SLIDES_DOWN;
}

static inline ns_mode ns_mode_toggled(ns_mode mode) {
    return mode == NS_INSIDE ? NS_LOWER : NS_INSIDE;
}

/* How many guards a pair with these bounds has, and to (2): what it changes to where each of them breaks.
 * Inside: lambda - l, u - lambda, those of them that are finite; at a bound: y, or -y; sliding: lambda and
 * -y, in its direction. */
static inline int ns_mode_guards(ns_mode mode, double l, double u, ns_mode to[2]) {
    to[0] = to[1] = NS_INSIDE;
    if (ns_mode_slides(mode)) {
        to[0] = NS_LOWER;
        return 2;
    }
    if (mode != NS_INSIDE)
        return l < u;
    to[0] = isfinite(l) ? NS_LOWER : NS_UPPER;
    to[1] = NS_UPPER;
    return isfinite(l) + isfinite(u);
}

/* mode (m) = to (m; it may be mode itself), and what follows from it: pairs across closed switches are idle,
 * l, u (m) are the bounds of commanded pairs, and of pairs across switches, as the mode has the switches. */
void ns_modes_set(const ns_system *s, const ns_shared_branch *shared, int count, const ns_mode *to,
                  ns_mode *mode, double *l, double *u);

#endif
