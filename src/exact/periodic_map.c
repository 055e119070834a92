/* src/exact/periodic_map.c - records periods of the sources; makes one that recurs a product, or a list of
 * events. */
#include "periodic_map.h"

#include "exact_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Larger products take longer than the steps they stand for. */
enum { NS_PERIOD_MAX_SIZE = 8192 };

/* --- recording --- */

void ns_exact_period_abort(ns_exact *f) {
    f->record.open = 0;
}

void ns_exact_period_drop(ns_exact *f) {
    ns_period_record *l = &f->record;
    l->open = l->known = 0;
    if (l->period)
        f->cache.bytes -= l->period->bytes;
    free(l->period);
    l->period = NULL;
}

/* Recorded steps may have been dropped. */
static void forget_dropped_steps(ns_exact *f) {
    ns_period_record *l = &f->record;
    if (l->steps_dropped != f->cache.steps_dropped)
        l->open = l->known = 0;
    l->steps_dropped = f->cache.steps_dropped;
}

void ns_exact_period_note_inputs(ns_exact *f) {
    const ns_period_record *l = &f->record;
    const size_t nv = (size_t)f->inputs->nv;
    if (!l->searched && l->steps < NS_PERIOD_STEPS)
        memcpy(l->v + (size_t)l->steps * nv, f->X + f->s->r, sizeof *l->v * nv);
}

/* Adds a step, whose inputs were noted. */
static ns_period_step *add_step(ns_exact *f) {
    ns_period_record *l = &f->record;
    l->open = l->steps < NS_PERIOD_STEPS;
    if (!l->open) {
        l->duration = 0; /* the sources may not repeat any more */
        return NULL;
    }
    l->step[l->steps] = (ns_period_step){.mode = f->state.mode, .guard = NS_GUARD_NONE};
    return &l->step[l->steps++];
}

/* It was no kept step: all from the last event to the next one counts as one. */
static void record_searched_step(ns_exact *f) {
    ns_period_record *l = &f->record;
    l->open = f->timed;
    if (!l->open || (l->steps == l->since_event && !add_step(f)))
        return;
    l->steps = l->since_event + 1; /* its inputs are those of the first step since the event */
    l->step[l->since_event] = (ns_period_step){.mode = f->state.mode, .guard = NS_GUARD_NONE};
    l->searched = 1;
}

void ns_exact_period_record(ns_exact *f, const ns_exact_step *step) {
    const ns_period_record *l = &f->record;
    forget_dropped_steps(f);
    if (!step->scale || !l->open || l->searched)
        return;
    if (!step->map || f->state.mode->has_instant) {
        record_searched_step(f);
        return;
    }
    ns_period_step *to = add_step(f);
    if (to) {
        to->scale = step->scale;
        to->map = step->map;
    }
}

void ns_exact_period_guard_broke(ns_exact *f, const ns_exact_mode *from, int guard) {
    ns_period_record *l = &f->record;
    l->open = l->open && l->searched && f->past.event_count == 0 && guard >= 0 && f->state.mode != from;
    if (!l->open)
        return;
    l->step[l->since_event].guard = guard;
    l->since_event = l->steps;
    l->searched = 0;
}

/* A period begins here, if the sources repeat. */
static int begin_record(ns_exact *f) {
    ns_period_record *l = &f->record;
    l->open = 0;
    if (f->state.mode->has_instant || f->past.event_count > 0)
        return NS_OK;
    if (l->duration == 0)
        l->duration = ns_inputs_events_period(f->events);
    if (l->duration == 0)
        return NS_OK;
    if (!l->v)
        l->v = malloc(sizeof *l->v * NS_PERIOD_STEPS * ((size_t)f->inputs->nv + 1));
    if (!l->v)
        return NS_E_MEMORY;
    l->open = 1;
    l->steps = l->since_event = l->searched = 0;
    l->first = f->state.mode;
    l->begin = f->state.now.t;
    return NS_OK;
}

/* The last two periods had the same modes and kept steps: the next one is tried with what the last one was;
 * its guards tell whether that is right. */
static int repeats_last(const ns_period_record *l) {
    if (l->known != l->steps)
        return 0;
    for (int i = 0; i < l->steps; i++)
        if (l->step[i].mode != l->last[i].mode || l->step[i].map != l->last[i].map)
            return 0;
    return 1;
}

/* --- a period of what was recorded --- */

/* Arrays for a product of all recorded steps; NULL: too large, or no memory. */
static ns_period *allocate_product(const ns_exact *f) {
    const ns_period_record *l = &f->record;
    const size_t r = (size_t)f->s->r;
    size_t rows = 0;
    for (int i = 0; i < l->steps; i++)
        rows += ((size_t)l->step[i].map->samples + 1) * (size_t)l->step[i].scale->kernel->rows;
    if (r * (r + rows) > NS_PERIOD_MAX_SIZE)
        return NULL;
    const size_t most = rows > r ? rows : r, bytes = sizeof(double) * (r * r + r + rows * r + rows + most);
    ns_period *period = calloc(1, sizeof *period + bytes);
    if (!period)
        return NULL;
    period->bytes = sizeof *period + bytes;
    period->r = (int)r;
    period->rows = (int)rows;
    period->P = (double *)(void *)(period + 1);
    period->c = period->P + r * r;
    period->G = period->c + r;
    period->cg = period->G + rows * r;
    period->work = period->cg + rows;
    return period;
}

