/* src/march/watched.c - thresholds that are watched: a trial ends where the first of them is crossed.
 *
 * They are found by samples of the trial, whatever engine makes it: so close together that nothing changes
 * much in between (ns_march_shortest()), and where a parabola through three of them dips below zero.
 */
#include "march_internal.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A control nearer to its threshold than this, relative to its size, is at it. */
static const double rounding = 4e-14;

struct ns_watched_thresholds {
    int count;
    ns_threshold *threshold;  /* count */
    double *x;                /* n: a sample */
    double *size;             /* count: of each control, with its thresholds: the largest so far */
    double *kept[3], *latest; /* count each: distances at samples */
    unsigned char *crossed;   /* count: at the point of the last trial, */
    int any;                  /* which some are; */
    int stopped;              /* that point is the accepted one */
};

void ns_march_watched_free(ns_march *m) {
    ns_watched_thresholds *w = m->watched;
    if (!w)
        return;
    free(w->threshold);
    free(w->x);
    free(w->crossed);
    free(w);
    m->watched = NULL;
}

/* At a point that was accepted (w->x): what swings to 5 V and back to 0 V comes there with the rounding of 5
 * V. */
static void size_up(ns_watched_thresholds *w) {
    for (int k = 0; k < w->count; k++) {
        const ns_threshold *h = &w->threshold[k];
        const double p = h->p < 0 ? 0 : w->x[h->p], n = h->n < 0 ? 0 : w->x[h->n];
        w->size[k] = fmax(w->size[k], fabs(p) + fabs(n) + fabs(h->value));
        if (k > 0 && h->p == h[-1].p && h->n == h[-1].n) /* another threshold of the same control */
            w->size[k] = w->size[k - 1] = fmax(w->size[k], w->size[k - 1]);
    }
}

/* How far each control is on its own side (below zero: beyond the threshold), to `to`. */
static void measure(const ns_watched_thresholds *w, double *to) {
    for (int k = 0; k < w->count; k++) {
        const ns_threshold *h = &w->threshold[k];
        const double p = h->p < 0 ? 0 : w->x[h->p], n = h->n < 0 ? 0 : w->x[h->n];
        const double at = rounding * fmax(w->size[k], fabs(p) + fabs(n) + fabs(h->value));
        const double border =
            h->includes ? -at : at; /* half of that for what comes to the value to stay there */
        const double above = p - n - h->value - (h->above == h->includes ? border : 0.5 * border);
        to[k] = h->above ? above : -above;
    }
}

/* Marks those below zero. */
static int mark(ns_watched_thresholds *w, const double *value) {
    w->any = 0;
    for (int k = 0; k < w->count; k++) {
        w->crossed[k] = value[k] < 0;
        w->any |= w->crossed[k];
    }
    return w->any;
}

static int allocate(ns_march *m, int count, ns_watched_thresholds *w) {
    const size_t n = (size_t)m->s->n, size = (size_t)count;
    w->threshold = calloc(size + 1, sizeof *w->threshold);
    w->x = calloc(n + 5 * size + 1, sizeof *w->x);
    w->crossed = calloc(size + 1, 1);
    for (int i = 0; w->x && i < 3; i++)
        w->kept[i] = w->x + n + (size_t)i * size;
    w->latest = w->x ? w->x + n + 3 * size : NULL;
    w->size = w->x ? w->x + n + 4 * size : NULL;
    return w->threshold && w->x && w->crossed ? NS_OK : NS_E_MEMORY;
}

static int check(const ns_march *m, int count, const ns_threshold *threshold) {
    for (int k = 0; k < count; k++) {
        const ns_threshold *h = &threshold[k];
        if (h->p < -1 || h->n < -1 || h->p >= m->s->n || h->n >= m->s->n)
            return NS_E_SIZE;
        if (!isfinite(h->value))
            return NS_E_NUMBER;
    }
    return NS_OK;
}

