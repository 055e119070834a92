/* src/exact/periodic_replay.c - a period flown as the one before, which spares what looks for events and
 * modes.
 *
 * The way from one event to the next is flown as ever (advance.c), and the mode of the period before holds by
 * its guards (guard_sign.c), or the period goes another way.
 */
#include "mode_selection.h"

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
    int broke;
    return ns_exact_advance(f, t, &broke) == NS_OK && broke == (s->guard >= 0);
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

int ns_exact_period_run(ns_exact *f, const ns_period *lap, double t) {
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
    f->s->counts.events = from.counts.events; /* periodic_map.c counts them */
    return same;
}
