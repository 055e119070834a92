/* src/exact/mode_selection.h - from one mode to the next, from inside.
 *
 *   mode_entry.c  what jumps where a mode is entered       guard_sign.c  whether it holds from there on
 *   mode_selection.c   which modes are asked
 */
#ifndef NS_EXACT_MODE_SELECTION_H
#define NS_EXACT_MODE_SELECTION_H

#include "exact_internal.h"

/* mode_entry.c: f->next = X, as the mode is entered with it; 1 if it jumps: then whether the impulses of the
 * pairs have the signs they may have, and if not the guard whose has it least. */
int ns_exact_enter(ns_exact *f, const ns_exact_mode *k);
int ns_exact_enter_fits(ns_exact *f, const ns_mode_kernel *k);
int ns_exact_enter_worst(const ns_exact *f, const ns_mode_kernel *k);

/* guard_sign.c */
/* What guard g is about to do: as its value, rate and the rate of that say; as it seems from what it comes to
 * soon, unless that is rounding that has grown, or another event was in between. */
enum { NS_SOON_RUNGS = 8 }; /* soon: so many doublings of a step away */
typedef enum ns_guard_sign {
    NS_SIGN_HOLDS,
    NS_SIGN_SEEMS_TO_HOLD,
    NS_UNDECIDED,
    NS_SIGN_SEEMS_TO_BREAK,
    NS_SIGN_BREAKS
} ns_guard_sign;

ns_guard_sign ns_exact_guard_sign(ns_exact *f, ns_exact_mode *mode, int g, const double *X);

/* Who says that a mode holds: nobody, (P1) over a short step, the impulse problem. */
typedef enum ns_evidence { NS_EVIDENCE_NONE, NS_EVIDENCE_STEP, NS_EVIDENCE_IMPULSES } ns_evidence;

typedef enum ns_mode_verdict {
    NS_VERDICT_NO,
    NS_VERDICT_HOLDS,
    NS_VERDICT_JUMPS
} ns_mode_verdict; /* JUMPS: at this instant, and no longer */

/* Whether the mode holds from here on.  Where nothing can tell, it does if somebody says so, or said so when
 * it came to the same (untold). */
ns_mode_verdict ns_exact_mode_holds(ns_exact *f, ns_exact_mode *k, ns_evidence word, uint64_t untold);
/* Whether nothing jumps and all guards are so far above zero that no more need be asked. */
int ns_exact_mode_holds_clearly(ns_exact *f, ns_exact_mode *k);

/* mode_selection.c: as ns_exact_select_mode(), to a mode that followed before: if it holds (1), and no
 * command by the state is there; else nothing is changed but what is known of guards. */
int ns_exact_select_known(ns_exact *f, ns_exact_mode *to, int natural);

#endif
