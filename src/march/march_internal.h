/* src/march/march_internal.h - runs: what integrates one system, or one system an island.
 *
 *   march.c     the public calls (watched.c: with thresholds that are watched)       partition_run.c,
 * partition_advance.c   a run for each island run.c, run_handover.c   one system: sparse or dense engines,
 * and the hand-over between them select.c    which of them          dense_run.c, dense_start.c   the exact
 * engine, and the ladder for the rest
 *
 * Each of them is an engine (engine/engine.h).
 */
#ifndef NS_MARCH_INTERNAL_H
#define NS_MARCH_INTERNAL_H

#include "engine/engine.h"

typedef struct ns_watched_thresholds ns_watched_thresholds;

/* The public object: one run, or one for each island. */
struct ns_march {
    const ns_system *s;
    ns_engine *engine;
    double accepted, reached;       /* s: times of the accepted point and of the last trial */
    double *corner;                 /* nz: the first corner of each input after corners_from, s; */
    double corners_from;            /* s; INFINITY: not known yet */
    double first_corner;            /* s: the first of them */
    unsigned char *followed;        /* nz: 1: corners of this input end trials with NS_TO_STEP */
    unsigned char *closed;          /* nc: switches that are closed where it starts */
    ns_watched_thresholds *watched; /* thresholds; NULL: none was ever watched */
    ns_counts counts;               /* the engine's, with looks */
};

/* Times nearer to each other than this part of them are one, for thresholds. */
#define NS_MARCH_TOGETHER (8 * DBL_EPSILON)

/* unwatched.c: as ns_march_try(), whatever is watched. */
int ns_march_try_unwatched(ns_march *m, double t, ns_until until, double *reached);

/* watched.c: a trial that ends where a threshold is crossed, if one is watched; it became the accepted point;
 * the marcher starts.  Errors of the first: those of ns_march_try() and ns_march_sample(). */
int ns_march_watched_try(ns_march *m, double t, ns_until until, double *reached);
void ns_march_watched_accept(ns_march *m);
void ns_march_watched_free(ns_march *m);

/* partition_run.c: a run for each island.  NULL in *out where the system is one island.  run.c: one run for
 * the whole system.  dense_run.c: the engines with dense matrices; s is not large (system.h).  Arguments and
 * errors as ns_march_create(). */
int ns_march_partition_create(const ns_system *s, const ns_march_options *o, ns_engine **out,
                              ns_fault *fault);
int ns_march_run_create(const ns_system *s, const ns_march_options *o, ns_engine **out, ns_fault *fault);
int ns_march_dense_create(const ns_system *s, const ns_march_options *o, ns_engine **out, ns_fault *fault);

/* When trials of the dense engines may end with LIMIT. */
typedef enum ns_dense_handover {
    NS_HANDS_OVER_NEVER,
    NS_HANDS_OVER_MODES, /* where the exact engine cannot build a mode */
    NS_HANDS_OVER_OFTEN  /* there, and where it fails too often */
} ns_dense_handover;

/* dense_run.c: when trials may end with LIMIT; 1 if the last one did. */
void ns_march_dense_let_hand_over(ns_engine *e, ns_dense_handover may);
int ns_march_dense_hands_over(const ns_engine *e);
/* 1: the ladder, whose errors nobody judges, went the trial in place of the exact engine; 0 again after the
 * trial was believed. */
int ns_march_dense_by_ladder(const ns_engine *e);
void ns_march_dense_believe(ns_engine *e);
/* For how long, s, the ladder went in it because the exact engine can build no matrices for a mode. */
double ns_march_dense_without_matrices(const ns_engine *e);
/* 1 if branch and bound was ended by a bound of work, in the last start or trial. */
int ns_march_dense_was_cut_off(const ns_engine *e);
/* The start made last was one amid a trial. */
void ns_march_dense_carry_start(ns_engine *e);

/* counts.c: sum += counts, each field. */
void ns_march_add_counts(ns_counts *sum, const ns_counts *counts);

#endif
