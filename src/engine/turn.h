/* src/engine/turn.h - from one mode to the next, from inside.
 *
 *   enter.c  what jumps where a mode is entered       omen.c  whether it holds from there on
 *   turn.c   which modes are asked
 */
#ifndef NS_TURN_H
#define NS_TURN_H

#include "flight.h"

/* One of the matrices of guards (stage.h) at X: guard g. */
static inline double ns_guard_of(const ns_stage *k, const double *rows, int g, const double *X) {
    double sum = 0;
    for (int j = 0; j < k->q; j++)
        sum += rows[j + g * k->q] * X[j];
    return sum;
}

/* enter.c: f->next = X, as the mode is entered with it; 1 if it jumps: then whether the impulses of the pairs
 * have the signs they may have, and if not the guard whose has it least. */
int ns_enter(ns_flight *f, const ns_flight_mode *k);
int ns_enter_fits(ns_flight *f, const ns_stage *k);
int ns_enter_worst(const ns_flight *f, const ns_stage *k);

/* omen.c */
/* What guard g is about to do: as its value, rate and the rate of that say; as it seems from what it comes to
 * soon, unless that is rounding that has grown, or another event was in between. */
enum { NS_SOON_RUNGS = 8 }; /* soon: so many doublings of a step away */
typedef enum ns_omen { NS_STANDS, NS_SEEMS_TO_STAND, NS_UNTOLD, NS_SEEMS_TO_BREAK, NS_BREAKS } ns_omen;

ns_omen ns_omen_of(ns_flight *f, ns_flight_mode *mode, int g, const double *X);

/* Who says that a mode holds: nobody, (P1) over a short step, the impulse problem. */
typedef enum ns_word { NS_NOBODY, NS_STEP, NS_IMPULSES } ns_word;

typedef enum ns_holding { NS_NOT, NS_HOLDS, NS_JUMPS } ns_holding; /* JUMPS: at this instant, and no longer */

/* Whether the mode holds from here on.  Where nothing can tell, it does if somebody says so, or said so when
 * it came to the same (untold). */
ns_holding ns_holds(ns_flight *f, ns_flight_mode *k, ns_word word, uint64_t untold);
/* Whether nothing jumps and all guards are so far above zero that no more need be asked. */
int ns_holds_clearly(ns_flight *f, ns_flight_mode *k);

/* turn.c: as ns_turn(), to a mode that followed before: if it holds (1), and no command by the state is
 * there; else nothing is changed but what is known of guards. */
int ns_turn_again(ns_flight *f, ns_flight_mode *to, int natural);

#endif
