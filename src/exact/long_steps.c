/* src/exact/long_steps.c - steps longer than a ring of their mode, or than what dies in it: the amplitude of
 * that instead of its samples.
 *
 * Where every guard, freed of it, is farther above zero than it reaches, samples as close as the rest needs
 * are enough.  X itself moves by the same exact steps.
 */
#include "exact_internal.h"
#include "guards.h"
#include "linalg/simd.h"

#include <math.h>

/* Steps of h 2^k: the shortest that is longer than those with samples. */
enum { FIRST_EXPONENT = NS_MAX_GUARDED_EXPONENT + 1, LONGEST_WAIT = 8 };

_Static_assert((int)NS_LONG_STEPS > (int)NS_MAX_EXPONENT, "a place for each length");

/* 1 if every guard is farther above zero now than the fast parts reach. */
static int is_clear_now(const ns_mode_kernel *k, const ns_fast_parts *p) {
    for (int g = 0; g < k->rows; g++)
        if (!k->always_zero[g] && !(ns_exact_guard_of(k, k->value, g, p->rest) > p->bound[g]))
            return 0;
    return 1;
}

/* *done: the length of the step of h 2^exponent, if all guards hold all through it. */
static int try_step(ns_exact *f, ns_time_scale *scale, ns_fast_parts *p, int exponent, double *done) {
    const ns_mode_kernel *k = scale->kernel;
    ns_step_map **map = &p->step[exponent];
    int status = *map ? NS_OK : ns_exact_step_spaced(f, scale, exponent, p->slow_h, map);
    status = status == NS_OK ? ns_exact_step_sample(f, scale, *map) : status;
    if (status != NS_OK)
        return status;
    ns_linalg_matvec(((*map)->samples + 1) * k->rows, k->q, (*map)->sample, p->rest, f->work.guards);
    if (!ns_exact_event_samples_above(k, f->work.guards, (*map)->samples, p->bound))
        return NS_OK;
    ns_exact_step_commit(f, scale, *map);
    *done = (*map)->h;
    return NS_OK;
}

/* So many steps after an event what does not ring has died out, and they cost as much as the eigenvectors. */
static double worth_of_eigenvectors(const ns_mode_kernel *k) {
    const double r = k->r, rows = k->rows;
    return 32 + 25 * r * r * r / ((r + 9 * rows) * k->q);
}

/* 1 if a period of the sources may become one product, which is made of steps with samples alone: no guard
 * broke in the last two. */
static int may_be_product(const ns_exact *f) {
    const double period = f->past.period;
    return period > 0 && !f->state.mode->has_instant && f->state.now.t - f->past.guard_t > 2 * period;
}

void ns_exact_long_note_kept(const ns_exact *f, ns_time_scale *scale) {
    enum { PAYS = 2 };
    if (++scale->kept_steps > PAYS * worth_of_eigenvectors(scale->kernel) && scale->pays_after == 0)
        scale->pays_after = f->past.trials + 1;
}

/* How long after an event long steps begin, s; INFINITY: there are none.  Eigenvectors that cost less than
 * the steps so far are used at once, of what dies out, too, but for the first step, in which what broke is
 * near zero.  So far: up to the accepted point, so that a trial that is made again is the same. */
static double begin_of_long_steps(const ns_exact *f, const ns_time_scale *scale) {
    if (scale->pays_after > 0 && f->past.trials >= scale->pays_after && !may_be_product(f))
        return ldexp(scale->kernel->h, NS_MAX_GUARDED_EXPONENT);
    return scale->rings
               ? worth_of_eigenvectors(scale->kernel) * scale->kernel->h * (1 << NS_MAX_GUARDED_EXPONENT)
               : INFINITY;
}

static int exponent_for(const ns_mode_kernel *k, double slow_h, int most, double rest) {
    const double longest = ns_lower(rest, slow_h * (1 << NS_MAX_GUARDED_EXPONENT));
    int exponent = FIRST_EXPONENT;
    while (exponent < most && exponent < NS_MAX_EXPONENT && ldexp(k->h, exponent + 1) <= longest)
        exponent++;
    return exponent;
}

/* After a step that was taken the next may be twice as long; after a miss nobody tries for a while. */
static void note_outcome(ns_exact_long *l, int taken) {
    if (taken) {
        l->misses = 0;
        l->exponent++;
    } else {
        l->exponent = FIRST_EXPONENT;
        l->wait = 1 << l->misses;
        l->misses += 1 << (l->misses + 1) <= LONGEST_WAIT;
    }
}

/* With these parts. */
static int step_beside(ns_exact *f, ns_time_scale *scale, ns_fast_parts *p, double rest, double *done) {
    const ns_mode_kernel *k = scale->kernel;
    ns_exact_long *l = &f->past.longer[p != scale->fast];
    int status = NS_OK;
    if (l->scale != scale || l->event_t != f->state.last_event_t)
        *l = (ns_exact_long){.scale = scale, .event_t = f->state.last_event_t, .exponent = FIRST_EXPONENT};
    if (l->wait > 0 && l->wait-- > 0)
        return NS_OK;
    ns_exact_fast_split(f, k, p);
    if (is_clear_now(k, p))
        status = try_step(f, scale, p, exponent_for(k, p->slow_h, l->exponent, rest), done);
    note_outcome(l, *done > 0);
    return status;
}

int ns_exact_long_step(ns_exact *f, ns_time_scale *scale, double *rest, double *done) {
    const ns_clock *now = &f->state.now;
    *done = 0;
    const double begin = begin_of_long_steps(f, scale), since = now->t - f->state.last_event_t + now->lost;
    if (since < begin * (1 - 1e-9)) {
        *rest = ns_lower(*rest, begin - since);
        return NS_OK;
    }
    int status = scale->fast ? NS_OK : ns_exact_fast_build(f, scale);
    if (status == NS_OK && scale->fast->wider)
        status = step_beside(f, scale, scale->fast->wider, *rest, done);
    if (status == NS_OK && *done == 0 && scale->fast->count > 0)
        status = step_beside(f, scale, scale->fast, *rest, done);
    return status;
}
