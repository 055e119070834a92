/* src/march/run_internal.h - shared by run.c, run_handover.c, run_choose.c, run_check.c, run_watch.c,
 * run_again.c, run_refuse.c, run_start.c, run_check_start.c. */
#ifndef NS_MARCH_RUN_INTERNAL_H
#define NS_MARCH_RUN_INTERNAL_H

#include "choice.h"
#include "march_internal.h"
#include "run_check.h"
#include "select.h"

/* What an engine of a run is: the exact one with the ladder; the sparse one; steps of the theta scheme. */
typedef enum ns_run_kind { NS_RUN_DENSE, NS_RUN_SPARSE, NS_RUN_SCHEME } ns_run_kind;

typedef struct ns_run {
    ns_engine engine;
    /* what is integrated */
    const ns_system *s;
    ns_system *dense_copy; /* of a large system, once the dense engines were used; then it is s */
    ns_march_options options;
    /* by what */
    ns_engine *at_work;
    ns_run_kind kind;
    int is_dense;       /* it is a dense run */
    double scheme_step; /* s: of the scheme in place of a kernel, if it is shorter than else; 0: it is not */
    int trial_is_start; /* the trial is the start of the engine at work */
    int ladder_rests, ladder_rest; /* trials by the ladder until one is judged: from now on, in turn */
    ns_engine *aside;              /* NULL, or one that was at work and may be again */
    ns_run_kind aside_kind;
    /* back to the engine that failed, or was found wrong */
    double back_at;          /* s; INFINITY: it is at work */
    double back_interval;    /* s */
    double back_from_scheme; /* s: sooner, if the scheme is in its place; */
    double scheme_stay;      /* s: after so long; */
    double back_work;        /* instructions of all engines: sooner, if the other kernel comes to that */
    ns_run_kind back_to;
    /* which engine costs less */
    ns_choice choice;
    double may_spend;    /* instructions of an engine's start, for a question; 0: there is no bound */
    int was_cut_off;     /* 1: by that, while a trial is gone again */
    int chooses;         /* 1: there are two to choose from */
    long trials;         /* so far */
    double accepted_t;   /* s: of the last point that was accepted */
    int is_right_side;   /* 1: of the time of the one before, by NS_TO_STEP: the right side of an event, where
                          * a switch that the state controls changed */
    ns_mode *switched;   /* nc: modes of such switches at that point */
    int by_steps;        /* 1: the last trial was with NS_TO_STEP */
    ns_work work_before; /* of engines that are gone */
    /* what is told */
    ns_counts before, sum; /* of the engines that were at work before; of all */
    ns_fault fault;        /* of dense engines that could not be made; of what no engine does right: */
    int refused;           /* 1: the last call failed with that */
    ns_fault failed; /* of the first engine that failed in a retry, and named pairs; status NS_OK: none did */
    ns_run_check check;
} ns_run;

/* What a start begins with. */
typedef struct ns_run_start {
    double t; /* s */
    int is_dc;
    /* either charges and fluxes (n), and switches that are closed (nc, or NULL); */
    const double *w;
    const unsigned char *closed;
    /* or an operating point, with some unknowns held; x (n, or NULL) gets it */
    int nhold;
    const int *hold;
    const double *hold_x;
    double *x;
} ns_run_start;

/* run_start.c: by the engine at work, or if that is wrong by another one.  Errors: those of a start, RESIDUAL
 * (all are wrong). */
int ns_march_run_start(ns_run *r, const ns_run_start *asked);
/* run_check_start.c: what the engine at work answers after a start; x is not NULL.  1: it is right. */
int ns_march_check_start(ns_run *r, const ns_run_start *s);