int ns_march_watch(ns_march *m, int count, const ns_threshold *threshold) {
    if (!m || (count > 0 && !threshold))
        return NS_E_NULL;
    int status = count < 0 ? NS_E_SIZE : check(m, count, threshold);
    if (status != NS_OK)
        return status;
    if (!m->watched || m->watched->count != count) {
        ns_watched_thresholds *w = calloc(1, sizeof *w);
        if (!w)
            return NS_E_MEMORY;
        ns_march_watched_free(m);
        m->watched = w;
        status = allocate(m, count, w);
        if (status != NS_OK) {
            ns_march_watched_free(m);
            return status;
        }
        w->count = count;
    }
    ns_watched_thresholds *w = m->watched;
    if (count > 0)
        memcpy(w->threshold, threshold, (size_t)count * sizeof *threshold);
    ns_engine_drop(m->engine);
    m->corners_from = INFINITY; /* from now on all of them count */
    status = ns_engine_read(m->engine, &m->accepted, w->x, NULL, NULL);
    if (status != NS_OK)
        return status;
    size_up(w);
    measure(w, w->latest);
    w->stopped = mark(w, w->latest);
    return NS_OK;
}

const unsigned char *ns_march_crossed(const ns_march *m) {
    return m && m->watched && m->watched->any ? m->watched->crossed : NULL;
}

/* --- the way of a trial --- */

/* The distances at t on the way of the trial, to `to`, and the least of them to *least. */
static int look_at(ns_march *m, double t, double *to, double *least) {
    ns_watched_thresholds *w = m->watched;
    const int status = ns_engine_sample(m->engine, t, w->x, NULL);
    if (t == m->accepted)
        size_up(w);
    measure(w, to);
    m->counts.looks++;
    *least = INFINITY;
    for (int k = 0; k < w->count; k++)
        *least = fmin(*least, to[k]);
    return status;
}

/* The instant between a, where the least distance is at least 0, and *b, where it is below, to rounding of
 * time: regula falsi (Illinois), with every third step a bisection.  value_b: at *b. */
static int locate(ns_march *m, double a, double value_a, double *b, double value_b) {
    enum { MOST = 200 };
    ns_watched_thresholds *w = m->watched;
    for (int i = 0; i<MOST && * b - a> 2 * DBL_EPSILON * fabs(*b); i++) {
        const double part = i % 3 == 2 ? 0.5 : value_a / (value_a - value_b);
        const double t = fmax(fmin(a + part * (*b - a), nextafter(*b, a)), nextafter(a, *b));
        double value;
        const int status = look_at(m, t, w->latest, &value);
        if (status != NS_OK)
            return status;
        if (value < 0) {
            *b = t;
            value_b = value;
            value_a *= 0.5;
        } else {
            a = t;
            value_a = value;
            value_b *= 0.5;
        }
    }
    return NS_OK;
}

/* The time of a dip below zero between three samples, by the parabola through them; NAN: there is none. */
static double find_dip(const ns_watched_thresholds *w, const double *time) {
    const double t0 = time[0], t1 = time[1], t2 = time[2];
    for (int k = 0; k < w->count; k++) {
        const double f0 = w->kept[0][k], f1 = w->kept[1][k], f2 = w->kept[2][k];
        const double first = (f1 - f0) / (t1 - t0), second = ((f2 - f1) / (t2 - t1) - first) / (t2 - t0);
        const double t = 0.5 * (t0 + t1 - first / second); /* where its slope is zero */
        if (second > 0 && t > t0 && t < t2 &&
            f0 + (t - t0) * (first + (t - t1) * second) < 0.25 * fmin(f0, fmin(f1, f2)))
            return t;
    }
    return NAN;
}

/* The last three samples, in the order of time. */
typedef struct samples {
    int known;
    double time[3], least[3];
} samples;

static int add_sample(ns_march *m, double t, samples *s) {
    ns_watched_thresholds *w = m->watched;
    if (s->known == 3) {
        double *oldest = w->kept[0];
        for (int i = 0; i < 2; i++) {
            w->kept[i] = w->kept[i + 1];
            s->time[i] = s->time[i + 1];
            s->least[i] = s->least[i + 1];
        }
        w->kept[2] = oldest;
        s->known = 2;
    }
    s->time[s->known] = t;
    const int status = look_at(m, t, w->kept[s->known], &s->least[s->known]);
    s->known++;
    return status;
}

/* Between the last samples: *to becomes the time of the first crossing, *found. */
static int search_samples(ns_march *m, const samples *s, double *to, int *found) {
    const int last = s->known - 1;
    const double dip = last == 2 ? find_dip(m->watched, s->time) : NAN;
    double least = s->least[last], in_dip = INFINITY, t = s->time[last];
    int from = last - 1;
    const int status = isnan(dip) ? NS_OK : look_at(m, dip, m->watched->latest, &in_dip);
    if (in_dip < 0) {
        least = in_dip;
        t = dip;
        from = dip > s->time[1];
    }
    *found = least < 0;
    if (status != NS_OK || !*found)
        return status;
    *to = t;
    return locate(m, s->time[from], s->least[from], to, least);
}

