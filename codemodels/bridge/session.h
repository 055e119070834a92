/* bridge/session.h - one circuit of ngspice: the library integrates, ngspice shows. */
#ifndef BRIDGE_SESSION_H
#define BRIDGE_SESSION_H

#include <time.h>

#include "analysis.h"
#include "dc_rows.h"
#include "force.h"
#include "loop.h"
#include "source_check.h"

/* Of a waveform; written by waveform_points.c alone. */
typedef struct ns_bridge_next {
    int held;                /* there is a point that ngspice has not come to */
    ns_waveform_point point; /* at its t */
    int shown;               /* points that ngspice wrote, counted to NS_SHOWN_ENOUGH */
    int interpolated;        /* it does not write them but what lies between, at multiples of tstep */
} ns_bridge_next;

/* So many are written before it is known whether they are interpolated. */
enum { NS_SHOWN_ENOUGH = 2 };

/* Written by trial.c alone. */
typedef struct ns_bridge_trial {
    double t;           /* the accepted time, s: the marcher's, or when the right side of a jump is shown */
    int start_accepted; /* ngspice accepted the first point of the analysis */
    int made;           /* the marcher holds a trial; of it: */
    double t_end;       /* where it ends, s, as ngspice is to see it */
    int at_right_side;  /* it is the right side of the accepted point */
    int loaded;         /* its values are ngspice's present point */
    clock_t cpu;        /* of all trials, with option verbose */
} ns_bridge_trial;

typedef struct ns_session {
    CKTcircuit *ckt;

    /* --- once a circuit (analysis_start.c) --- */
    struct {
        int version_checked;       /* ngspice is the one this was built for */
        int circuit_announced;     /* its size was written */
        int steps_noted;           /* that a V jumps in products was */
        int currents_announced;    /* the vf of D at currents of their own were written */
        unsigned long long models; /* those of what was announced as taken */
        int curve_noted;           /* that a D is far from its own curve was written */
        int overvoltage_noted;     /* that a switch came to a voltage of no circuit was written */
        int dc_noted;              /* likewise, in .op or .dc */
        int reltol_noted;          /* that reltol has no effect was written */
    } once;

    /* --- the analysis (analysis_start.c) --- */
    ns_analysis analysis; /* empty between analyses */
    ns_own_found found;   /* by earlier passes of .tran */
    struct {              /* of .op and .dc; own_dc.c alone */
        size_t count;
        double *most; /* A, of each own device: its largest current so far */
    } dc;
    struct { /* own_again.c alone */
        size_t count;
        double *at; /* A, of each own device: at which its curve was read when that was written last */
    } again;
    ns_force force; /* of the present matrix */
    ns_loop loop;
    clock_t start_cpu; /* of the start */
    ns_source_check source_check;

    /* --- the present timepoint --- */
    ns_bridge_trial trial;
    ns_bridge_next next;
    int failed; /* code that ends the analysis; its line was written.  session.c */

    /* --- what is changed in ngspice until the next load --- */
    ns_dc_rows dc_rows;
    struct {
        int armed; /* the next point is to be loaded once */
        long mode; /* ngspice's, meanwhile */
    } single_load; /* single_load.c */
} ns_session;

/* Functions that return int, but for those whose comment says 1, return OK or a code of ngspice after one
 * line on the console. */

/* --- session.c: what ngspice calls --- */

/* After all other devices have loaded: forces the solution. */
int ns_bridge_session_load(ns_session *s);

/* When ngspice accepted a timepoint: accepts it, shows it, and sets the next one. */
int ns_bridge_session_accept(ns_session *s);

/* Before the matrix is freed: forgets the analysis.  clear: the circuit is freed. */
void ns_bridge_session_reset(ns_session *s);
void ns_bridge_session_clear(ns_session *s);

/* --- analysis_start.c --- */

/* Before a setup of one of our types: is this the version of ngspice, and the configuration, that this was
 * made for? */
int ns_bridge_analysis_check_setup(const CKTcircuit *ckt);

/* Checks the version of ngspice, its options and all elements. */
int ns_bridge_analysis_check(ns_session *s);

/* Leaves the operating point, or the start from rest (uic), in s->force.value. */
int ns_bridge_analysis_start(ns_session *s);

