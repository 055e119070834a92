/* src/exact/advance.c - the way inside a mode: by legs where no guard comes near, looked through where one
 * does.
 */
#include "exact_internal.h"

#include "linalg/simd.h"

#include <math.h>

/* Rungs with samples are made when as many stages were looked through one by one as they cost: modes that are
 * left for good soon need none. */
static double worth(const ns_mode_kernel *k) {
    const double r = k->r, rows = k->rows;
    return r * (5 * r + 9 * rows) / (8 * (r + rows));
}

/* The step to take next: *leg, or (NULL) a short way by the series; its length. */
static int choose(ns_exact *f, ns_time_scale *level, double rest, ns_step_map **leg, double *h) {
    const ns_mode_kernel *k = level->stage;
    const double longest = k->h * (1 << NS_GUARDED);
    int status = NS_OK;
    *leg = NULL;
    *h = rest;
    if (rest < longest * 1.01 || k->rows == 0)
        status = ns_exact_step_recurring(f, level, rest, leg);
    if (*leg)
        *h = (*leg)->h;
    if (status != NS_OK || *leg || k->rows == 0 || rest <= k->h)
        return status;
    const double left = worth(k) - level->looked;
    if (left >= 1) {
        *h = ns_lower(rest, left * k->h);
        return NS_OK;
    }
    int rung = 0;
    for (*h = k->h; rung < NS_GUARDED && 2 * *h <= rest; *h *= 2)
        rung++;
    status = ns_exact_step_of_length(f, level, rung, leg);
    return status;
}

/* From X over `span`, in steps of h at most, until a guard breaks: *broke; *done: how far it came. */
static int look(ns_exact *f, ns_time_scale *level, double span, double *done, int *broke) {
    const double h = level->stage->h;
    *done = 0;
    *broke = 0;
    while (!*broke && *done < span) {
        double part = ns_lower(h, span - *done), when;
        if (span - *done - part < 1e-9 * h)
            part = span - *done;
        *broke = ns_exact_watch_near(f, level, part, &when);
        level->looked++;
        if (*broke)
            part = when;
        const int status = part > 0 ? ns_exact_step_advance(f, level, part) : NS_OK;
        if (status != NS_OK)
            return status;
        *done = *done + part >= span * (1 - 1e-15) ? span : *done + part;
    }
    return NS_OK;
}

/* One step of at most `rest`; *done: how far it came. */
static int advance(ns_exact *f, double rest, double *done, ns_exact_step *step) {
    double until, h;
    ns_step_map *leg;
    ns_time_scale *level = ns_exact_mode_time_scale(f, &until);
    const double room = until - (f->t - f->since);
    int status = choose(f, level, room > 0 && room < rest ? room : rest, &leg, &h);
    if (status != NS_OK)
        return status;
    step->level = level;
    if (!leg && level->stage->rows == 0) {
        *done = h;
        return ns_exact_step_advance(f, level, h);
    }
    if (!leg)
        return look(f, level, h, done, &step->broke);
    double clear = 0;
    status = ns_exact_step_sample(f, level, leg);
    if (status != NS_OK)
        return status;
    const int doubt = leg->samples > 0 ? ns_exact_watch_step(f, level, leg, &clear) : -1;
    if (doubt < 0) {
        step->leg = leg;
        ns_exact_step_commit(f, level, leg);
        *done = h;
        return NS_OK;
    }
    const double part = h / leg->samples, skip = level->stage->h * floor(clear * part / level->stage->h);
    const double before = part * doubt + skip;
    double more = 0;
    status = before > 0 ? ns_exact_step_advance(f, level, before) : NS_OK;
    if (status == NS_OK)
        status = look(f, level, part - skip, &more, &step->broke);
    *done = before + more;
    return status;
}

/* X has moved on by `done`, of `rest` to t.  Steps of one length round t off in the same way each time, which
 * would add up. */
static void arrive(ns_exact *f, double t, double rest, double done) {
    const double from = f->t;
    f->t = done >= rest - ns_exact_step_slack(f, rest) ? t : ns_lower(t, from + (f->time_lost + done));
    f->time_lost += (from - f->t) + done;
}

int ns_exact_advance(ns_exact *f, double t, ns_exact_step *step) {
    const double rest = t - f->t - f->time_lost;
    double done = 0;
    int status = NS_OK;
    *step = (ns_exact_step){0};
    if (f->budget-- <= 0)
        return NS_E_LIMIT;
    if (rest > 0)
        status = advance(f, rest, &done, step);
    arrive(f, t, rest, done);
    return status;
}
