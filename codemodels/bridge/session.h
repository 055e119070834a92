/* bridge/session.h - one circuit of ngspice: the library integrates, ngspice shows. */
#ifndef BRIDGE_SESSION_H
#define BRIDGE_SESSION_H

#include <time.h>

#include "analysis.h"
#include "dc_rows.h"
#include "force.h"
#include "loop.h"

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
        int version;   /* that ngspice is the one this was built for */
        int circuit;   /* how large the circuit is */
        int no_reltol; /* that reltol has no effect */
    } said;

    /* --- the analysis (analysis_start.c) --- */
    ns_analysis analysis; /* empty between analyses */
    ns_force force;       /* of the present matrix */
    ns_loop loop;
    int refused;       /* it is of a kind that would show nonsense */
    clock_t start_cpu; /* of the start */

    /* --- the present timepoint --- */
    ns_bridge_trial trial;
    int failed; /* code that ends the analysis; its line was written.  session.c */

    /* --- what is changed in ngspice for a while --- */
    ns_dc_rows dc_rows;
    struct {
        int armed; /* the next point is to be loaded once */
        long mode; /* ngspice's, meanwhile */
    } single_load; /* single_load.c */
} ns_session;

/* After all other devices have loaded: forces the solution.  OK or a code of ngspice. */
int ns_bridge_session_load(ns_session *s);

/* When ngspice accepted a timepoint: accepts it, shows it, and sets the next one. */
int ns_bridge_session_accept(ns_session *s);

/* Before the matrix is freed: forgets the analysis. */
void ns_bridge_session_reset(ns_session *s);

/* The circuit is freed. */
void ns_bridge_session_clear(ns_session *s);

#endif