/* After `resume`: if something was altered, restarts from the present charges and fluxes. */
int ns_bridge_analysis_resume(ns_session *s);

void ns_bridge_analysis_end(ns_session *s);

/* --- own_again.c --- */

/* A line about the D whose curve is read at another current than was written, if that is far from it.
 * announced: all are written now. */
int ns_bridge_own_again(ns_session *s, int announced);
void ns_bridge_own_again_clear(ns_session *s);

/* --- own_dc.c --- */

/* A point of .op or .dc was computed: one line, once a circuit, if a D carries far more or less than was
 * guessed. */
int ns_bridge_own_dc_point(ns_session *s);
void ns_bridge_own_dc_clear(ns_session *s);

/* --- look_ahead.c --- */

/* Tries to integrate to the next event or output time and sets ngspice's step to it.  first: the present
 * point is the start. */
int ns_bridge_look_ahead(ns_session *s, int first);

/* --- waveform_points.c: the same where the waveform chooses the timepoints --- */

/* The marcher was started or (from: the waveform until then) restarted at t, s, and ns_bridge_trial_begin()
 * was called. */
int ns_bridge_waveform_begin(ns_session *s, double t, const ns_waveform *from);

/* Chooses the next point and sets ngspice's step to it. */
int ns_bridge_waveform_look_ahead(ns_session *s, int first);

/* The values of ngspice's present timepoint into s->force.value. */
int ns_bridge_waveform_load(ns_session *s);

/* --- trial.c: what the marcher is asked to try, and accepts --- */

/* Forgets all: an analysis begins. */
void ns_bridge_trial_clear(ns_session *s);

/* The marcher was started or restarted: reads its point and time. */
int ns_bridge_trial_begin(ns_session *s);

/* Tries to integrate to time t, s. */
int ns_bridge_trial_to(ns_session *s, double t, ns_until until);

/* Reads the point of the trial, or the accepted one, into s->analysis; with _values also into s->force.value,
 * what ngspice's solve is to return. */
int ns_bridge_trial_read(ns_session *s);
int ns_bridge_trial_read_values(ns_session *s);

/* The values of ngspice's present timepoint into s->force.value; anew: even if they are there. */
int ns_bridge_trial_load(ns_session *s, int anew);

/* Accepts the trial, as the point that ngspice sees at t. */
void ns_bridge_trial_accept(ns_session *s, double t);
void ns_bridge_trial_drop(ns_session *s);

/* ngspice accepted its point: accepts the trial if that was it.  1 at the first point of an analysis. */
int ns_bridge_trial_accept_loaded(ns_session *s);

/* The values that were loaded for time t, s, are shown: they are not the marcher's trial. */
void ns_bridge_trial_show(ns_session *s, double t);

/* The time, s, at which the right side of a jump at the accepted time is shown: later, as ngspice's time must
 * advance, and well before t, the end of the trial. */
double ns_bridge_trial_right_side(const ns_session *s, double t);

/* Writes one line on why the marcher's last call failed; returns ngspice's code for status. */
int ns_bridge_trial_fail(const ns_session *s, int status);
/* The same; the hint is written behind it. */
int ns_bridge_trial_fail_with(const ns_session *s, int status, const char *hint);

/* --- start_check.c --- */

/* The operating point at analysis.x is the one that the march started from: one line if that left it at once.
 */
void ns_bridge_start_check(const ns_session *s, int may_rest_between);
/* Says so, and is 1, where a comparator begins between its two values. */
int ns_bridge_start_check_latches(const ns_session *s);
/* Where there is no operating point: 1 if the circuit starts with uic. */
int ns_bridge_start_check_uic(const ns_analysis *a);

/* --- single_load.c: one load a timepoint, where ngspice would solve twice --- */

/* After a point is shown: the next is to be loaded once. */
void ns_bridge_single_load_arm(ns_session *s);

/* At the beginning of a load: 1 if it is the only one of its point; _end() then leaves s->force.value as
 * solution. */
int ns_bridge_single_load_begin(ns_session *s);
void ns_bridge_single_load_end(ns_session *s);

/* Takes back what _arm() did. */
void ns_bridge_single_load_forget(ns_session *s);

#endif