/* run_handover.c: the engine that the options ask for is made.  Errors: as ns_march_create(). */
int ns_march_run_make_engine(ns_run *r, ns_fault *fault);
/* The dense engines in place of the sparse one, before a start at t.  Errors: as ns_march_create(). */
int ns_march_run_use_dense(ns_run *r, double t);
/* The dense engines go on from the accepted point of the sparse one.  Errors: also those of a start. */
int ns_march_run_leave_sparse(ns_run *r);
/* How another engine begins: by begin, of data; the one that was at work is kept aside, or freed. */
typedef struct ns_run_change {
    int (*begin)(ns_run *r, const void *data);
    const void *data;
    int keeps;
} ns_run_change;
/* An engine of a kind is put to work and begins; if it fails, the one that was at work is so again.  Errors:
 * as ns_march_create(), those of begin. */
int ns_march_run_change(ns_run *r, ns_run_kind kind, const ns_run_change *how);
/* The same from the accepted point on.  Errors: as ns_march_create(), those of a start, RESIDUAL. */
int ns_march_run_leave_for(ns_run *r, ns_run_kind kind, int keeps);
/* 1 if the point of *t is accepted, no trial is known, and nothing happens there: engines may change. */
int ns_march_run_rests(ns_run *r, double *t);
/* The accepted point, as charges and fluxes w (n) and commanded switches that are closed (nc).  The caller
 * frees both, also after an error.  Errors: MEMORY, those of ns_engine_read(). */
int ns_march_run_read_accepted(ns_run *r, double *t, double **w, unsigned char **closed);
/* An engine of a kind, not at work.  Errors: as ns_march_create(). */
int ns_march_run_make(ns_run *r, ns_run_kind kind, ns_engine **out);
/* 1 if the engine at work is the sparse one, and the dense ones may do what it returned this status of. */
int ns_march_run_sparse_failed(const ns_run *r, int status);
void ns_march_run_put_to_work(ns_run *r, ns_engine *e, ns_run_kind kind);
/* The longest step of the scheme in place of a kernel, s. */
double ns_march_run_scheme_step(const ns_run *r);
/* An engine that was at work is freed; what it did counts. */
void ns_march_run_dismiss(ns_run *r, ns_engine *was);
void ns_march_run_forget(ns_run *r, ns_engine *e); /* the same, but for what is told; NULL is allowed */
/* The engine that was at work until t, of this kind, failed or was found wrong: it is asked again later; if
 * the scheme is in its place, after `stay` s at the soonest (INFINITY: as long as that is else). */
void ns_march_run_leave_for_now(ns_run *r, double t, ns_run_kind was, double stay);
/* The same of a start at t: it is asked again when a trial goes on from there, where nothing jumps any more.
 */
void ns_march_run_leave_for_the_start(ns_run *r, double t, ns_run_kind was);
/* That is due: it goes on from the accepted point, if it starts there. */
void ns_march_run_return(ns_run *r);

/* counts.c: of all engines. */
ns_work ns_march_run_work(ns_run *r);
/* run_choose.c: where one starts, at t. */
void ns_march_run_begin_choice(ns_run *r, double t);
/* Before a trial: the other engine goes on if it is to be asked, or to stay. */
void ns_march_run_choose(ns_run *r, ns_until until);
/* A trial to t failed.  1: another engine is at work, at the accepted point, or (r->trial_is_start) at
 * *reached, where the trial ends, or the same one, with more work to do; else *status may be another one. */
int ns_march_run_hand_over(ns_run *r, double t, ns_until until, double *reached, int *status);
/* The engine that was at work until t was found wrong; another one is at work, if it is the scheme for `stay`
 * s at least. */
void ns_march_run_was_wrong(ns_run *r, double t, ns_run_kind was, double stay);

/* run_check_create.c: Errors: MEMORY. */
int ns_march_check_create(ns_run *r);
void ns_march_check_free(ns_run *r);
void ns_march_check_attach(ns_run *r); /* another engine is at work */
/* What it answers may be off by: in its steps; at a start. */
void ns_march_check_scale(ns_run *r);
void ns_march_check_scale_start(ns_run *r);
void ns_march_check_reset(ns_run *r); /* before a start */
void ns_march_check_renew(ns_run *r); /* an input was replaced */
/* run_check.c: Before a trial to t.  Returns to where it is to go: to t, or to the event before it.
 * r->check.found: what was looked at on the way is wrong. */
