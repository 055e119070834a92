/* src/exact/periodic_replay.c - a period flown as the one before, which spares what looks for events and
 * modes.
 *
 * The way from one event to the next is flown as ever (advance.c), and the mode of the period before holds by
 * its guards (guard_sign.c), or the period goes another way.
 */
#include "mode_selection.h"

#include "linalg/simd.h"

#include <math.h>
#include <string.h>

/* Where a exact stands. */
typedef struct where {
    ns_exact_mode *at;
    double t, since, time_lost, event_t, slack;
    int broken;
    long budget;
    ns_counts counts;
} where;

static where leave(const ns_exact *f, double *X) {
    memcpy(X, f->X, sizeof *X * (size_t)(f->s->r + f->exo->nv));
    return (where){f->at,    f->t,      f->since,  f->time_lost, f->past.event_t,
                   f->slack, f->broken, f->budget, f->s->counts};
}

static void go_back(ns_exact *f, const where *w, const double *X) {
    memcpy(f->X, X, sizeof *X * (size_t)(f->s->r + f->exo->nv));
    f->at = w->at;
    f->t = w->t;
    f->since = w->since;
    f->time_lost = w->time_lost;
    f->past.event_t = w->event_t;
    f->slack = w->slack;
    f->broken = w->broken;
    f->budget = w->budget;
    f->s->counts = w->counts;
}

/* To the end of a step, t at the latest. */
static int fly(ns_exact *f, const ns_period_step *s, double t) {
    ns_exact_step step = {0};
    int status = NS_OK;
    while (status == NS_OK && !step.broke && f->t < t)
        status = ns_exact_advance(f, t, &step);
    return status == NS_OK && step.broke == (s->guard >= 0);
}

/* The event there, into the mode of the next step, with inputs v after an instant. */
static int pass(ns_exact *f, const ns_period_step *s, ns_exact_mode *to, const double *v) {
    if (s->event)
        memcpy(f->X + f->s->r, v, sizeof *v * (size_t)f->exo->nv);
    const int holds = ns_exact_select_known(f, to, !s->event);
    f->since = f->past.event_t = f->t;
    return holds;
}

/* The first instant at or after the end of step i, in a period from begin to end. */
static double instant(const ns_period *lap, int i, double begin, double end) {
    while (!lap->step[i].event)
        i++;
    return i + 1 < lap->steps ? begin + lap->step[i].end : end;
}

/* The steps of such a period from here to t; 0: it does not go that way, nothing is changed. */
static int run(ns_exact *f, const ns_period *lap, double t) {
    const where from = leave(f, lap->back);
    const size_t nv = (size_t)f->exo->nv;
    int same = 1;
    for (int i = 0; i < lap->steps && same; i++) {
        const ns_period_step *s = &lap->step[i];
        const int next = i + 1 < lap->steps ? i + 1 : 0;
        same = fly(f, s, instant(lap, i, from.t, t)) &&
               pass(f, s, lap->step[next].mode, lap->v + (size_t)next * nv);
    }
    if (!same)
        go_back(f, &from, lap->back);
    f->s->counts.events = from.counts.events; /* they are counted together */
    return same;
}

/* One begins here, and all of it is before t. */
static int is_due(const ns_exact *f, double t) {
    const ns_period *lap = f->laps.lap;
    if (!lap || f->at != lap->mode || fabs(f->time_lost) > ns_exact_period_slack(f) || f->t < f->laps.again ||
        f->t + lap->period >= t - ns_exact_period_slack(f))
        return 0;
    const double k = rint((f->t - lap->from) / lap->period);
    return f->since == f->t && fabs(f->t - (lap->from + k * lap->period)) <= ns_exact_period_slack(f);
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
static int multiply(ns_exact *f, ns_period *lap, double t) {
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
    const long dropped = f->steps_dropped;
    l->open = 0; /* nothing of it is recorded */
    if (!(lap->steps > 0 ? run(f, lap, end) : multiply(f, lap, end))) {
        if (++l->refused > OFTEN)
            l->again = f->t + (PAUSE - 0.5) * lap->period;
        l->open = open && f->steps_dropped == dropped;
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
