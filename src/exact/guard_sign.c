/* src/exact/guard_sign.c - whether a mode holds from here on: what its guards are about to do. */
#include "mode_selection.h"

#include "events/ties.h"
#include "guards.h"
#include "linalg/simd.h"
#include "modes/multiple.h"

#include <math.h>

/* work.X_ahead: X after a step of h 2^k.  Errors: MEMORY, kept in f->failed. */
static int step_ahead(ns_exact *f, ns_time_scale *scale, int k, const double *X) {
    const ns_mode_kernel *kernel = scale->kernel;
    ns_step_map *map;
    const int status = ns_exact_step_of_length(f, scale, k, &map);
    if (status != NS_OK) {
        f->failed = status;
        return status;
    }
    ns_exact_step_apply(f, kernel, map, X, f->work.X_ahead);
    return NS_OK;
}

/* By the value of guard g some steps ahead. */
static ns_guard_sign look_ahead(ns_exact *f, ns_exact_mode *mode, int g, const double *X) {
    double start = 0;
    for (int i = 0; i < mode->scales; i++) {
        ns_time_scale *scale = ns_exact_mode_reach(f, mode, i);
        const double until = i + 1 < mode->scales ? mode->scale[i + 1].from : INFINITY;
        if (!scale)
            break;
        const ns_mode_kernel *k = scale->kernel;
        const double noise = ns_exact_guard_rounding(f, k, g);
        double h = k->h;
        for (int exponent = 0; exponent <= NS_SOON_EXPONENT && h <= until; exponent++, h *= 2) {
            if (start > h || step_ahead(f, scale, exponent, X) != NS_OK)
                continue;
            const double then = ns_exact_guard_of(k, k->value, g, f->work.X_ahead);
            if (fabs(then) > 4 * noise)
                return then < 0 ? NS_SIGN_SEEMS_TO_BREAK : NS_SIGN_SEEMS_TO_HOLD;
        }
        start = until;
    }
    return NS_UNDECIDED;
}

/* What guard g of mode k changes by in time (s) where the mode before goes on so much longer. */
static double change_before(ns_exact *f, const ns_exact_mode *mode, int g, double time) {
    const ns_mode_kernel *k = mode->scale[0].kernel;
    ns_time_scale *before = f->state.mode->scale;
    double *by = f->work.X_ahead;
    if (step_ahead(f, before, 0, f->X) != NS_OK)
        return INFINITY;
    for (int j = 0; j < k->q; j++)
        by[j] -= f->X[j];
    if (mode->has_instant)
        ns_exact_enter_less(f, k, by);
    return time / before->kernel->h * fabs(ns_exact_guard_of(k, k->value, g, by));
}

/* The time (s), of `error` at most, by which the instant of the event may be off for a guard of this rate.  A
 * rate that the mode before did not have, and that is gone within that time, begins with the event, whenever
 * that is: the guard is off by what the mode before changes it by. */
static double known_to(ns_exact *f, const ns_exact_mode *mode, int g, double rate, double lasts,
                       double error) {
    if (error <= lasts || !f->state.mode)
        return error;
    return fmin(error, fmax(lasts, change_before(f, mode, g, error) / fabs(rate)));
}

ns_guard_sign ns_exact_guard_sign(ns_exact *f, ns_exact_mode *mode, int g, const double *X) {
    const ns_mode_kernel *k = mode->scale[0].kernel;
    if (k->always_zero[g])
        return NS_SIGN_HOLDS;
    ns_guard of = {ns_exact_guard_of(k, k->value, g, X), ns_exact_guard_of(k, k->rate, g, X), 0, 0};
    const double rounding = ns_exact_rounding_of_time(f), lasts = ns_exact_guard_lasts(f, k, g, X, of.rate);
    const double of_time = ns_lower(rounding, lasts);
    double error = fmax(ns_exact_time_error_of(f, k, g) - rounding, 0) + of_time;
    of.rounding = ns_exact_guard_rounding_at(f, k, g, X, 0) + of_time * fabs(of.rate);
    ns_guard_sign sign = ns_events_value_sign(&of, error);
    if (sign == NS_UNDECIDED) {
        error = known_to(f, mode, g, of.rate, lasts, error);
        sign = ns_events_value_sign(&of, error);
    }
    if (sign == NS_UNDECIDED) {
        of.second_rate = ns_exact_guard_of(k, k->second_rate, g, X);
        sign = ns_events_rate_sign(&of, error, k->g);
    }
    return sign == NS_UNDECIDED ? look_ahead(f, mode, g, X) : sign;
}

static void forget_judgement(ns_exact *f) {
    f->undecided = f->overruled = 0;
    f->late = 0;
}

/* f->late, by a guard of this value and rate. */
static void note_late(ns_exact *f, const ns_mode_kernel *k, int g, double value, double rate) {
    if (value < 0 && rate > 0 && value < -ns_exact_guard_rounding_at(f, k, g, f->X_next, 0))
        f->late = ns_higher(f->late, -value / rate);
}