double ns_march_check_begin(ns_run *r, double t, ns_until until);
/* After it.  1: it is right, as far as it was looked at; else r->check.finding. */
int ns_march_check_end(ns_run *r, double t, ns_until until, double reached);
/* r->check.here as a point; from that of ns_verify_left() to it by r->check.impulse.  1: it is right. */
int ns_march_check_point(ns_run *r, double t, ns_side side);
int ns_march_check_shown(ns_run *r, double t, ns_side side, const double *y); /* y (m, or NULL) too */
int ns_march_check_event(ns_run *r);

/* run_sliding.c: the point that was judged last, a right one.  0: a switch slides there although another
 * device is not the same while it is open and while it is closed; r->check.finding.  The fault of a run that
 * ends there. */
int ns_march_sliding_is_limit(ns_run *r, const ns_verify_state *at);
int ns_march_sliding_refuse(ns_run *r, const ns_verify_finding *f);
static inline int ns_march_sliding_is_cause(const ns_run *r) {
    return r->check.found && r->check.finding.cause == NS_VERIFY_CHATTER;
}
void ns_march_sliding_free(ns_run_check *k);

/* For run_watch.c: more may be spent; r->check.here as a point; errors of the engine at work are measured; a
 * point that is judged in a hurry, and in full if it is not clearly right then. */
void ns_march_check_earn(ns_run_check *k, double gain);
ns_verify_state ns_march_check_state(const ns_run *r, double t, ns_side side, const double *y);
int ns_march_check_quickly(ns_run *r, double t, ns_side side, const double *y);

/* run_watch.c: of r->check.watch; data: the run. */
ns_watch_part ns_march_watch_wants(void *data, ns_watch_side side, const ns_mode *mode);
int ns_march_watch_sees(void *data, ns_watch_side side, double t);

/* run_scheme.c: a quarter of the longest step of the scheme in place of a kernel, or of a trial, of so many
 * s. */
double ns_march_run_finer_step(const ns_run *r, double length);
/* 1: the trial by the scheme from there to `end` comes to the charges and fluxes that steps of a quarter come
 * to. */
int ns_march_run_is_believed(ns_run *r, const ns_run_start *from, double end);
/* The same of a trial of the dense engines to t, from the accepted point; it is made again. */
int ns_march_run_ladder_is_believed(ns_run *r, double t, ns_until until, double end);

/* run_again.c: a trial that was found wrong, by other engines.  Errors: RESIDUAL (all are wrong), MEMORY. */
int ns_march_run_again(ns_run *r, double t, ns_until until, double *reached);
/* 1 if a part of a trial to t was gone by the ladder, for long because the exact engine can build no
 * matrices, or to other charges and fluxes than shorter steps come to: its steps are of first order, and
 * nobody judged how their errors add up.  That is what was found then. */
int ns_march_run_is_rough(ns_run *r, double t, ns_until until, double reached);
/* run_refuse.c: what was found in the point r->check.here is excused, if it is the sign of a pair that is
 * right 64 roundings of the time later, or before the charge that it carries counts, by the engine at work,
 * and the pair moves there in a straight line; then again(r, data) judges anew, and so on, of some pairs.  1:
 * it was right. */
int ns_march_run_goes_excused(ns_run *r, int (*again)(ns_run *r, const void *data), const void *data);
/* A small error that no engine is without: 1: such errors are allowed from now on.  What no engine does right
 * is refused: RESIDUAL. */
int ns_march_run_allows(ns_run *r, const ns_verify_finding *f);
int ns_march_run_refuse(ns_run *r, const ns_verify_finding *f);
int ns_march_run_refuse_failed(ns_run *r); /* by r->failed; its status */

#endif
