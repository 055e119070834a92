/* src/waveform/waveform.c - points of a waveform: made, started, given out one by one. */
#include "linalg/simd.h"
#include "waveform_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- made --- */

static double positive_or(double given, double otherwise) {
    return given > 0 ? given : otherwise;
}

static int check_options(const ns_system *s, const ns_waveform_options *o) {
    const int numbers = o->lines >= 0 && o->lines < 1 && o->longest >= 0 && o->closest >= 0 &&
                        o->noise >= 0 && o->every >= 0 && o->squares >= 0 && o->squares < 1 && o->noise < 1 &&
                        isfinite(o->closest);
    for (int k = 0; o->kind && k < s->n + s->m; k++)
        if (o->kind[k] >= NS_WAVEFORM_KINDS)
            return NS_E_RANGE;
    return numbers ? NS_OK : NS_E_RANGE;
}

static int allocate(ns_waveform *w) {
    const size_t count = w->count + NS_WIDE, m = (size_t)w->s->m + 1;
    w->seen_at = w->count + 1 + (size_t)w->taken.size;
    w->row_size = w->seen_at + count;
    w->rows = calloc(NS_ROWS * w->row_size, sizeof *w->rows);
    w->modes = calloc(NS_ROWS * m, sizeof *w->modes);
    w->signal = calloc(count, sizeof *w->signal);
    w->kind = calloc(count, 1);
    w->limits = calloc(2 * count, sizeof *w->limits);
    w->largest = calloc(13 * count, sizeof *w->largest);
    if (!w->rows || !w->modes || !w->signal || !w->kind || !w->limits || !w->largest)
        return NS_E_MEMORY;
    w->turned = w->limits + count;
    w->per_tolerance = w->largest + count;
    w->since_event = w->per_tolerance + count;
    w->total = w->since_event + count;
    w->error = w->total + count;
    w->own = w->error + count;
    w->own_error = w->own + count;
    w->slope = w->own_error + count;
    w->end_values = w->slope + count;
    w->at_end = w->end_values + count;
    w->square = w->at_end + count;
    w->square_error = w->square + count;
    w->rounding = w->square_error + count;
    return NS_OK;
}

/* Those of one kind lie side by side. */
static void choose_signals(ns_waveform *w, const unsigned char *kind) {
    for (int of = 1; of < NS_WAVEFORM_KINDS; of++) {
        for (int k = 0; k < (int)w->count; k++)
            if ((kind ? kind[k] : 1) == of) {
                w->signal[w->looked] = k;
                w->kind[w->looked++] = (unsigned char)of;
            }
        w->kind_end[of] = w->looked;
    }
}

/* Which corners matter; integrals of others may be of anything.  Errors: MEMORY: all matter. */
static int tell_marcher(const ns_waveform *w) {
    unsigned char *looked = w->taken.size > 0 ? NULL : calloc(w->count + 1, 1);
    for (int i = 0; looked && i < w->looked; i++)
        looked[w->signal[i]] = 1;
    const int status = ns_march_look_at(w->march, looked);
    free(looked);
    return status;
}

int ns_waveform_create(const ns_system *s, ns_march *m, const ns_waveform_options *o, ns_waveform **out) {
    if (!out)
        return NS_E_NULL;
    *out = NULL;
    if (!s || !m || !o)
        return NS_E_NULL;
    int status = check_options(s, o);
    ns_waveform *w = status == NS_OK ? calloc(1, sizeof *w) : NULL;
    if (!w)
        return status == NS_OK ? NS_E_MEMORY : status;
    w->s = s;
    w->march = m;
    w->lines = positive_or(o->lines, 1e-4);
    w->longest = positive_or(o->longest, INFINITY);
    w->every = positive_or(o->every, INFINITY);
    w->closest = o->closest;
    w->squares = o->squares;
    for (int k = 0; k < NS_WAVEFORM_KINDS; k++)
        w->floor[k] = fmax(o->floor[k], 0);
    w->noise = positive_or(o->noise, 1e-12);
    w->count = (size_t)s->n + (size_t)s->m;
    if (o->integrals)
        w->taken = *o->integrals;
    status = allocate(w);
    if (status == NS_OK) {
        choose_signals(w, o->kind);
        status = tell_marcher(w);
    }
    if (status != NS_OK) {
        ns_waveform_free(w);
        return status;
    }
    *out = w;
    return NS_OK;
}