static ns_mode_verdict judge_mode(ns_exact *f, ns_exact_mode *k, ns_evidence evidence, uint64_t undecided) {
    const ns_mode_kernel *kernel = k->scale[0].kernel;
    double *value = f->work.values, *tol = value + 2 * kernel->rows;
    ns_mode_verdict verdict = NS_VERDICT_HOLDS;
    forget_judgement(f);
    const int jumps = ns_exact_enter(f, k);
    if (jumps && evidence != NS_EVIDENCE_IMPULSES && !ns_exact_enter_fits(f, kernel))
        return NS_VERDICT_NO;
    ns_exact_guard_values(f, kernel, f->X_next, value, tol);
    for (int g = 0; g < kernel->pair_rows; g++) {
        if (kernel->always_zero[g] || value[g] > tol[g])
            continue;
        const ns_guard_sign sign = ns_exact_guard_sign(f, k, g, f->X_next);
        const int sure =
            evidence == NS_EVIDENCE_NONE || (k == f->state.mode && g == f->event_guard); /* it did break */
        const int assumed = evidence != NS_EVIDENCE_NONE || (undecided & ns_exact_bit_of(g));
        f->undecided |= sign == NS_UNDECIDED ? ns_exact_bit_of(g) : 0;
        f->overruled |= sign == NS_SIGN_SEEMS_TO_BREAK ? ns_exact_bit_of(g) : 0;
        note_late(f, kernel, g, value[g], value[kernel->rows + g]);
        if (sign == NS_SIGN_BREAKS || (sign == NS_SIGN_SEEMS_TO_BREAK && sure) ||
            (sign == NS_UNDECIDED && !assumed)) {
            if (!jumps || evidence != NS_EVIDENCE_STEP || !ns_exact_enter_carries(f, kernel, g))
                return NS_VERDICT_NO;
            verdict = NS_VERDICT_JUMPS;
        }
    }
    return verdict;
}

/* What dies out in mode k as if in an instant is resolved, if the sources turn or jump before it may have. */
static void resolve_before_next(ns_exact *f, ns_exact_mode *k) {
    const double end = f->state.now.t + ldexp(f->h, -NS_EVENT_EXPONENT);
    if (k->hides && !k->resolves && ns_inputs_events_next(f->events, end) < end)
        (void)ns_exact_mode_resolve(f, k);
}

/* 1 if a closed pair with a resistance takes part in the jump: it flows through it, or it was open before.
 * Before the jump is over the current of one may fall to zero and reverse, and another pair may conduct for a
 * while. */
static int takes_time(const ns_exact *f, const ns_exact_mode *k) {
    int any = 0;
    for (int g = 0; g < f->entered->pair_rows; g++) {
        const int j = f->entered->row[g].pair;
        if (k->mode[j] == NS_INSIDE && f->ohm[j] > 0)
            any |= ns_exact_enter_carries(f, f->entered, g) || f->state.mode->mode[j] != NS_INSIDE;
    }
    return any;
}

/* 1 if a command by the state is contradicted as mode k was entered: its guard breaks at X_next. */
static int contradicts_command(ns_exact *f, ns_exact_mode *k) {
    const ns_mode_kernel *kernel = k->scale[0].kernel;
    int any = 0;
    for (int g = kernel->pair_rows; g < kernel->rows && !any; g++)
        any = ns_exact_guard_sign(f, k, g, f->X_next) == NS_SIGN_BREAKS;
    return any;
}

/* 1 if mode k does not hold where what jumps in no time has jumped, and what dies out as if in an instant has
 * not: a switch without resistance makes a node jump that an R brings back, and diodes and switches follow
 * the jump. */
static int breaks_on_the_way(ns_exact *f, ns_exact_mode *k, ns_evidence evidence, uint64_t undecided) {
    ns_exact_mode *fine = ns_exact_mode_fine(f, k);
    return fine &&
           (judge_mode(f, fine, evidence, undecided) == NS_VERDICT_NO || contradicts_command(f, fine));
}

/* 1 if mode k, which does not hold at f->X_next, held until its fast parts had died out; what they moved is
 * too little to count as a jump.  So a leak ends in L/roff, and then its diode conducts. */
static int holds_for_an_instant(ns_exact *f, ns_exact_mode *k, ns_evidence evidence) {
    const ns_mode_kernel *kernel = k->scale[0].kernel;
    ns_exact_mode *fine = ns_exact_mode_fine(f, k);
    const int holds = fine && judge_mode(f, fine, evidence, 0) == NS_VERDICT_HOLDS;
    (void)ns_exact_enter(f, k);
    ns_exact_guard_values(f, kernel, f->X_next, f->work.values, f->work.values + 2 * kernel->rows);
    return holds;
}

/* 1 if mode k holds at f->X_next, but a guard is below zero as soon as its fast parts have died out.  The
 * value of a guard at tau = 0 includes these parts, the sum of the first terms of (E1) does not. */