/* How far the control of threshold k may be from a straight line between the ends of the trial. */
static double bend(ns_march *m, int k) {
    const ns_engine *e = NS_ENGINE_FOR(m->engine, bend);
    const ns_threshold *h = &m->watched->threshold[k];
    return (h->p < 0 ? 0 : ns_engine_bend(e, h->p)) + (h->n < 0 ? 0 : ns_engine_bend(e, h->n));
}

/* Of the trial that begins with the only sample: 1 if no threshold can be crossed before its end. */
static int is_ruled_out(ns_march *m, double end, samples *s, int *status) {
    ns_watched_thresholds *w = m->watched;
    int none = 1;
    for (int k = 0; k < w->count && none; k++)
        none = bend(m, k) < INFINITY;
    if (!none)
        return 0;
    *status = add_sample(m, end, s);
    for (int k = 0; k < w->count && none && *status == NS_OK; k++)
        none = fmin(w->kept[0][k], w->kept[1][k]) >= bend(m, k);
    s->known -= !none;
    return none && *status == NS_OK;
}

/* The first crossing on the way of the trial from `from` to *to, which becomes its time; *found.  After so
 * many samples without one *to is where the last of them is: the trial ends there. */
static int find_crossing(ns_march *m, double from, double *to, int *found) {
    enum { MOST = 1000000 };
    samples s = {0};
    double t = from, until;
    int status = add_sample(m, from, &s);
    *found = status == NS_OK && s.least[0] < 0;
    if (*found) { /* what is algebraic jumps where a source turns */
        *to = fmin(*to, from + 4 * DBL_EPSILON * fabs(from) + DBL_MIN);
        return NS_OK;
    }
    if (status == NS_OK && ns_engine_shortest(m->engine, t, &until) < *to - t &&
        is_ruled_out(m, *to, &s, &status))
        return NS_OK;
    for (int i = 0; i < MOST && status == NS_OK && !*found && t < *to; i++) {
        const double end = *to, step = ns_engine_shortest(m->engine, t, &until);
        const double next = step < end - t ? t + step : end;
        t = fmax(fmin(next, until), nextafter(t, INFINITY)); /* however short the trial is */
        status = add_sample(m, t, &s);
        if (status == NS_OK)
            status = search_samples(m, &s, to, found);
    }
    *to = *found ? *to : t;
    return status;
}

/* What is crossed at the end of the trial. */
static int mark_end(ns_march *m) {
    ns_watched_thresholds *w = m->watched;
    const int status = ns_engine_read(m->engine, NULL, w->x, NULL, NULL);
    measure(w, w->latest);
    (void)mark(w, w->latest);
    return status;
}

/* At the crossing *to, and what is crossed so shortly after it, before `end`, that rounding alone tells the
 * two apart: edges of clocks whose periods have a common multiple; *to becomes the later time. */
static int mark_crossing(ns_march *m, double end, double *to) {
    ns_watched_thresholds *w = m->watched;
    double least;
    const int status = look_at(m, *to, w->latest, &least);
    const double later = fmin(end, *to + NS_MARCH_TOGETHER * fabs(*to));
    (void)mark(w, w->latest);
    w->any = 1;
    if (status != NS_OK || !(later > *to) || w->count == 1)
        return status;
    *to = later;
    const int after = look_at(m, later, w->latest, &least);
    for (int k = 0; k < w->count; k++)
        w->crossed[k] |= w->latest[k] < 0;
    return after;
}

int ns_march_watched_try(ns_march *m, double t, ns_until until, double *reached) {
    ns_watched_thresholds *w = m->watched;
    int found = 0;
    if (w->count == 0)
        return ns_march_try_unwatched(m, t, until, reached);
    if (w->stopped)
        return NS_E_STATE;
    w->any = 0;
    int status = ns_march_try_unwatched(m, t, NS_TO_STEP, reached);
    if (status != NS_OK)
        return status;
    if (!(*reached > m->accepted)) /* the right side of an event */
        return mark_end(m);
    double to = *reached;
    status = find_crossing(m, m->accepted, &to, &found);
    if (status == NS_OK && found)
        status = mark_crossing(m, *reached, &to);
    return status != NS_OK || to >= *reached ? status : ns_march_try_unwatched(m, to, NS_TO_STEP, reached);
}

void ns_march_watched_accept(ns_march *m) {
    m->watched->stopped = m->watched->any;
}
