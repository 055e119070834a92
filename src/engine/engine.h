/* src/engine/engine.h - what an engine is: a table of functions.
 *
 * An engine integrates one system from a start on: it tries a step to some time, which may be repeated with
 * another time, and accepts it.  march/ asks engines through this table only; exact, sparse and ladder know
 * no other engine.  One that cannot go on returns an error, its accepted point stays, and march/run_choose.c
 * and run_handover.c start another one from there.
 */
#ifndef NS_ENGINE_H
#define NS_ENGINE_H

#include "nonsmooth/march.h"
#include "watch.h"

#include <math.h>

typedef struct ns_engine ns_engine;

/* What an engine did since it was made: about as many instructions, the same on every machine. */
typedef struct ns_work {
    double all;
    double once;   /* the part of all that made matrices and factors of modes, which are kept */
    double events; /* how many events it passed: a number, no instructions */
    double modes;  /* how many of them ended a mode that was not seen before; who asks fills it in */
} ns_work;

/* Each function does what the call of nonsmooth/march.h of the same name does, for this engine. */
typedef struct ns_engine_table {
    void (*free)(ns_engine *e);
    /* As ns_march_start(), with commanded switches closed as in closed (nc; NULL: as the commands say), as
     * far as their controls allow it. */
    int (*start)(ns_engine *e, double t0, const double *w0, const unsigned char *closed);
    int (*start_dc)(ns_engine *e, double t0, int nhold, const int *hold, const double *hold_x, double *x);
    int (*try_to)(ns_engine *e, double t, ns_until until, double *reached);
    void (*drop)(ns_engine *e); /* forgets the trial */
    int (*accept)(ns_engine *e);
    int (*read)(ns_engine *e, double *t, double *x, double *lambda, double *y);
    int (*impulse)(ns_engine *e, double *x, double *lambda); /* arrays as of ns_march_impulse(), or NULL */
    const ns_mode *(*mode)(ns_engine *e);
    int (*at_event)(const ns_engine *e);
    ns_method (*method)(const ns_engine *e); /* in use for the last trial */
    const ns_counts *(*counts)(ns_engine *e);
    ns_work (*work)(ns_engine *e); /* estimated from counts alone; NULL: not known */
    const ns_fault *(*fault)(const ns_engine *e);
    int (*sample)(ns_engine *e, double t, double *x, double *lambda);
    double (*shortest)(ns_engine *e, double t, double *until); /* until is not NULL */
    /* Unknown i is at most so far from a straight line between the ends of the way of a trial, which were
     * sampled; INFINITY: it is not known.  NULL: of none. */
    double (*bend)(const ns_engine *e, int unknown);
    int (*problem)(const ns_engine *e, ns_mlcp *p, double *h); /* NULL: STATE, it is never written out */
    /* The point of the trial as it is at hand: x (n) of the unknowns that charges and devices depend on,
     * lambda (m). Nothing changes by it.  NULL, or STATE: read() is to be asked. */
    int (*peek)(ns_engine *e, double *x, double *lambda);
    void (*watch)(ns_engine *e, const ns_watch *w); /* w outlives e, or NULL; NULL: nothing is shown */
    /* As ns_march_set_input(), whose checks were made; the engine's system has the signal already, copies of
     * that system have not. */
    int (*set_input)(ns_engine *e, int input, const ns_signal *signal);
    /* The next start with start() is in this mode (m; copied), where it holds.  NULL: it finds one itself. */
    void (*guess)(ns_engine *e, const ns_mode *mode);
    /* Errors of its steps are allowed less from now on; 0: no less than before.  NULL: they are not chosen.
     */
    int (*be_finer)(ns_engine *e);
    /* The engine that answers drop, accept, read, impulse, mode, at_event, method, fault, sample, shortest
     * and problem, those of them that the table has not; NULL: this one. */
    ns_engine *(*at_work)(const ns_engine *e);
} ns_engine_table;

/* The first member of every engine's struct. */
struct ns_engine {
    const ns_engine_table *table;
    double
        most_work; /* a trial that would make work() more than this fails with LIMIT; 0: there is no bound */
    double pause_work; /* a trial with NS_TO_STEP of an engine that counts its work ends where it is as soon
                          as that makes work() more than this; 0: it does not */
    double way_from; /* s: the way of a trial begins there: at the accepted point, or, if that is a start, at
                        the time it was asked for, some steps of h/2^20 before */
};

/* The engine that answers a call: this one, if its table has it, else the one at work. */
#define NS_ENGINE_FOR(e, call) ((e)->table->call || !(e)->table->at_work ? (e) : (e)->table->at_work(e))
static inline void ns_engine_drop(ns_engine *e) {
    e = NS_ENGINE_FOR(e, drop);
    e->table->drop(e);
}
static inline int ns_engine_accept(ns_engine *e) {
    e = NS_ENGINE_FOR(e, accept);
    return e->table->accept(e);
}
static inline int ns_engine_read(ns_engine *e, double *t, double *x, double *lambda, double *y) {
    e = NS_ENGINE_FOR(e, read);
    return e->table->read(e, t, x, lambda, y);
}
static inline int ns_engine_impulse(ns_engine *e, double *x, double *lambda) {
    e = NS_ENGINE_FOR(e, impulse);
    return e->table->impulse(e, x, lambda);
}
static inline const ns_mode *ns_engine_mode(ns_engine *e) {
    e = NS_ENGINE_FOR(e, mode);
    return e->table->mode(e);
}
static inline int ns_engine_at_event(ns_engine *e) {
    e = NS_ENGINE_FOR(e, at_event);
    return e->table->at_event(e);
}
static inline ns_method ns_engine_method(ns_engine *e) {
    e = NS_ENGINE_FOR(e, method);
    return e->table->method(e);
}
static inline const ns_fault *ns_engine_fault(ns_engine *e) {
    e = NS_ENGINE_FOR(e, fault);
    return e->table->fault(e);
}
static inline int ns_engine_sample(ns_engine *e, double t, double *x, double *lambda) {
    e = NS_ENGINE_FOR(e, sample);
    return e->table->sample(e, t, x, lambda);
}
static inline double ns_engine_shortest(ns_engine *e, double t, double *until) {
    e = NS_ENGINE_FOR(e, shortest);
    return e->table->shortest(e, t, until);
}
static inline double ns_engine_bend(const ns_engine *e, int unknown) {
    return e->table->bend ? e->table->bend(e, unknown) : INFINITY;
}
static inline int ns_engine_problem(ns_engine *e, ns_mlcp *p, double *h) {
    e = NS_ENGINE_FOR(e, problem);
    return e->table->problem ? e->table->problem(e, p, h) : NS_E_STATE;
}
static inline int ns_engine_peek(ns_engine *e, double *x, double *lambda) {
    return e->table->peek ? e->table->peek(e, x, lambda) : NS_E_STATE;
}
static inline void ns_engine_watch(ns_engine *e, const ns_watch *w) {
    if (e->table->watch)
        e->table->watch(e, w);
}

static inline void ns_engine_guess(ns_engine *e, const ns_mode *mode) {
    if (e->table->guess)
        e->table->guess(e, mode);
}

static inline int ns_engine_be_finer(ns_engine *e) {
    return e->table->be_finer && e->table->be_finer(e);
}
static inline ns_work ns_engine_work(ns_engine *e) {
    return e->table->work ? e->table->work(e) : (ns_work){0};
}
/* 1 if an engine that is at work itself has passed its bound. */
static inline int ns_engine_is_over(ns_engine *e) {
    return e->most_work > 0 && ns_engine_work(e).all > e->most_work;
}

#endif