static int breaks_when_it_is_over(const ns_exact *f, const ns_exact_mode *k) {
    const ns_mode_kernel *kernel = k->scale[0].kernel;
    for (int g = 0; g < kernel->pair_rows && k->hides && !k->resolves; g++) {
        double sum = ns_exact_guard_term(kernel, g, 0, kernel->q, f->X_next);
        if (kernel->always_zero[g] || sum >= 0)
            continue;
        for (int i = 1; i < NS_ORDER; i++)
            sum += ns_exact_guard_term(kernel, g, i, kernel->q, f->X_next);
        const double noise = ns_exact_guard_rounding_at(f, kernel, g, f->X_next, 0);
        if (sum < -noise && ns_exact_guard_of(kernel, kernel->value, g, f->X_next) > noise)
            return 1;
    }
    return 0;
}

/* The verdict on mode k, which is entered without a jump: where what it hides decides, that is resolved. */
static ns_mode_verdict judge_without_jump(ns_exact *f, ns_exact_mode *k, ns_evidence evidence,
                                          uint64_t undecided, ns_mode_verdict verdict) {
    const int goes_on = f->state.mode && f->state.mode->resolves; /* what the mode before follows */
    const int decides = verdict == NS_VERDICT_HOLDS ? breaks_when_it_is_over(f, k) : goes_on;
    if (decides && ns_exact_mode_resolve(f, k))
        return judge_mode(f, k, evidence, undecided);
    return verdict == NS_VERDICT_NO && evidence == NS_EVIDENCE_STEP && f->state.mode &&
                   holds_for_an_instant(f, k, evidence)
               ? NS_VERDICT_JUMPS
               : verdict;
}

/* A jump that has a finite rate is resolved where pairs may open and close on its way: another mode follows
 * there, or other charges are left.  At a start any pair may. */
ns_mode_verdict ns_exact_mode_holds(ns_exact *f, ns_exact_mode *k, ns_evidence evidence, uint64_t undecided) {
    ns_exact_mode_coarsen(f, k);
    resolve_before_next(f, k);
    if (f->resolves)
        (void)ns_exact_mode_resolve(f, k);
    ns_mode_verdict verdict = judge_mode(f, k, evidence, undecided);
    if (!k->hides || k->resolves)
        return verdict;
    if (!f->entered)
        return judge_without_jump(f, k, evidence, undecided, verdict);
    if (f->state.mode && !takes_time(f, k)) {
        if (verdict == NS_VERDICT_NO)
            return verdict;
        const int carried = ns_exact_enter_fits(f, k->scale[0].kernel); /* not if IMPULSES are the evidence */
        if (carried && !breaks_on_the_way(f, k, evidence, undecided))
            return judge_mode(f, k, evidence, undecided);
        f->resolves = 1;
    }
    if (ns_exact_mode_resolve(f, k))
        verdict = judge_mode(f, k, evidence, undecided);
    return verdict;
}

int ns_exact_mode_holds_clearly(ns_exact *f, ns_exact_mode *k) {
    resolve_before_next(f, k);
    const ns_mode_kernel *kernel = k->scale[0].kernel;
    double *value = f->work.values, *tol = value + 2 * kernel->rows;
    if (ns_exact_enter(f, k))
        return 0;
    forget_judgement(f);
    ns_exact_guard_values(f, kernel, f->X_next, value, tol);
    for (int g = 0; g < kernel->pair_rows; g++)
        if (!kernel->always_zero[g] && !(value[g] > tol[g]))
            return 0;
    return !breaks_when_it_is_over(f, k);
}

/* 1 if guard g is that of the event but for a factor and for what is rounding beside its terms: of two
 * switches with mirrored controls. */
static int is_guard_of_event(ns_exact *f, const ns_mode_kernel *k, int g) {
    const size_t q = (size_t)k->q;
    double *size = f->work.max_abs;
    for (int j = 0; j < k->q; j++)
        size[j] = j < k->r ? f->max_abs[j] : 1; /* X is among the largest */
    return f->event_guard >= k->pair_rows &&
           ns_modes_is_multiple(k->q, k->value + (size_t)g * q, k->value + (size_t)f->event_guard * q, size);
}

double ns_exact_guard_delay(ns_exact *f, const ns_mode_kernel *k, int g) {
    if (!is_guard_of_event(f, k, g))
        return INFINITY;
    const double value = ns_exact_guard_of(k, k->value, g, f->X),
                 rate = ns_exact_guard_of(k, k->rate, g, f->X);
    const double tol = ns_exact_guard_rounding_at(f, k, g, f->X, rate);
    if (value <= tol + fabs(rate) * f->state.command_time_error)
        return 0;
    const double delay = ns_events_delay(value, rate, f->h), end = f->state.now.t + delay;
    return isfinite(delay) && ns_inputs_events_next(f->events, end) > end ? delay : INFINITY;
}
