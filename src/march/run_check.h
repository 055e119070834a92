/* src/march/run_check.h - what a run knows of its checks: run_check.c judges, run_again.c goes again. */
#ifndef NS_MARCH_RUN_CHECK_H
#define NS_MARCH_RUN_CHECK_H

#include <stdint.h>

#include "engine/watch.h"
#include "verify/verify.h"

/* Modes that were seen on the left of an event, and pairs of modes beside one, by their hash. */
enum { NS_RUN_SEEN = 256 };

typedef struct ns_run_check {
    ns_verify *verify;
    ns_watch watch; /* of the engine at work */
    double *numbers;
    double *here;    /* n+m: a point */
    double *before;  /* n+m: what jumped before an event */
    double *impulse; /* n+m */
    double *nodes;   /* NS_VERIFY_NODES (n+m) */
    double *y;       /* m */
    double from;     /* s: of the accepted point, where the way of a trial begins */
    int doubts;      /* how often the sparse engine had errors that may be rounding */
    /* the trial */
    int is_old;                /* 1: it was judged */
    double asked;              /* s: what it was asked for, */
    int until;                 /* and how */
    int found;                 /* 1: something is wrong, */
    ns_verify_finding finding; /* namely */
    ns_watch_part looks_at;    /* of the right side of an event */
    int has_left;              /* 1: left is the left side of the event that is resolved now */
    /* how often, in instructions or so: spent on a point, on a way, earned by a trial, by an event */
    double point_cost, event_cost, way_cost, trial_gain, event_gain, period_gain;
    double credit;              /* what may be spent */
    int way_next;               /* 1: the next thing looked at is a way */
    unsigned long long dice;    /* where on it */
    uint64_t left_key;          /* of the mode on the left of an event */
    uint64_t seen[NS_RUN_SEEN]; /* hashes */
    /* what is told */
    long checks, retries;
} ns_run_check;

#endif
