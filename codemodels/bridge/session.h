/* bridge/session.h - the native way: the library integrates, ngspice shows. */
#ifndef BRIDGE_SESSION_H
#define BRIDGE_SESSION_H

#include <time.h>

#include "extract.h"
#include "force.h"
#include "nonsmooth/march.h"
#include "timepoints.h"

/* What is read of a circuit and made of it, replaced as a whole. */
typedef struct ns_analysis {
    ns_extract ex;
    ns_system *system;
    ns_march *march;
    double h;           /* the longest step of the scheme, s */
    int *unknown;       /* ex.neq: the unknown an equation stands for, -1: none */
    size_t count;       /* of x and lambda */
    double *room;       /* 3 count, of these: */
    double *x, *lambda; /* of the system, one after the other */
    double *before;     /* count: both as they were read the time before */
    double *most;       /* count: and their largest sizes so far */
    ns_mode *mode;      /* of the accepted point, */
    int shown;          /* whose devices are shown */
} ns_analysis;

int ns_bridge_analysis_make(CKTcircuit *ckt, ns_extract_sources sources,
                            ns_analysis *e); /* OK, or a code after one line */
void ns_bridge_analysis_clear(ns_analysis *e);

/* One circuit of ngspice. */
typedef struct ns_session {
    CKTcircuit *ckt;
    ns_analysis engine; /* empty between analyses */
    ns_force force;     /* of the present matrix */
    double *value;      /* by equation number: the solution to be forced */
    int *held;          /* nodes whose .ic or .nodeset flags are hidden from ngspice, as they were */
    int hidden;         /* flags are hidden */
    int announced;      /* that we take the circuit was said */
    int no_reltol;      /* that reltol has no effect was said */
    int checked;        /* the running ngspice was looked at */
    int fresh;          /* started, and the start not yet accepted */
    ns_timepoints_plan plan;
    int max_order; /* ngspice's maxord while it is 1; else 0 */
    int tried;     /* the march holds a trial that ends at t_trial */
    int beside;    /* the trial is the right side of the accepted point */
    int loaded;    /* ngspice's present point shows that trial */
    struct {
        int armed; /* the next point is to be loaded once */
        long mode; /* ngspice's, meanwhile */
    } once;        /* single_load.c */
    int refused;   /* this analysis is not for us */
    int failed;    /* code to end the analysis with; the line was said */
    double t;      /* accepted: the march's, or where the right side of a jump is shown */
    double t_trial;
    clock_t cpu; /* of the start and, if verbose, of the way since */
} ns_session;

/* Every analysis and every `resume` sets ckt->CKTtrtol anew: this value tells that neither happened since. */
#define NS_BRIDGE_TRTOL 1e30

/* Is everything something we can take?  OK, or a code after one line. */
int ns_bridge_analysis_check(ns_session *b);

/* After all other devices have loaded: forces the solution.  OK or a code of ngspice. */
int ns_bridge_session_load(ns_session *b);

/* When ngspice accepted a timepoint: accepts it, shows it, looks ahead and sets the next one. */
int ns_bridge_session_accept(ns_session *b);

/* The matrix goes: forgets the analysis.  ns_bridge_session_clear() forgets all. */
void ns_bridge_session_reset(ns_session *b);
void ns_bridge_session_clear(ns_session *b);

/* --- for the files of the native way --- */

/* Says what the marcher's last call failed with; returns the code, kept in b->failed. */
int ns_bridge_session_fail(ns_session *b, int status);

/* The point of the last trial, or the accepted one, into engine.x, engine.lambda, what was there into
 * engine.before; *t (may be NULL) gets its time.  OK, or a code after one line: all is as it was. */
int ns_bridge_session_read(ns_session *b, double *t);

/* Begins an analysis: leaves the operating point, or the start from rest (uic), in b->value. */
int ns_bridge_analysis_start(ns_session *b);

/* Makes ngspice's loop ours: no truncation error, and the plan of points.  native_release() gives back. */
void ns_bridge_session_take_loop(ns_session *b);
void ns_bridge_session_release_loop(ns_session *b);

/* After `resume`: if something was altered, goes on from the present charges and fluxes. */
int ns_bridge_analysis_resume(ns_session *b);

void ns_bridge_dc_rows_hide(ns_session *b);
void ns_bridge_dc_rows_show(ns_session *b);

#endif
