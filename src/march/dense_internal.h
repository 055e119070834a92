/* src/march/dense_internal.h - shared by dense_run.c, dense_trial.c, dense_sample.c and dense_start.c. */
#ifndef NS_MARCH_DENSE_INTERNAL_H
#define NS_MARCH_DENSE_INTERNAL_H

#include "exact/exact.h"
#include "ladder/ladder.h"
#include "march_internal.h"

typedef struct ns_dense_run {
    ns_engine engine;
    /* what it integrates, and by what */
    const ns_system *s;
    ns_march_options options;
    ns_theta *step; /* holds charges, fluxes, mode and rates of the point */
    ns_ladder *ladder;
    ns_exact *exact; /* NULL: all steps are the scheme's */
    /* the trial, and the accepted point; saved and restored together with the stepper's past */
    ns_dense_point trial, accepted;
    double *past;       /* the stepper's, at the accepted point */
    ns_instant instant; /* what jumped in the trial, or in the start */
    double *carried;    /* n+m: what jumped in a start amid a trial, which counts with that; */
    int carries;        /* 1: so it does; 2: until the next trial */
    ns_mode *guess;     /* m: of the next start, */
    int has_guess;      /* 1: if it has one */
    /* the last trial */
    int started, has_trial;
    int moved;    /* the stepper and `trial` are not as they were accepted */
    double asked; /* s: what it was asked for */
    ns_until until;
    struct {
        int is_line;              /* 1: a straight line, the ladder's; 0: the exact engine's */
        int is_after_event;       /* 1: of that line only the end counts */
        int end_known;            /* 1: `end` is */
        double *begin, *end, *at; /* n+m: x, lambda at its ends, and between; NULL: not needed yet */
    } way;                        /* from the accepted point to the end of a trial with NS_TO_STEP */
    struct {
        int known;  /* 1: of the last trial, by the exact engine */
        double *at; /* n+m: x, lambda */
    } sampled[2];   /* at its begin and its end, which are asked for more than once */
    ns_dense_handover may_hand_over;
    int was_cut_off;         /* branch and bound was, in the last start or trial */
    int hands_over;          /* the last trial ended with LIMIT by that */
    int by_ladder;           /* 1: the ladder went the trial in place of the exact engine */
    double without_matrices; /* s that the ladder went in it because the exact engine has none for a mode */
    /* what is told */
    ns_counts counts;
    ns_fault fault;
} ns_dense_run;

/* dense_trial.c: keeps the status, the time and the stepper's fault of a failure, and returns the status;
 * back to the accepted point; the trial becomes the accepted point (STATE: there is none). */
int ns_march_dense_fail(ns_dense_run *r, int status);
void ns_march_dense_drop(ns_dense_run *r);
void ns_march_dense_clear_instant(ns_dense_run *r); /* nothing jumped */
int ns_march_dense_accept(ns_dense_run *r);
/* What branch and bound may take from now on: so many instructions, or what a question leaves.
 */
void ns_march_dense_bound_search(ns_dense_run *r, double most);

/* dense_sample.c: the ladder goes on with a trial with NS_TO_STEP, from_event: an event is resolved first.
 * Errors: MEMORY.  sample and shortest of the table. */
int ns_march_dense_begin_line(ns_dense_run *r, int from_event);
int ns_march_dense_sample(ns_engine *e, double t, double *x, double *lambda);
double ns_march_dense_shortest(ns_engine *e, double t, double *until);

/* dense_start.c: start, start_dc and guess of the table. */
void ns_march_dense_guess(ns_engine *e, const ns_mode *mode);
int ns_march_dense_start(ns_engine *e, double t0, const double *w0, const unsigned char *closed);
int ns_march_dense_start_dc(ns_engine *e, double t0, int nhold, const int *hold, const double *hold_x,
                            double *x);

#endif
