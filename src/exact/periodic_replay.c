/* src/exact/periodic_replay.c - a period taken as the one before: as one product, or with its known events,
 * which spares the search for modes.
 *
 * From one known event to the next the engine steps as ever (advance.c); the mode that followed in the period
 * before is only checked (guard_sign.c).  If it does not hold, or a guard breaks elsewhere, the period is
 * given up and the point is that at its begin.
 */
#include "mode_selection.h"

#include "guards.h"
#include "linalg/simd.h"

#include <math.h>
#include <string.h>

/* To the end of a step, t at the latest; *guard: what breaks there. */
static int reaches_end(ns_exact *f, const ns_period_step *s, double t, int *guard) {
    ns_exact_step step = {.guard = NS_GUARD_NONE};
    int status = NS_OK;
    while (status == NS_OK && step.guard < 0 && f->state.now.t < t)
        status = ns_exact_advance(f, t, &step);
    *guard = step.guard;
    return status == NS_OK && (step.guard >= 0) == (s->guard >= 0);
}

/* The event there, into the mode of the next step, with inputs v after an instant known ahead. */
static int passes_event(ns_exact *f, const ns_period_step *s, int guard, ns_exact_mode *to, const double *v) {
    if (s->event)
        memcpy(f->X + f->s->r, v, sizeof *v * (size_t)f->inputs->nv);
    const int holds = ns_exact_select_known(f, to, s->event ? NS_GUARD_NONE : guard);
    f->state.last_event_t = f->state.now.t;
    return holds;
}

/* The first instant at or after the end of step i, in a period from begin to end. */
static double instant_after(const ns_period *period, int i, double begin, double end) {
    while (!period->step[i].event)
        i++;
    return i + 1 < period->steps ? begin + period->step[i].end : end;
}

/* The steps of a period from here to t; 0: an event differs, and nothing is changed. */
static int repeat_steps(ns_exact *f, const ns_period *period, double t) {
    const ns_exact_state begin = f->state;
    const ns_counts counts = f->counts;
    const size_t nv = (size_t)f->inputs->nv, bytes = sizeof *f->X * ((size_t)f->s->r + nv);
    int same = 1, guard;
    memcpy(period->X_before, f->X, bytes);
    for (int i = 0; i < period->steps && same; i++) {
        const ns_period_step *s = &period->step[i];
        const int next = i + 1 < period->steps ? i + 1 : 0;
        same = reaches_end(f, s, instant_after(period, i, begin.now.t, t), &guard) &&
               passes_event(f, s, guard, period->step[next].mode, period->v + (size_t)next * nv);
    }
    if (!same) {
        memcpy(f->X, period->X_before, bytes);
        f->state = begin;
        f->counts = counts;
    }
    return same;
}

/* 1 if all guards hold, at and between all samples of the period. */
static int guards_hold(const ns_exact *f, const ns_period *period) {
    const double *s = period->work;
    memcpy(period->work, period->cg, sizeof *period->work * (size_t)period->rows);
    ns_linalg_matvec_add(period->rows, period->r, period->G, f->X, period->work);
    for (int i = 0; i < period->parts; i++) {
        const ns_period_part *p = &period->part[i];
        if (!ns_exact_event_samples_hold(s, p->rows, p->samples))
            return 0;
        s += (size_t)p->rows * ((size_t)p->samples + 1);
    }
    return 1;
}

/* The period from here to t as a product; 0: a guard comes near zero, and nothing is changed. */
static int multiply_period(ns_exact *f, const ns_period *period, double t) {
    if (!guards_hold(f, period))
        return 0;
    memcpy(period->work, period->c, sizeof *period->c * (size_t)period->r);
    ns_linalg_matvec_add(period->r, period->r, period->P, f->X, period->work);
    memcpy(f->X, period->work, sizeof *period->work * (size_t)period->r);
    ns_exact_note_size(f);
    ns_clock_advance(&f->state.now, t, period->steps_length);
    f->counts.steps++;
    return 1;
}

/* A period begins here, and all of it is before t. */
static int is_due(const ns_exact *f, double t) {
    const ns_period *period = f->record.period;
    const double now = f->state.now.t, same = ns_exact_same_instant(f);
    if (!period || f->state.mode != period->mode || fabs(f->state.now.lost) > same ||
        now < f->record.retry_at || now + period->duration >= t - same)
        return 0;
    const double k = rint((now - period->from) / period->duration);
    return f->state.last_event_t == now && fabs(now - (period->from + k * period->duration)) <= same;
}

int ns_exact_period_replay(ns_exact *f, double t) {
    enum { MAX_REFUSED = 3, PAUSE = 64 };
    ns_period_record *l = &f->record;
    const ns_period *period = l->period;
    if (!is_due(f, t))
        return 0;
    const double now = f->state.now.t;
    const double end = period->from + (rint((now - period->from) / period->duration) + 1) * period->duration;
    const int open = l->open;
    const long dropped = f->cache.steps_dropped;
    l->open = 0; /* nothing of it is recorded */
    if (!(period->steps > 0 ? repeat_steps(f, period, end) : multiply_period(f, period, end))) {
        if (++l->refused > MAX_REFUSED)
            l->retry_at = now + (PAUSE - 0.5) * period->duration;
        l->open = open && f->cache.steps_dropped == dropped;
        return 0;
    }
    l->refused = 0;
    ns_inputs_events_skip(f->events, end, period->duration);
    f->counts.events += period->events;
    f->counts.predicted += period->events;
    f->replayed += period->events;
    f->counts.periods++;
    return 1;
}