/* What a matrix (p*q), of w and the inputs v (nv), makes of w = A w0 + a: B w0 + b, B with leading dimension
 * ld. */
static void apply_after_product(const ns_period *period, int p, int nv, const double *matrix, const double *v,
                                int ld, double *B, double *b) {
    const int r = period->r;
    for (int j = 0; j < r; j++)
        ns_linalg_matvec(p, r, matrix, period->P + (size_t)j * (size_t)r, B + (size_t)j * (size_t)ld);
    ns_linalg_matvec(p, r, matrix, period->c, b);
    ns_linalg_matvec_add(p, nv, matrix + (size_t)p * (size_t)r, v, b);
}

/* P, c, G, cg, step by step; room: r*r + r. */
static void multiply_steps(const ns_exact *f, ns_period *period, double *room) {
    const ns_period_record *l = &f->record;
    const int r = period->r, nv = f->inputs->nv;
    const size_t size = (size_t)r * (size_t)r;
    int at = 0;
    for (int i = 0; i < r; i++)
        period->P[i + i * r] = 1;
    for (int i = 0; i < l->steps; i++) {
        const ns_period_step *s = &l->step[i];
        const double *v = l->v + (size_t)i * (size_t)nv;
        const int rows = s->scale->kernel->rows, all = (s->map->samples + 1) * rows;
        if (all > 0)
            apply_after_product(period, all, nv, s->map->sample, v, period->rows, period->G + at,
                                period->cg + at);
        at += all;
        period->part[period->parts++] = (ns_period_part){rows, s->map->samples};
        apply_after_product(period, r, nv, s->map->P, v, r, room, room + size);
        for (size_t j = 0; j < size + (size_t)r; j++) /* and c */
            period->P[j] = room[j] + (s->map->J ? period->P[j] : 0);
        period->steps_length += s->map->h;
    }
}

/* The recorded steps, those between two events as one; NULL: no memory. */
static ns_period *list_events(const ns_exact *f) {
    const ns_period_record *l = &f->record;
    const size_t steps = (size_t)l->steps, nv = (size_t)f->inputs->nv, q = (size_t)f->s->r + nv;
    const size_t numbers = sizeof(double) * (steps * nv + q), bytes = numbers + steps * sizeof *l->step;
    ns_period *period = calloc(1, sizeof *period + bytes);
    if (!period)
        return NULL;
    period->bytes = sizeof *period + bytes;
    period->v = (double *)(void *)(period + 1);
    period->X_before = period->v + steps * nv;
    period->step = (ns_period_step *)(void *)(period->X_before + q);
    for (int i = 0, first = 0; i < l->steps; first = ++i) {
        while (!l->step[i].event && l->step[i].guard < 0) /* kept steps in a row */
            i++;
        memcpy(period->v + (size_t)period->steps * nv, l->v + (size_t)first * nv, sizeof *l->v * nv);
        period->step[period->steps++] = l->step[i];
    }
    return period;
}

static void count_events(const ns_period_record *l, ns_period *period) {
    for (int i = 0; i < l->steps; i++) {
        const ns_period_step *s = &l->step[i];
        period->events += s->event || s->guard >= 0;
    }
}

static int all_kept_steps(const ns_period_record *l) {
    for (int i = 0; i < l->steps; i++)
        if (!l->step[i].map)
            return 0;
    return 1;
}

static int make_period(ns_exact *f) {
    ns_period_record *l = &f->record;
    const size_t r = (size_t)f->s->r;
    const int as_product = all_kept_steps(l);
    ns_exact_period_drop(f);
    ns_period *period = as_product ? allocate_product(f) : list_events(f);
    double *room = period ? malloc(sizeof *room * (r * r + r + 1)) : NULL;
    if (!period)
        return NS_OK; /* it is integrated event by event, as before */
    if (!room) {
        free(period);
        return NS_E_MEMORY;
    }
    period->mode = f->state.mode;
    period->from = f->state.now.t;
    period->duration = l->duration;
    if (as_product)
        multiply_steps(f, period, room);
    count_events(l, period);
    free(room);
    f->cache.bytes += period->bytes;
    f->counts.maps++;
    l->period = period;
    l->refused = 0;
    l->retry_at = f->state.now.t;
    return NS_OK;
}

int ns_exact_period_time_event(ns_exact *f) {
    ns_period_record *l = &f->record;
    forget_dropped_steps(f);
    if (f->past.event_count > 0 || l->steps == l->since_event)
        l->open = 0;
    if (!l->open)
        return l->period && f->state.now.t < l->retry_at ? NS_OK : begin_record(f);
    l->step[l->steps - 1].event = 1;
    l->step[l->steps - 1].end = f->state.now.t - l->begin;
    l->since_event = l->steps;
    l->searched = 0;
    const double left = l->begin + l->duration - f->state.now.t;
    if (left > ns_exact_same_instant(f))
        return NS_OK;
    const double period = l->duration;
    l->duration = ns_inputs_events_period(f->events);
    if (left < -ns_exact_same_instant(f) || f->state.mode != l->first || l->duration != period)
        return begin_record(f);
    int status = NS_OK;
    if (repeats_last(l))
        status = make_period(f);
    l->known = l->steps;
    memcpy(l->last, l->step, sizeof l->last);
    return status == NS_OK ? begin_record(f) : status;
}
