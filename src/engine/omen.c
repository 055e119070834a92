/* src/engine/omen.c - whether a mode holds from here on: what its guards are about to do. */
#include "turn.h"

#include <math.h>

/* f->ahead: X after flying on for h 2^k in this level of a mode.  Errors: MEMORY, kept in f->status. */
static int fly_ahead(ns_flight *f, ns_level *level, int k, const double *X) {
    const ns_stage *stage = level->stage;
    ns_leg *leg;
    const int status = ns_leg_rung(f, level, k, &leg);
    if (status != NS_OK) {
        f->status = status;
        return status;
    }
    ns_leg_apply(stage, leg, X, f->ahead);
    return NS_OK;
}

ns_omen ns_omen_of(ns_flight *f, ns_flight_mode *mode, int g, const double *X) {
    const ns_stage *k = mode->level[0].stage;
    if (k->idle[g])
        return NS_STANDS;
    const double value = ns_guard_of(k, k->value, g, X), rate = ns_guard_of(k, k->rate, g, X);
    const double tol = ns_watch_noise_by(f, k, g, rate);
    if (fabs(value) > tol + fabs(rate) * f->slack)
        return value < 0 ? NS_BREAKS : NS_STANDS;
    const double bend = ns_guard_of(k, k->bend, g, X);
    if (k->g * (fabs(rate) - 2 * fabs(bend) * f->slack) > 8 * tol) /* it is known as well as the instant is */
        return rate < 0 ? NS_BREAKS : NS_STANDS;
    if (fabs(bend) * k->g * k->g > 64 * tol)
        return bend < 0 ? NS_BREAKS : NS_STANDS;
    double start = 0;
    for (int i = 0; i < mode->levels; i++) {
        ns_level *level = ns_flight_reach(f, mode, i);
        const double until = i + 1 < mode->levels ? mode->level[i + 1].from : INFINITY;
        if (!level)
            break;
        k = level->stage;
        const double noise = ns_watch_noise(f, k, g);
        double h = k->h;
        for (int rung = 0; rung <= NS_SOON_RUNGS && h <= until; rung++, h *= 2) {
            if (start > h || fly_ahead(f, level, rung, X) != NS_OK)
                continue;
            const double then = ns_guard_of(k, k->value, g, f->ahead);
            if (fabs(then) > 4 * noise)
                return then < 0 ? NS_SEEMS_TO_BREAK : NS_SEEMS_TO_STAND;
        }
        start = until;
    }
    return NS_UNTOLD;
}

static uint64_t bit_of(int g) {
    return g < 64 ? (uint64_t)1 << g : 0;
}

ns_holding ns_holds(ns_flight *f, ns_flight_mode *k, ns_word word, uint64_t untold) {
    const ns_stage *stage = k->level[0].stage;
    double *value = f->guards, *tol = value + 2 * stage->rows;
    f->untold = 0;
    const int jumps = ns_enter(f, k);
    if (jumps && word != NS_IMPULSES && !ns_enter_fits(f, stage))
        return NS_NOT;
    ns_watch_sight(f, stage, f->next, value, tol);
    for (int g = 0; g < stage->pair_rows; g++) {
        if (stage->idle[g] || value[g] > tol[g])
            continue;
        const ns_omen is = ns_omen_of(f, k, g, f->next);
        const int sure = word == NS_NOBODY || (k == f->at && g == f->broken); /* that one did */
        const int told = word != NS_NOBODY || (untold & bit_of(g));
        f->untold |= is == NS_UNTOLD ? bit_of(g) : 0;
        if (is == NS_BREAKS || (is == NS_SEEMS_TO_BREAK && sure) || (is == NS_UNTOLD && !told))
            return jumps && word == NS_STEP ? NS_JUMPS : NS_NOT;
    }
    return NS_HOLDS;
}

int ns_holds_clearly(ns_flight *f, ns_flight_mode *k) {
    const ns_stage *stage = k->level[0].stage;
    double *value = f->guards, *tol = value + 2 * stage->rows;
    if (ns_enter(f, k))
        return 0;
    f->untold = 0;
    ns_watch_sight(f, stage, f->next, value, tol);
    for (int g = 0; g < stage->pair_rows; g++)
        if (!stage->idle[g] && !(value[g] > tol[g]))
            return 0;
    return 1;
}
