/* src/exact/fallback.c - for how long the ladder goes on where the exact engine cannot. */
#include "exact_internal.h"
#include "sliding.h"

#include <math.h>
#include <string.h>

int ns_exact_in_fallback(const ns_exact *f) {
    return f->point->now.t < ns_exact_fallback_until(f);
}

double ns_exact_fallback_until(const ns_exact *f) {
    return fmax(f->past.fallback_until, f->inputs->from);
}

int ns_exact_failures(const ns_exact *f) {
    return f->past.failures;
}

int ns_exact_has_no_matrices(const ns_exact *f) {
    return f->past.has_no_matrices;
}

/* For how long: four times the last stretch if the exact engine came less far since than that, or than a
 * thousandth of h (h where switches may chatter; the more failures, the more); else a quarter of it. */
static double fallback_length(const ns_exact *f, double advanced) {
    enum { MANY_EXPONENT = 10, FAILURES = 64 };
    const double h = f->h, least = ldexp(h, 2 - NS_EVENT_EXPONENT), last = f->past.fallback_length;
    const int times = 1 + f->past.failures / FAILURES;
    const double few = f->timed ? ldexp(h, -MANY_EXPONENT) * times : h;
    if (f->state.steps_left < 0)
        return h;
    return fmin(h, fmax(least, advanced < fmax(last, few) ? 4 * last : last / 4));
}

void ns_exact_fallback_start(ns_exact *f) {
    enum { LONG_EXPONENT = 6, LONG_COUNTS = 64 };
    const double advanced = f->state.now.t - f->past.fallback_until;
    if (advanced > f->h)
        f->past.failures /= 2;
    f->past.fallback_length = fallback_length(f, advanced);
    f->past.failures += f->past.fallback_length > ldexp(f->h, -LONG_EXPONENT) ? LONG_COUNTS : 1;
    f->past.fallback_until = f->state.now.t + f->past.fallback_length;
    f->past.event_count = 0;
    memcpy(f->work.mode, ns_theta_mode(f->s), (size_t)f->system->m);
    for (int c = 0; c < f->system->nc; c++) { /* the ladder has no switches that slide */
        ns_mode *mode = &f->work.mode[f->system->command[c].pair];
        if (ns_mode_slides(*mode))
            *mode = NS_LOWER;
    }
    ns_theta_set_mode(f->s, f->work.mode);
}