void ns_waveform_free(ns_waveform *w) {
    if (!w)
        return;
    free(w->rows);
    free(w->modes);
    free(w->signal);
    free(w->kind);
    free(w->limits);
    free(w->largest);
    free(w);
}

/* --- started --- */

static void give(ns_waveform *w, const ns_probe *p, int after_jump, ns_waveform_point *out) {
    *out = (ns_waveform_point){.t = p->t,
                               .after_jump = after_jump,
                               .x = p->v,
                               .lambda = p->v + w->s->n,
                               .mode = ns_waveform_mode_of(w, p->v),
                               .sums = w->taken.size > 0 ? p->v + w->count + 1 : NULL};
    w->points++;
}

/* The marcher's accepted point is the first one. */
static int begin(ns_waveform *w, int starts, ns_waveform_point *first) {
    ns_segment *g = &w->made;
    ns_waveform_return_all_rows(w);
    w->pending.last = g->last = 0;
    w->started = w->in_stretch = w->after_event = 0;
    w->before = 0;
    w->failed = NS_OK;
    double *row = g->at[0].v = ns_waveform_take_row(w);
    int status = ns_march_read(w->march, &w->accepted_t, row, row + w->s->n, NULL);
    if (status == NS_OK && w->taken.size > 0)
        status = w->taken.begin(w->taken.data, w->march, starts);
    if (status != NS_OK)
        return status;
    ns_waveform_put_integrals(w, row);
    memcpy(ns_waveform_mode_of(w, row), ns_march_mode(w->march), sizeof(ns_mode) * (size_t)w->s->m);
    ns_waveform_note_row(w, row);
    g->at[0].t = w->start_t = w->accepted_t;
    ns_waveform_note_size(w, row);
    ns_waveform_begin_integrals(w, w->accepted_t);
    memset(w->total, 0, sizeof *w->total * (size_t)w->looked);
    memset(w->square, 0, sizeof *w->square * (size_t)w->looked);
    memset(w->square_error, 0, sizeof *w->square_error * (size_t)w->looked);
    w->square_time = 0;
    memset(w->slope, 0, sizeof *w->slope * (size_t)w->looked);
    ns_waveform_forget_rounding(w);
    w->after_event = w->started = 1;
    if (first)
        give(w, &g->at[0], 0, first);
    return NS_OK;
}

int ns_waveform_start(ns_waveform *w, ns_waveform_point *first) {
    if (!w)
        return NS_E_NULL;
    memset(w->largest, 0, sizeof *w->largest * (size_t)w->looked);
    memset(w->kind_largest, 0, sizeof w->kind_largest);
    memset(w->limits, 0, sizeof *w->limits * (size_t)w->looked);
    memset(w->turned, 0, sizeof *w->turned * (size_t)w->looked);
    w->stale = 1;
    w->worst = -1;
    return begin(w, 1, first);
}

/* 1 if both look at the same signals. */
static int look_alike(const ns_waveform *a, const ns_waveform *b) {
    return a->count == b->count && a->looked == b->looked &&
           memcmp(a->signal, b->signal, sizeof *a->signal * (size_t)a->looked) == 0 &&
           memcmp(a->kind, b->kind, (size_t)a->looked) == 0;
}

int ns_waveform_continue(ns_waveform *w, const ns_waveform *from, ns_waveform_point *first) {
    const int status = ns_waveform_start(w, first);
    if (status != NS_OK || !from || !look_alike(w, from))
        return status;
    /* as a part of what is allowed, which may have changed */
    const double error_as_part = from->squares > 0 ? w->squares / from->squares : 0;
    for (int i = 0; i < w->looked; i++) {
        w->largest[i] = fmax(w->largest[i], from->largest[i]);
        w->total[i] = from->total[i];
        w->square[i] = from->square[i];
        w->square_error[i] = error_as_part * from->square_error[i];
        w->limits[i] = from->limits[i];
        w->turned[i] = from->turned[i];
    }
    for (int k = 0; k < NS_WAVEFORM_KINDS; k++)
        w->kind_largest[k] = fmax(w->kind_largest[k], from->kind_largest[k]);
    w->start_t = from->start_t;
    w->square_time = from->square_time;
    w->before = from->before;
    return NS_OK;
}

