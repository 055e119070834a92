/* src/exact/advance.c - one step inside a mode: a kept step where no guard comes near zero, else a search for
 * where one breaks.
 */
#include "exact_internal.h"

#include "guards.h"
#include "linalg/simd.h"

#include <math.h>

/* Steps until the bound of work is looked at. */
enum { LOOKS_EVERY = 16 };

/* Short steps searched one by one that cost as much as to make long steps with samples: modes that are soon
 * left for good need none. */
static double worth_of_samples(const ns_mode_kernel *k) {
    const double r = k->r, rows = k->rows;
    return r * (5 * r + 9 * rows) / (8 * (r + rows));
}

/* The step to take next, of *h: kept, or (NULL) short ones to be searched. */
static int choose_step(ns_exact *f, ns_time_scale *scale, double rest, ns_step_map **map, double *h) {
    const ns_mode_kernel *k = scale->kernel;
    const double longest = k->h * (1 << NS_MAX_GUARDED_EXPONENT);
    int status = NS_OK;
    *map = NULL;
    *h = rest;
    if (rest < longest * 1.01 || k->rows == 0)
        status = ns_exact_step_recurring(f, scale, rest, map);
    if (*map)
        *h = (*map)->h;
    if (status != NS_OK || *map || k->rows == 0 || rest <= k->h)
        return status;
    const double left = worth_of_samples(k) - scale->searched_steps;
    if (left >= 1) {
        *h = ns_lower(rest, left * k->h);
        return NS_OK;
    }
    int exponent = 0;
    for (*h = k->h; exponent < NS_MAX_GUARDED_EXPONENT && 2 * *h <= rest; *h *= 2)
        exponent++;
    return ns_exact_step_of_length(f, scale, exponent, map);
}

/* From X over `span`, in steps of the kernel's h at most, until a guard breaks: *guard.  *done: how far X
 * came. */
static int search_span(ns_exact *f, ns_time_scale *scale, double span, double *done, int *guard) {
    const double h = scale->kernel->h;
    *done = 0;
    while (*guard < 0 && *done < span) {
        double part = ns_lower(h, span - *done), when;
        if (span - *done - part < 1e-9 * h)
            part = span - *done;
        *guard = ns_exact_event_within(f, scale, part, &when);
        scale->searched_steps++;
        if (*guard >= 0)
            part = when;
        const int status = part > 0 ? ns_exact_step_advance(f, scale, part) : NS_OK;
        if (status != NS_OK)
            return status;
        *done = *done + part >= span * (1 - 1e-15) ? span : *done + part;
    }
    return NS_OK;
}

/* A kept step, or (a guard may break in it) up to the end of the interval of samples in which it may. */
static int take_kept_step(ns_exact *f, ns_time_scale *scale, ns_step_map *map, double *done,
                          ns_exact_step *step) {
    double clear = 0;
    int status = ns_exact_step_sample(f, scale, map);
    if (status != NS_OK)
        return status;
    const int interval = map->samples > 0 ? ns_exact_event_in_step(f, scale, map, &clear) : -1;
    if (interval < 0) {
        step->map = map;
        ns_exact_long_note_kept(f, scale);
        ns_exact_step_commit(f, scale, map);
        *done = map->h;
        return NS_OK;
    }
    const double part = map->h / map->samples;
    const double skip = scale->kernel->h * floor(clear * part / scale->kernel->h);
    const double before = part * interval + skip;
    status = before > 0 ? ns_exact_step_advance(f, scale, before) : NS_OK;
    if (status == NS_OK)
        status = search_span(f, scale, part - skip, done, &step->guard);
    *done += before;
    return status;
}

/* One step of at most `rest`; *done: how far X came. */
static int take_step(ns_exact *f, double rest, double *done, ns_exact_step *step) {
    double until, h;
    ns_step_map *map;
    ns_time_scale *scale = ns_exact_mode_time_scale(f, &until);
    const double room = until - (f->state.now.t - f->state.last_event_t);
    double most = room > 0 && room < rest ? room : rest;
    step->scale = scale;
    const int least = scale->rings ? NS_LONG_EXPONENT : NS_DYING_EXPONENT;
    const int may_be_long = scale->kernel->rows > 0 && most >= scale->kernel->h * (1 << least);
    int status = may_be_long ? ns_exact_long_step(f, scale, &most, done) : NS_OK;
    if (status != NS_OK || *done > 0)
        return status;
    status = choose_step(f, scale, most, &map, &h);
    if (status != NS_OK)
        return status;
    if (map)
        return take_kept_step(f, scale, map, done, step);
    if (scale->kernel->rows > 0)
        return search_span(f, scale, h, done, &step->guard);
    *done = h;
    return ns_exact_step_advance(f, scale, h);
}

/* X has moved on by `done`, of `rest` to t. */
static void move_clock(ns_exact *f, double t, double rest, double done) {
    ns_clock *now = &f->state.now;
    const int all = done >= rest - ns_exact_step_length_error(f, rest);
    ns_clock_advance(now, all ? t : ns_lower(t, now->t + (now->lost + done)), done);
}

void ns_exact_bound_by(ns_exact *f, ns_engine *e) {
    f->bound = e;
}

int ns_exact_is_over(const ns_exact *f) {
    return f->bound && ns_engine_is_over(f->bound);
}

int ns_exact_is_to_pause(const ns_exact *f) {
    return f->looks % LOOKS_EVERY == 0 && f->bound && f->bound->pause_work > 0 &&
           ns_engine_work(f->bound).all > f->bound->pause_work;
}

int ns_exact_advance(ns_exact *f, double t, ns_exact_step *step) {
    const double rest = t - f->state.now.t - f->state.now.lost;
    double done = 0;
    int status = NS_OK;
    *step = (ns_exact_step){.guard = NS_GUARD_NONE};
    if (f->state.steps_left-- <= 0 || (++f->looks % LOOKS_EVERY == 0 && ns_exact_is_over(f)))
        return NS_E_LIMIT;
    if (rest > 0)
        status = take_step(f, rest, &done, step);
    move_clock(f, t, rest, done);
    return status;
}
