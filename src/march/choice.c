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
/* Where of so many events one at most ended a new mode, these matrices may take in all as much as the other
 * one took in all: they are made once, and it goes on. */
static const double recurring = 6;
/* After a question that was answered no, it is this many times as long until the next; after a failure. */
static const double later = 2, much_later = 8;
/* An engine crawls that needs so many times the work that it needed when it was chosen: the other one is
 * asked at once, if this part of the first interval has passed; twice that where the answer was no. */
static const double crawls = 4, soon = 0.5;
/* What an engine needed in a question counts as this part of the question at least: it may have been short.
 */
static const double least_part = 0.125;
/* To ask costs that the engine at work begins again: at least so many times that lie between two questions.
 */
static const double starts = 4;
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

/* From here on is counted what the engine at work does; what it did so far counts for or against matrices of
 * the one that is asked. */
static void mark(ns_choice *c, double t, ns_work work) {
    const double spent = work.all - c->from.work.all;
    c->owed += c->asks ? -spent : spent;
    c->from = c->recent[0] = c->recent[1] = (ns_choice_mark){t, work};
}

static void wait(ns_choice *c, double t, ns_work work, double times) {
    mark(c, t, work);
    c->asks = 0;
    c->again = 0;
    c->interval *= times;
}

void ns_march_choice_begin(ns_choice *c, double t, ns_work work, double first) {
    if (!(c->interval > 0))
        *c = (ns_choice){.interval = first,
                         .first = first,
                         .patience = soon * first,
                         .usual = NAN,
                         .is_first = 1,
                         .is_early = 1,
                         .begin = {t, work},
                         .from = {t, work}};
    if (c->asks) {
        c->until += work.all - c->from.work.all;
        c->from = (ns_choice_mark){t, work};
    } else {
        wait(c, t, work, 1);
    }
}

/* What was done since a mark, less what made matrices of modes that recur: it is not needed again. */
static double lasting(ns_work work, const ns_work *from) {
    const double events = work.events - from->events, modes = work.modes - from->modes,
                 recurring = events > 0 ? fmax(0, 1 - modes / events) : 0;
    return work.all - from->all - recurring * (work.once - from->once);
}

static double between(const ns_choice *c) {
    return fmax(c->interval, starts * c->start);
}

static int is_dear_at(const ns_choice *c, double work, double events, double most) {
    return work > early * between(c) && work > most * (events + 1);
}

/* 1 if the one at work has begun to crawl: over the last stretch, which is counted from there on. */
static int has_slowed_down(ns_choice *c, double t, ns_work work) {
    const ns_choice_mark *from = &c->recent[0];
    const double needs = lasting(work, &from->work);
    if (needs > c->patience && t > from->t && needs > crawls * c->usual * (t - from->t)) {
        c->owed += from->work.all - c->from.work.all;
        c->from = *from;
        return 1;
    }
    if (work.all - c->recent[1].work.all > c->patience) {
        c->recent[0] = c->recent[1];
        c->recent[1] = (ns_choice_mark){t, work};
    }
    return 0;
}

/* One that crawls may do so through events that the other one has not, which steps over a ring of them. */
static int is_slow_beside_all(const ns_choice *c, double t, ns_work work, double rate) {
    return rate * (t - c->begin.t) > crawls * (work.all - c->begin.work.all);
}

static ns_choice_answer look_at_chosen(ns_choice *c, double t, ns_work work, ns_choice_bounds event) {
    const int is_slow = has_slowed_down(c, t, work);
    const ns_work *from = &c->from.work;
    const double spent = work.all - from->all, gained = t - c->from.t, events = work.events - from->events,
                 needs = lasting(work, from);
    const int is_dear =
        c->is_early && (is_dear_at(c, spent, events, event.most) ||
                        (event.starts && c->is_first && is_dear_at(c, work.all, work.events, event.most)));
    if ((spent < between(c) && !is_slow && !is_dear) || !(gained > 0))
        return NS_CHOICE_STAY;
    c->crawl = is_slow ? needs : 0;
    c->is_early = 0;
    c->calm = is_slow ? c->usual : needs / gained;
    c->usual = needs / gained;
    c->per_event = events < FEW ? 0 : needs / (events + 1); /* a few say nothing of others */
    c->recurs = events > recurring * (work.modes - from->modes);
    if (is_slow || is_slow_beside_all(c, t, work, needs / gained) ||
        clearly * needs >= event.least * events + event.mode * (work.modes - from->modes))
        return NS_CHOICE_CHANGE;
    wait(c, t, work, 1);
    return NS_CHOICE_STAY;
}

/* It stays; what the other one took does not count for its matrices.  Two that come back to one another cost
 * about the same: they ask ever less. */
static void keep_asked(ns_choice *c, double t, ns_work work, double events) {
    const double spent = fmax(work.all - c->from.work.all, least_part * c->whole);
    c->usual = fmin(clearly * c->usual, spent / (t - c->from.t));
    c->is_early = events < FEW;
    c->patience = soon * c->first;
    wait(c, t, work, c->kept > 0 && !(c->crawl > 0) ? later : 1);
    c->kept += !(c->crawl > 0);
    c->owed = 0;
}

static ns_choice_answer look_at_asked(ns_choice *c, double t, ns_work work) {
    const double spent = work.all - c->from.work.all, once = work.once - c->from.work.once,
                 events = work.events - c->from.work.events,
                 other = fmax(c->usual * (t - c->from.t), /* what the one before would have spent */
                              c->per_event * events),
                 whole = c->whole;
    if (other >= whole && spent < clearly * other) {
        keep_asked(c, t, work, events);
        return NS_CHOICE_STAY;
    }
    if (c->again > 0)
        return work.all >= c->again ? NS_CHOICE_CHANGE : NS_CHOICE_STAY;
    /* it may have made all its matrices; or be amid a transient that it is through before the other one is */
    const int is_hopeful = (spent - once < clearly * other && work.all < c->until) ||
                           (spent < other && other >= whole && whole < c->interval);
    const int is_over = spent > whole || (spent > whole / 4 && spent > hopeless * other);
    if (is_over && !is_hopeful)
        return NS_CHOICE_CHANGE;
    if (is_over && other >= whole) { /* what was made so far may be all: the next part is longer */
        mark(c, t, work);
        c->whole *= 2;
    }
    return NS_CHOICE_STAY;
}

ns_choice_answer ns_march_choice_look(ns_choice *c, double t, ns_work work, ns_choice_bounds event) {
    return c->asks ? look_at_asked(c, t, work) : look_at_chosen(c, t, work, event);
}

void ns_march_choice_began(ns_choice *c, double took) {
    c->start = took;
}

void ns_march_choice_changed(ns_choice *c, double t, ns_work work) {
    if (c->asks) {
        const int crawled = c->crawl > 0;
        c->patience *= crawled ? later : 1;
        c->usual = c->calm;
        wait(c, t, work, crawled ? 1 : later);
        return;
    }
    mark(c, t, work);
    c->asks = 1;
    c->is_first = 0;
    c->whole = part * c->interval;
    if (c->crawl > 0) /* not more than was found to be too much */
        c->whole = fmin(c->whole, fmax(part * c->first, c->crawl));
    c->until = work.all + fmax(much * c->interval, c->recurs ? c->owed : 0);
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

double ns_march_choice_pause(const ns_choice *c) {
    return c->asks ? c->whole / 4 : c->patience / 2;
}

double ns_march_choice_limit(const ns_choice *c) {
    return c->asks && c->again == 0 ? c->until + much * c->interval : INFINITY;
}