int ns_waveform_skip(ns_waveform *w, double t, ns_waveform_point *first) {
    double reached;
    if (!w || !w->started)
        return w ? NS_E_STATE : NS_E_NULL;
    int status = ns_march_try(w->march, t, NS_TO_TIME, &reached);
    if (status == NS_OK)
        status = ns_march_accept(w->march);
    return status == NS_OK ? begin(w, 0, first) : status;
}

/* --- the next point --- */

/* The pending segment ends in the next point. */
static void give_pending(ns_waveform *w, ns_waveform_point *out) {
    ns_segment *p = &w->pending;
    ns_waveform_note_given(w, p);
    give(w, &p->at[p->last], p->jumps, out);
    ns_waveform_drop_segment(w, p);
}

/* The segment that was made becomes the pending one; *given: the one before is given out. */
static void take_made(ns_waveform *w, ns_waveform_point *out, int *given) {
    ns_segment *g = &w->made;
    const ns_probe end = g->at[g->last];
    *given = 0;
    if (w->pending.last > 0 && !ns_waveform_merge(w)) {
        give_pending(w, out);
        *given = 1;
    }
    if (g->last > 0)
        w->pending = *g;
    *g = (ns_segment){.at = {end}};
}

/* A segment that was not finished; where it begins stays. */
static void drop_made(ns_waveform *w) {
    while (w->made.last > 0)
        ns_waveform_return_row(w, w->made.at[w->made.last--].v);
}

/* 1 if the segment ends where the stretch does; a round time that close is shown in place of it. */
static int is_at_end(const ns_waveform *w) {
    return w->end - w->made.at[w->made.last].t <= w->closest;
}

/* The integrals of others, to the end of a segment. */
static int take_to_end(ns_waveform *w, const ns_probe *end) {
    const int status = ns_waveform_take_integrals(w, is_at_end(w) ? w->end : end->t);
    if (status == NS_OK)
        ns_waveform_put_integrals(w, end->v);
    return status;
}

/* One more segment, to the end of the stretch at most. */
static int make_segment(ns_waveform *w, double until) {
    int status = w->in_stretch ? NS_OK : ns_waveform_enter_stretch(w, until);
    if (status == NS_OK && !w->made.jumps)
        status = ns_waveform_choose(w);
    if (status == NS_OK && !w->made.jumps)
        status = take_to_end(w, &w->made.at[w->made.last]);
    else if (status == NS_OK && is_at_end(w)) /* a jump that leaves nothing of a very short stretch */
        status = ns_waveform_take_integrals(w, w->end);
    if (status == NS_OK && is_at_end(w))
        status = ns_waveform_leave_stretch(w);
    return status;
}

int ns_waveform_next(ns_waveform *w, double until, ns_waveform_point *next) {
    int given = 0;
    if (!w || !next)
        return NS_E_NULL;
    if (!w->started)
        return NS_E_STATE;
    w->until = until;
    while (!given) {
        const int done = w->failed != NS_OK || w->made.at[0].t >= until;
        if (done && w->pending.last == 0)
            return w->failed != NS_OK ? w->failed : NS_E_RANGE;
        if (done) {
            give_pending(w, next);
            return NS_OK;
        }
        w->failed = make_segment(w, until);
        if (w->failed != NS_OK)
            drop_made(w);
        else
            take_made(w, next, &given);
    }
    return NS_OK;
}

int ns_waveform_resume(ns_waveform *w) {
    if (!w || !w->started)
        return w ? NS_E_STATE : NS_E_NULL;
    w->failed = NS_OK;
    w->in_stretch = 0;
    w->after_event = 1;
    return NS_OK;
}

void ns_waveform_drop_integrals(ns_waveform *w) {
    if (!w)
        return;
    w->taken.size = 0;
    (void)tell_marcher(w); /* if it fails, there are more points than needed */
}

ns_waveform_counts ns_waveform_read_counts(const ns_waveform *w) {
    ns_waveform_counts c = {
        .points = w->points, .samples = w->samples, .by_squares = w->by_squares, .busiest = -1};
    int most = 0;
    for (int i = 1; i < w->looked; i++)
        most = w->limits[i] > w->limits[most] ? i : most;
    if (w->looked > 0 && w->limits[most] > 0) {
        const double time = w->made.at[0].t - w->start_t;
        c.busiest = w->signal[most];
        c.turns = time > 0 ? (double)w->turned[most] / time : 0;
    }
    return c;
}
