/* bridge/native.h - the native way: the library integrates, ngspice shows. */
#ifndef BRIDGE_NATIVE_H
#define BRIDGE_NATIVE_H

#include <time.h>

#include "extract.h"
#include "force.h"
#include "nonsmooth/march.h"
#include "points.h"

/* What is read of a circuit and made of it, replaced as a whole. */
typedef struct engine {
    extract ex;
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
} engine;

int engine_make(CKTcircuit *ckt, extract_sources sources, engine *e); /* OK, or a code after one line */
void engine_clear(engine *e);

/* One circuit of ngspice. */
typedef struct native {
    CKTcircuit *ckt;
    engine engine; /* empty between analyses */
    force force;   /* of the present matrix */
    double *value; /* by equation number: the solution to be forced */
    int *held;     /* nodes whose .ic or .nodeset flags are hidden from ngspice, as they were */
    int hidden;    /* flags are hidden */
    int announced; /* that we take the circuit was said */
    int no_reltol; /* that reltol has no effect was said */
    int checked;   /* the running ngspice was looked at */
    int fresh;     /* started, and the start not yet accepted */
    points_plan plan;
    int max_order; /* ngspice's maxord while it is 1; else 0 */
    int tried;     /* the march holds a trial that ends at t_trial */
    int beside;    /* the trial is the right side of the accepted point */
    int loaded;    /* ngspice's present point shows that trial */
    struct {
        int armed; /* the next point is to be loaded once */
        long mode; /* ngspice's, meanwhile */
    } once;        /* once.c */
    int refused;   /* this analysis is not for us */
    int failed;    /* code to end the analysis with; the line was said */
    double t;      /* accepted: the march's, or where the right side of a jump is shown */
    double t_trial;
    clock_t cpu; /* of the start and, if verbose, of the way since */
} native;

/* Every analysis and every `resume` sets ckt->CKTtrtol anew: this value tells that neither happened since. */
#define NATIVE_MARK 1e30

/* Is everything something we can take?  OK, or a code after one line. */
int native_check(native *b);

/* After all other devices have loaded: forces the solution.  OK or a code of ngspice. */
int native_load(native *b);

/* When ngspice accepted a timepoint: accepts it, shows it, looks ahead and sets the next one. */
int native_accept(native *b);

/* The matrix goes: forgets the analysis.  native_clear() forgets all. */
void native_reset(native *b);
void native_clear(native *b);

/* --- for the files of the native way --- */

/* Says what the marcher's last call failed with; returns the code, kept in b->failed. */
int native_fail(native *b, int status);

/* The point of the last trial, or the accepted one, into engine.x, engine.lambda, what was there into
 * engine.before; *t (may be NULL) gets its time.  OK, or a code after one line: all is as it was. */
int native_read(native *b, double *t);

/* Begins an analysis: leaves the operating point, or the start from rest (uic), in b->value. */
int native_begin(native *b);

/* Makes ngspice's loop ours: no truncation error, and the plan of points.  native_release() gives back. */
void native_take_loop(native *b);
void native_release_loop(native *b);

/* After `resume`: if something was altered, goes on from the present charges and fluxes. */
int native_go_on(native *b);

void rows_hide(native *b);
void rows_show(native *b);

#endif
