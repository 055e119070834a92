/* src/exact/guard_sign.c - whether a mode holds from here on: what its guards are about to do. */
#include "mode_selection.h"

#include <math.h>

/* f->ahead: X after flying on for h 2^k in this level of a mode.  Errors: MEMORY, kept in f->status. */
static int fly_ahead(ns_exact *f, ns_time_scale *level, int k, const double *X) {
    const ns_mode_kernel *stage = level->stage;
    ns_step_map *leg;
    const int status = ns_exact_step_of_length(f, level, k, &leg);
    if (status != NS_OK) {
        f->status = status;
        return status;
    }
    ns_exact_step_apply(stage, leg, X, f->ahead);
    return NS_OK;
}

ns_guard_sign ns_exact_guard_sign(ns_exact *f, ns_exact_mode *mode, int g, const double *X) {
    const ns_mode_kernel *k = mode->level[0].stage;
    if (k->idle[g])
        return NS_SIGN_HOLDS;
    const double value = ns_exact_guard_of(k, k->value, g, X), rate = ns_exact_guard_of(k, k->rate, g, X);
    const double tol = ns_exact_guard_rounding_at(f, k, g, rate);
    if (fabs(value) > tol + fabs(rate) * f->slack)
        return value < 0 ? NS_SIGN_BREAKS : NS_SIGN_HOLDS;
    const double bend = ns_exact_guard_of(k, k->bend, g, X);
    if (k->g * (fabs(rate) - 2 * fabs(bend) * f->slack) > 8 * tol) /* it is known as well as the instant is */
        return rate < 0 ? NS_SIGN_BREAKS : NS_SIGN_HOLDS;
    if (fabs(bend) * k->g * k->g > 64 * tol)
        return bend < 0 ? NS_SIGN_BREAKS : NS_SIGN_HOLDS;
    double start = 0;
    for (int i = 0; i < mode->levels; i++) {
        ns_time_scale *level = ns_exact_mode_reach(f, mode, i);
        const double until = i + 1 < mode->levels ? mode->level[i + 1].from : INFINITY;
        if (!level)
            break;
        k = level->stage;
        const double noise = ns_exact_guard_rounding(f, k, g);
        double h = k->h;
        for (int rung = 0; rung <= NS_SOON_RUNGS && h <= until; rung++, h *= 2) {
            if (start > h || fly_ahead(f, level, rung, X) != NS_OK)
                continue;
            const double then = ns_exact_guard_of(k, k->value, g, f->ahead);
            if (fabs(then) > 4 * noise)
                return then < 0 ? NS_SIGN_SEEMS_TO_BREAK : NS_SIGN_SEEMS_TO_HOLD;
        }
        start = until;
    }
    return NS_UNDECIDED;
}

static uint64_t bit_of(int g) {
    return g < 64 ? (uint64_t)1 << g : 0;
}

ns_mode_verdict ns_exact_mode_holds(ns_exact *f, ns_exact_mode *k, ns_evidence word, uint64_t untold) {
    const ns_mode_kernel *stage = k->level[0].stage;
    double *value = f->guards, *tol = value + 2 * stage->rows;
    f->untold = 0;
    const int jumps = ns_exact_enter(f, k);
    if (jumps && word != NS_EVIDENCE_IMPULSES && !ns_exact_enter_fits(f, stage))
        return NS_VERDICT_NO;
    ns_exact_guard_values(f, stage, f->next, value, tol);
    for (int g = 0; g < stage->pair_rows; g++) {
        if (stage->idle[g] || value[g] > tol[g])
            continue;
        const ns_guard_sign is = ns_exact_guard_sign(f, k, g, f->next);
        const int sure = word == NS_EVIDENCE_NONE || (k == f->at && g == f->broken); /* that one did */
        const int told = word != NS_EVIDENCE_NONE || (untold & bit_of(g));
        f->untold |= is == NS_UNDECIDED ? bit_of(g) : 0;
        if (is == NS_SIGN_BREAKS || (is == NS_SIGN_SEEMS_TO_BREAK && sure) || (is == NS_UNDECIDED && !told))
            return jumps && word == NS_EVIDENCE_STEP ? NS_VERDICT_JUMPS : NS_VERDICT_NO;
    }
    return NS_VERDICT_HOLDS;
}

int ns_exact_mode_holds_clearly(ns_exact *f, ns_exact_mode *k) {
    const ns_mode_kernel *stage = k->level[0].stage;
    double *value = f->guards, *tol = value + 2 * stage->rows;
    if (ns_exact_enter(f, k))
        return 0;
    f->untold = 0;
    ns_exact_guard_values(f, stage, f->next, value, tol);
    for (int g = 0; g < stage->pair_rows; g++)
        if (!stage->idle[g] && !(value[g] > tol[g]))
            return 0;
    return 1;
}
