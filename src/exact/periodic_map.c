/* src/exact/periodic_map.c - periods of a drive that recur, as one product each. */
#include "periodic_map.h"

#include "exact_internal.h"

#include "linalg/simd.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Products larger than this cost more than what is looked up for the legs. */
enum { NS_LAP_MOST = 8192 };

/* --- recording --- */

void ns_exact_period_abort(ns_exact *f) {
    f->laps.open = 0;
}

void ns_exact_period_forget_steps(ns_exact *f) {
    f->laps.open = f->laps.known = 0;
    f->laps.forgotten++;
}

void ns_exact_period_drop(ns_exact *f) {
    ns_period_record *l = &f->laps;
    ns_exact_period_forget_steps(f);
    if (l->lap)
        f->bytes -= l->lap->bytes;
    free(l->lap);
    l->lap = NULL;
}

/* One more, from here on; its place. */
static ns_period_step *add(ns_exact *f) {
    ns_period_record *l = &f->laps;
    const size_t nv = (size_t)f->exo->nv;
    l->open = l->steps < NS_LAP_STEPS;
    if (!l->open) {
        l->period = 0; /* it may not be there any more */
        return NULL;
    }
    memcpy(l->v + (size_t)l->steps * nv, f->X + f->s->r, sizeof *l->v * nv);
    l->step[l->steps] = (ns_period_step){.mode = f->at, .guard = -1};
    return &l->step[l->steps++];
}

void ns_exact_period_step(ns_exact *f, const ns_time_scale *level, const ns_step_map *leg) {
    const ns_period_record *l = &f->laps;
    if (!l->open || l->way)
        return;
    if (f->at->instant) {
        ns_exact_period_unrecorded(f);
        return;
    }
    ns_period_step *step = add(f);
    if (step) {
        step->level = level;
        step->leg = leg;
    }
}

void ns_exact_period_unrecorded(ns_exact *f) {
    ns_period_record *l = &f->laps;
    if (!l->open || l->way)
        return;
    l->open = f->timed;
    if (!l->open || (l->steps == l->stretch && !add(f)))
        return;
    l->steps = l->stretch + 1; /* its inputs are those of the first leg since the event */
    l->step[l->stretch] = (ns_period_step){.mode = f->at, .guard = -1};
    l->way = 1;
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

/* Times this far apart are the same instant of a schedule. */
static double slack_of(const ns_exact *f) {
    return 8 * DBL_EPSILON * fabs(f->t);
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
    if (f->past.crowd > 0 || l->steps == l->stretch)
        l->open = 0;
    if (!l->open)
        return l->lap && f->t < l->again ? NS_OK : begin(f);
    l->step[l->steps - 1].event = 1;
    l->step[l->steps - 1].end = f->t - l->begin;
    l->stretch = l->steps;
    l->way = 0;
    const double left = l->begin + l->period - f->t;
    if (left > slack_of(f))
        return NS_OK;
    const double period = l->period;
    l->period = ns_inputs_events_period(f->schedule);
    if (left < -slack_of(f) || f->at != l->first || l->period != period)
        return begin(f);
    int status = NS_OK;
    if (same_again(l))
        status = make(f);
    l->known = l->steps;
    memcpy(l->last, l->step, sizeof l->last);
    return status == NS_OK ? begin(f) : status;
}

/* --- flying --- */

/* One begins here, and all of it is before t. */
static int is_due(const ns_exact *f, double t) {
    const ns_period *lap = f->laps.lap;
    if (!lap || f->at != lap->mode || fabs(f->time_lost) > slack_of(f) || f->t < f->laps.again ||
        f->t + lap->period >= t - slack_of(f))
        return 0;
    const double k = rint((f->t - lap->from) / lap->period);
    return f->since == f->t && fabs(f->t - (lap->from + k * lap->period)) <= slack_of(f);
}

/* All guards hold, at and between all samples. */
static int is_calm(const ns_exact *f, const ns_period *lap) {
    const double *s = lap->work;
    memcpy(lap->work, lap->cg, sizeof *lap->work * (size_t)lap->rows);
    ns_linalg_matvec_add(lap->rows, lap->r, lap->G, f->X, lap->work);
    for (int i = 0; i < lap->parts; i++) {
        const ns_period_part *p = &lap->part[i];
        if (!ns_exact_watch_clear(s, p->rows, p->samples))
            return 0;
        s += (size_t)p->rows * ((size_t)p->samples + 1);
    }
    return 1;
}

static void count(ns_exact *f, const ns_period *lap) {
    ns_counts *c = &f->s->counts;
    f->events += lap->events;
    c->events += lap->changes;
    c->predicted += lap->events;
    c->periods++;
}

/* By the product. */
static int fly(ns_exact *f, ns_period *lap, double t) {
    if (!is_calm(f, lap))
        return 0;
    memcpy(lap->work, lap->c, sizeof *lap->c * (size_t)lap->r);
    ns_linalg_matvec_add(lap->r, lap->r, lap->P, f->X, lap->work);
    memcpy(f->X, lap->work, sizeof *lap->work * (size_t)lap->r);
    for (int i = 0; i < lap->r; i++)
        f->most[i] = ns_higher(f->most[i], fabs(f->X[i]));
    f->time_lost += (f->t - t) + lap->length;
    f->s->counts.steps++;
    return 1;
}

int ns_exact_period_replay(ns_exact *f, double t) {
    enum { OFTEN = 3, PAUSE = 64 };
    ns_period_record *l = &f->laps;
    ns_period *lap = l->lap;
    if (!is_due(f, t))
        return 0;
    const double end = lap->from + (rint((f->t - lap->from) / lap->period) + 1) * lap->period;
    const int open = l->open;
    const long forgotten = l->forgotten;
    l->open = 0; /* nothing of it is recorded */
    if (!(lap->steps > 0 ? ns_exact_period_run(f, lap, end) : fly(f, lap, end))) {
        if (++l->refused > OFTEN)
            l->again = f->t + (PAUSE - 0.5) * lap->period;
        l->open = open && l->forgotten == forgotten;
        return 0;
    }
    l->refused = 0;
    f->t = f->since = f->past.event_t = f->from = f->to_t = end;
    f->doubted_at = NULL;
    f->broken = -1;
    ns_inputs_events_skip(f->schedule, f->t, lap->period);
    count(f, lap);
    return 1;
}
