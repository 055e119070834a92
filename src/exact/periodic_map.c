/* src/exact/periodic_map.c - periods of a drive that recur, as one product each. */
#include "periodic_map.h"

#include "exact_internal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Products larger than this cost more than what is looked up for the legs. */
enum { NS_LAP_MOST = 8192 };

/* --- recording --- */

void ns_exact_period_abort(ns_exact *f) {
    f->laps.open = 0;
}

void ns_exact_period_drop(ns_exact *f) {
    ns_period_record *l = &f->laps;
    l->open = l->known = 0;
    if (l->lap)
        f->bytes -= l->lap->bytes;
    free(l->lap);
    l->lap = NULL;
}

/* Steps that were recorded may be gone. */
static void forget_dropped_steps(ns_exact *f) {
    ns_period_record *l = &f->laps;
    if (l->steps_dropped != f->steps_dropped)
        l->open = l->known = 0;
    l->steps_dropped = f->steps_dropped;
}

void ns_exact_period_note_inputs(ns_exact *f) {
    const ns_period_record *l = &f->laps;
    const size_t nv = (size_t)f->exo->nv;
    if (!l->way && l->steps < NS_LAP_STEPS)
        memcpy(l->v + (size_t)l->steps * nv, f->X + f->s->r, sizeof *l->v * nv);
}

/* One more, whose inputs were noted; its place. */
static ns_period_step *add_step(ns_exact *f) {
    ns_period_record *l = &f->laps;
    l->open = l->steps < NS_LAP_STEPS;
    if (!l->open) {
        l->period = 0; /* it may not be there any more */
        return NULL;
    }
    l->step[l->steps] = (ns_period_step){.mode = f->at, .guard = -1};
    return &l->step[l->steps++];
}

/* No kept step: all from the last event to the next one counts as one. */
static void record_searched_step(ns_exact *f) {
    ns_period_record *l = &f->laps;
    l->open = f->timed;
    if (!l->open || (l->steps == l->stretch && !add_step(f)))
        return;
    l->steps = l->stretch + 1; /* its inputs are those of the first step since the event */
    l->step[l->stretch] = (ns_period_step){.mode = f->at, .guard = -1};
    l->way = 1;
}

void ns_exact_period_record(ns_exact *f, const ns_exact_step *step) {
    const ns_period_record *l = &f->laps;
    forget_dropped_steps(f);
    if (!step->level || !l->open || l->way)
        return;
    if (!step->leg || f->at->instant) {
        record_searched_step(f);
        return;
    }
    ns_period_step *to = add_step(f);
    if (to) {
        to->level = step->level;
        to->leg = step->leg;
    }
}

void ns_exact_period_guard_broke(ns_exact *f, const ns_exact_mode *from, int guard) {
    ns_period_record *l = &f->laps;
    l->open = l->open && l->way && f->past.crowd == 0 && guard >= 0 && f->at != from;
    if (!l->open)
        return;
    l->step[l->stretch].guard = guard;
    l->stretch = l->steps;
    l->way = 0;
}

/* A period begins here, if there are periods.  One that is known is not asked for until it is over. */
static int begin(ns_exact *f) {
    ns_period_record *l = &f->laps;
    l->open = 0;
    if (f->at->instant || f->past.crowd > 0)
        return NS_OK;
    if (l->period == 0)
        l->period = ns_inputs_events_period(f->schedule);
    if (l->period == 0)
        return NS_OK;
    if (!l->v)
        l->v = malloc(sizeof *l->v * NS_LAP_STEPS * ((size_t)f->exo->nv + 1));
    if (!l->v)
        return NS_E_MEMORY;
    l->open = 1;
    l->steps = l->stretch = l->way = 0;
    l->first = f->at;
    l->begin = f->t;
    return NS_OK;
}

/* The steps of the last period were those of the one before, as far as modes and legs tell: it is worth a
 * lap, which is made of the last one and proves itself. */
static int same_again(const ns_period_record *l) {
    if (l->known != l->steps)
        return 0;
    for (int i = 0; i < l->steps; i++)
        if (l->step[i].mode != l->last[i].mode || l->step[i].leg != l->last[i].leg)
            return 0;
    return 1;
}

/* --- making --- */

/* As a product. */
static ns_period *create(const ns_exact *f) {
    const ns_period_record *l = &f->laps;
    const size_t r = (size_t)f->s->r;
    size_t rows = 0;
    for (int i = 0; i < l->steps; i++)
        rows += ((size_t)l->step[i].leg->samples + 1) * (size_t)l->step[i].level->stage->rows;
    if (r * (r + rows) > NS_LAP_MOST)
        return NULL;
    const size_t most = rows > r ? rows : r, bytes = sizeof(double) * (r * r + r + rows * r + rows + most);
    ns_period *lap = calloc(1, sizeof *lap + bytes);
    if (!lap)
        return NULL;
    lap->bytes = sizeof *lap + bytes;
    lap->r = (int)r;
    lap->rows = (int)rows;
    lap->P = (double *)(void *)(lap + 1);
    lap->c = lap->P + r * r;
    lap->G = lap->c + r;
    lap->cg = lap->G + rows * r;
    lap->work = lap->cg + rows;
    return lap;
}

