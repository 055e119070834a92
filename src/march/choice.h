/* src/march/choice.h - which of two engines costs less: decided by the work that each needs for a second of
 * the circuit's time.
 *
 * One engine is at work, the other one is asked now and then: it goes on for a while, and stays if it needs
 * less.  What it is asked costs a small part of all work, as the work between two questions doubles each time
 * the answer was no.  Decisions only: nothing here runs an engine.
 */
#ifndef NS_MARCH_CHOICE_H
#define NS_MARCH_CHOICE_H

#include "engine/engine.h"

typedef enum ns_choice_answer {
    NS_CHOICE_STAY, /* the engine at work goes on */
    /* The other engine goes on from here: a question begins, or one ends because the engine that was asked
     * needs more. */
    NS_CHOICE_CHANGE,
} ns_choice_answer;

/* An instant of the circuit's time, and the work until then. */
typedef struct ns_choice_mark {
    double t; /* s */
    ns_work work;
} ns_choice_mark;

typedef struct ns_choice {
    int asks;         /* 1: the engine at work is the one that is asked */
    int is_first;     /* 1: it was not asked so far */
    int is_early;     /* 1: nothing is known of events by the one at work but what they cost so far */
    int kept;         /* how often one that was asked stayed */
    double usual;     /* work for a second, when it was chosen, of the one at work; while the other one is
                       * asked, of the one before; NAN: not known yet */
    double calm;      /* the same of the one before, without the stretch in which it crawled */
    double per_event; /* usual work for an event; 0: not known */
    double interval;  /* work between two questions, */
    double first;     /* and before the first one; */
    double patience;  /* work after which the other one may be asked because this one crawls, */
    double crawl;     /* and that of the stretch in which it did so; 0: it is asked as usual */
    double start;     /* work of the last start of the engine at work */
    double again;     /* work of all until it is tried again to leave the one that is asked, as the other one
                       * could not begin; 0: it was not tried */
    int recurs;       /* 1: modes did, when the other one was asked */
    double owed;  /* work of the engine at work, less that of the one that was asked, since one was chosen */
    double whole; /* work of the one before over which the one that is asked is compared */
    double until; /* work of all until which the one that is asked may make matrices */
    ns_choice_mark begin;     /* of the run */
    ns_choice_mark from;      /* where the engine at work began, or was chosen; */
    ns_choice_mark recent[2]; /* later than that, where it may have begun to crawl */
} ns_choice;

/* What the other engine needs for an event, matrices of a new mode included: at least, at most; for these
 * matrices alone. */
typedef struct ns_choice_bounds {
    double least, most; /* INFINITY: it is not known */
    double mode;
    int starts; /* 1: to begin with, what the start took counts too */
} ns_choice_bounds;

/* At a start; first: work after which the other engine is asked for the first time.  What was learnt of the
 * run before remains: c is zero at the first start. */
void ns_march_choice_begin(ns_choice *c, double t, ns_work work, double first);
/* At t; work: of all engines so far; event: the other one is not asked if the one at work needs less for an
 * event, and asked early if it needs more.  What is to be done; CHANGE: the caller calls
 * ns_march_choice_changed() when that is done, or ns_march_choice_failed(). */
ns_choice_answer ns_march_choice_look(ns_choice *c, double t, ns_work work, ns_choice_bounds event);
/* Before it: the start of the one that is at work now took so much of the work. */
void ns_march_choice_began(ns_choice *c, double took);
void ns_march_choice_changed(ns_choice *c, double t, ns_work work);
/* How much a trial through all events may take the engine at work. */
double ns_march_choice_trial(const ns_choice *c);
/* Before ns_march_choice_changed(), if a trial from `from` to t took it more. */
void ns_march_choice_cut_off(ns_choice *c, double from, double t);
/* The engine that is asked failed, or could not begin: the other one is at work (again). */
void ns_march_choice_failed(ns_choice *c, double t, ns_work work);
/* After a question that was answered no the other one could not begin here, which took so much of the work:
 * the one that is asked goes on for a while. */
void ns_march_choice_stuck(ns_choice *c, ns_work work, double took);
/* How much all engines may have done at most before the one that is asked has to have answered. */
double ns_march_choice_limit(const ns_choice *c);
/* How much a trial that may end anywhere may take before it does: then the choice is looked at. */
double ns_march_choice_pause(const ns_choice *c);

#endif
