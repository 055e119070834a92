/* src/march/run_check.h - what a run knows of its checks: run_check.c, run_watch.c judge, run_again.c goes
 * again. */
#ifndef NS_MARCH_RUN_CHECK_H
#define NS_MARCH_RUN_CHECK_H

#include <stdint.h>

#include "engine/kernel.h"
#include "engine/watch.h"
#include "verify/verify.h"

/* Modes that were seen on the left of an event, and pairs of modes beside one, by their hash. */
enum { NS_RUN_SEEN = 256, NS_RUN_MODES = 1024 };

typedef struct ns_run_check {
    ns_verify *verify;
    ns_watch watch;  /* of the engine at work */
    double *numbers; /* the block of the following arrays */
    double *here;    /* n+m: a point */
    double *before;  /* n+m: what jumped before an event */
    double *impulse; /* n+m */
    double *nodes;   /* NS_VERIFY_NODES (n+m) */
    double *y;       /* m */
    double from;     /* s: of the accepted point, where the way of a trial begins */
    int knows_left;  /* 1: the trial goes from the left side of an event of the ladder, which is known */
    /* the trial */
    int is_old;                 /* 1: it was judged */
    double asked;               /* s: what it was asked for, */
    int until;                  /* and how */
    int found;                  /* 1: something is wrong, */
    ns_verify_finding finding;  /* namely */
    ns_watch_part left, right;  /* how much is looked at of the sides of the event that is resolved now */
    long looks;                 /* at events so far */
    int has_all;                /* 1: all of the point is known now, as it is shown */
    long jumped, jumped_before; /* 0: nothing did, by now; left of it.  It grows with each jump */
    double shortest;            /* s: the shortest ramp of an input */
    /* how often, in instructions or so: spent on a point, on a way, earned by a trial, by an event, by a mode
     */
    double point_cost, event_cost, way_cost, quick_cost, trial_cost, trial_gain, event_gain, mode_gain;
    int periods, periods_rest; /* that are repeated before one is looked at: from now on, in turn */
    long steps;                /* of the scheme, that were paid for */
    double credit;             /* what may be spent */
    int way_next;              /* 1: the next thing looked at is a way */
    unsigned long long dice;   /* state of the random numbers: where on a way it is looked at */
    uint64_t left_key;         /* of the mode on the left of an event */
    uint64_t *seen;            /* NS_RUN_SEEN: hashes of modes */
    uint64_t *modes_seen;      /* NS_RUN_MODES: hashes of those on the left of events; 0: none */
    long modes;                /* how often such a mode was new */
    unsigned char *times;      /* NS_RUN_SEEN: how often each came back since it was looked at */
    /* a trial that is gone again */
    long again_events;           /* so far, and one; 0: there is none */
    double again_from, again_to; /* s: from where, to what is asked for */
    /* switches that slide */
    const ns_mode *shown_mode; /* m: of the point that an engine shows now; NULL: that of the engine */
    ns_kernel *ends;           /* the circuit with one of them open, or closed; NULL: none slid so far */
    ns_guard *end_guards;      /* 2m+nc */
    unsigned char *end_broken; /* 2m+nc */
    double *end_w;             /* n */
    ns_mode *sliding_mode, *end_mode; /* m */
    int changes_too;                  /* the pair that changes with the one in finding */
    /* what is told */
    long checks, retries;
} ns_run_check;

#endif