/* What a matrix (p*q), of w and the inputs v (nv), makes of w = A w0 + a: B w0 + b, B with leading dimension
 * ld. */
static void behind(const ns_period *lap, int p, int nv, const double *matrix, const double *v, int ld,
                   double *B, double *b) {
    const int r = lap->r;
    for (int j = 0; j < r; j++)
        ns_linalg_matvec(p, r, matrix, lap->P + (size_t)j * (size_t)r, B + (size_t)j * (size_t)ld);
    ns_linalg_matvec(p, r, matrix, lap->c, b);
    ns_linalg_matvec_add(p, nv, matrix + (size_t)p * (size_t)r, v, b);
}

/* Step by step, from w to w and to the guards; room: r*r + r. */
static void fill(const ns_exact *f, ns_period *lap, double *room) {
    const ns_period_record *l = &f->laps;
    const int r = lap->r, nv = f->exo->nv;
    const size_t size = (size_t)r * (size_t)r;
    int at = 0;
    for (int i = 0; i < r; i++)
        lap->P[i + i * r] = 1;
    for (int i = 0; i < l->steps; i++) {
        const ns_period_step *s = &l->step[i];
        const double *v = l->v + (size_t)i * (size_t)nv;
        const int rows = s->level->stage->rows, all = (s->leg->samples + 1) * rows;
        if (all > 0)
            behind(lap, all, nv, s->leg->sample, v, lap->rows, lap->G + at, lap->cg + at);
        at += all;
        lap->part[lap->parts++] = (ns_period_part){rows, s->leg->samples};
        behind(lap, r, nv, s->leg->P, v, r, room, room + size);
        memcpy(lap->P, room, sizeof *room * (size + (size_t)r)); /* and c */
        lap->length += s->leg->h;
    }
}

/* As steps that are flown. */
static ns_period *copy(const ns_exact *f) {
    const ns_period_record *l = &f->laps;
    const size_t steps = (size_t)l->steps, nv = (size_t)f->exo->nv, q = (size_t)f->s->r + nv;
    const size_t numbers = sizeof(double) * (steps * nv + q), bytes = numbers + steps * sizeof *l->step;
    ns_period *lap = calloc(1, sizeof *lap + bytes);
    if (!lap)
        return NULL;
    lap->bytes = sizeof *lap + bytes;
    lap->v = (double *)(void *)(lap + 1);
    lap->back = lap->v + steps * nv;
    lap->step = (ns_period_step *)(void *)(lap->back + q);
    for (int i = 0, first = 0; i < l->steps; first = ++i) {
        while (!l->step[i].event && l->step[i].guard < 0) /* legs in a row */
            i++;
        memcpy(lap->v + (size_t)lap->steps * nv, l->v + (size_t)first * nv, sizeof *l->v * nv);
        lap->step[lap->steps++] = l->step[i];
    }
    return lap;
}

static void count_events(const ns_period_record *l, ns_period *lap) {
    for (int i = 0; i < l->steps; i++) {
        const ns_period_step *s = &l->step[i];
        const int event = s->event || s->guard >= 0;
        lap->events += event;
        lap->changes += event && l->step[i + 1 < l->steps ? i + 1 : 0].mode != s->mode;
    }
}

static int all_legs(const ns_period_record *l) {
    for (int i = 0; i < l->steps; i++)
        if (!l->step[i].leg)
            return 0;
    return 1;
}

static int make(ns_exact *f) {
    ns_period_record *l = &f->laps;
    const size_t r = (size_t)f->s->r;
    const int legs = all_legs(l);
    ns_exact_period_drop(f);
    ns_period *lap = legs ? create(f) : copy(f);
    double *room = lap ? malloc(sizeof *room * (r * r + r + 1)) : NULL;
    if (!lap)
        return NS_OK; /* too large, or no memory: it is flown as before */
    if (!room) {
        free(lap);
        return NS_E_MEMORY;
    }
    lap->mode = f->at;
    lap->from = f->t;
    lap->period = l->period;
    if (legs)
        fill(f, lap, room);
    count_events(l, lap);
    free(room);
    f->bytes += lap->bytes;
    f->s->counts.maps++;
    l->lap = lap;
    l->refused = 0;
    l->again = f->t;
    return NS_OK;
}

int ns_exact_period_time_event(ns_exact *f) {
    ns_period_record *l = &f->laps;
    forget_dropped_steps(f);
    if (f->past.crowd > 0 || l->steps == l->stretch)
        l->open = 0;
    if (!l->open)
        return l->lap && f->t < l->again ? NS_OK : begin(f);
    l->step[l->steps - 1].event = 1;
    l->step[l->steps - 1].end = f->t - l->begin;
    l->stretch = l->steps;
    l->way = 0;
    const double left = l->begin + l->period - f->t;
    if (left > ns_exact_period_slack(f))
        return NS_OK;
    const double period = l->period;
    l->period = ns_inputs_events_period(f->schedule);
    if (left < -ns_exact_period_slack(f) || f->at != l->first || l->period != period)
        return begin(f);
    int status = NS_OK;
    if (same_again(l))
        status = make(f);
    l->known = l->steps;
    memcpy(l->last, l->step, sizeof l->last);
    return status == NS_OK ? begin(f) : status;
}
