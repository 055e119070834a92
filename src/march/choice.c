/* src/march/choice.c - which of two engines costs less. */
#include "choice.h"

#include <math.h>

/* An engine is asked over the time that took the other one this part of the work between two questions, so
 * that busy and quiet times are in it. */
static const double part = 1.0 / 8;
/* It stays if it needs less than this of the other one's work. */
static const double clearly = 0.7;
/* It is left before that time is over if it has spent a quarter of that part and needs so many times as much;
 * but not, up to half of all work between two questions, if that is for matrices which are kept. */
static const double hopeless = 4, much = 0.5;
/* After a question that was answered no, it is this many times as long until the next; after a failure. */
static const double later = 2, much_later = 8;
/* An engine crawls that needs so many times the work that it needed when it was chosen: the other one is
 * asked at once, if this part of the usual interval has passed. */
static const double crawls = 4, soon = 0.5;
/* A trial through all events may take this many times the work between two questions before the other engine
 * is asked for the same one: what was done for it is lost then. */
static const double long_trial = 4;
/* The first question comes after this part of the interval if the engine at work needs more for its events
 * than the other one needs for any; the next one too, if the answer came before a few events had passed: a
 * transient that was gone through says nothing of them. */
static const double early = 0.25;
enum { FEW = 4 };
/* One that cannot be left, as the other one cannot begin there, goes on for this part of a question before
 * that is tried again, or for so many times what the trial took. */
static const double a_while = 0.25, times_a_trial = 8;

static void wait(ns_choice *c, double t, ns_work work, double times) {
    c->asks = 0;
    c->again = 0;
    c->interval *= times;
    c->from = (ns_choice_mark){t, work};
}

void ns_march_choice_begin(ns_choice *c, double t, ns_work work, double first) {
    if (!(c->interval > 0))
        *c = (ns_choice){.interval = first, .usual = NAN, .is_first = 1};
    if (c->asks)
        c->from = (ns_choice_mark){t, work};
    else
        wait(c, t, work, 1);
}

/* What was done since a mark, less what made matrices of modes that recur: it is not needed again. */
static double lasting(ns_work work, const ns_work *from) {
    const double events = work.events - from->events, modes = work.modes - from->modes,
                 recurring = events > 0 ? fmax(0, 1 - modes / events) : 0;
    return work.all - from->all - recurring * (work.once - from->once);
}

static int is_dear_at(const ns_choice *c, double work, double events, double most) {
    return work > early * c->interval && work > most * (events + 1);
}

static ns_choice_answer look_at_chosen(ns_choice *c, double t, ns_work work, ns_choice_bounds event) {
    const ns_work *from = &c->from.work;
    const double spent = work.all - from->all, gained = t - c->from.t, events = work.events - from->events,
                 needs = lasting(work, from);
    const int is_slow = needs > soon * c->interval && needs > crawls * c->usual * gained,
              is_dear = isnan(c->usual) &&
                        (is_dear_at(c, spent, events, event.most) ||
                         (event.starts && c->is_first && is_dear_at(c, work.all, work.events, event.most)));
    if ((spent < c->interval && !is_slow && !is_dear) || !(gained > 0))
        return NS_CHOICE_STAY;
    c->usual = needs / gained;
    c->per_event = needs / (events + 1);
    if (clearly * needs >= event.least * events + event.mode * (work.modes - from->modes))
        return NS_CHOICE_CHANGE;
    wait(c, t, work, 1);
    return NS_CHOICE_STAY;
}

static ns_choice_answer look_at_asked(ns_choice *c, double t, ns_work work) {
    const double spent = work.all - c->from.work.all, once = work.once - c->from.work.once,
                 events = work.events - c->from.work.events,
                 other = fmax(c->usual * (t - c->from.t), /* what the one before would have spent */
                              c->per_event * events),
                 whole = part * c->interval;
    if (other >= whole && spent < clearly * other) {
        c->usual = events < FEW ? NAN : clearly * c->usual;
        wait(c, t, work, 1);
        return NS_CHOICE_STAY;
    }
    if (c->again > 0)
        return work.all >= c->again ? NS_CHOICE_CHANGE : NS_CHOICE_STAY;
    const int is_hopeful = spent - once < clearly * other && spent < much * c->interval;
    const int is_over = spent > whole || (spent > whole / 4 && spent > hopeless * other);
    return is_over && !is_hopeful ? NS_CHOICE_CHANGE : NS_CHOICE_STAY;
}

ns_choice_answer ns_march_choice_look(ns_choice *c, double t, ns_work work, ns_choice_bounds event) {
    return c->asks ? look_at_asked(c, t, work) : look_at_chosen(c, t, work, event);
}

void ns_march_choice_changed(ns_choice *c, double t, ns_work work) {
    if (c->asks) {
        wait(c, t, work, later);
        return;
    }
    c->from = (ns_choice_mark){t, work};
    c->asks = 1;
    c->is_first = 0;
}

double ns_march_choice_trial(const ns_choice *c) {
    return long_trial * c->interval;
}

/* The other one may take as much, and is the better one if that brings it to the end. */
void ns_march_choice_cut_off(ns_choice *c, double from, double t) {
    c->interval *= long_trial;
    c->usual = c->interval / (clearly * (t - from));
    c->per_event = 0;
}

void ns_march_choice_failed(ns_choice *c, double t, ns_work work) {
    wait(c, t, work, much_later);
}

void ns_march_choice_stuck(ns_choice *c, ns_work work, double took) {
    c->again = work.all + fmax(a_while * part * c->interval, times_a_trial * took);
}

double ns_march_choice_limit(const ns_choice *c) {
    return c->asks && c->again == 0 ? c->from.work.all + 2 * much * c->interval : INFINITY;
}
