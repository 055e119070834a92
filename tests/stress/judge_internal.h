/* tests/stress/judge_internal.h - the circuit that is judged, its runs, and how far they are apart.
 *
 *   judge.c  who is wrong    judge_runs.c  the runs    judge_theta.c  what the theta scheme says
 */
#ifndef NONSMOOTH_TESTS_JUDGE_INTERNAL_H
#define NONSMOOTH_TESTS_JUDGE_INTERNAL_H

#include "judge.h"

enum { NOBODY = -1 };

typedef struct judged {
    plan p;
    const netlist *text;
    run_result *result[J_RUNS];
    double scale[PLAN_PROBES]; /* the largest value of each signal */
} judged;

typedef struct difference {
    double most; /* relative to the signal's largest value */
    int probe, k;
} difference;

/* judge_runs.c: the one circuit that is judged; how each run is made. */
extern judged judge_of;
extern const run_setting judge_settings[J_RUNS];

/* The netlist is read, no run is made; NULL, or what is not understood. */
const char *judge_begin(const netlist *n);
void judge_start_run(int which, const judge_options *o);
/* Once the candidates have run: the scales. */
void judge_find_scales(void);
int judge_done(int run);
/* What a run has of a signal at time k, within RUN_BAND. */
double *judge_value(int run, int k, int band, int probe);
/* How far v is outside what run b has around time k. */
double judge_outside(int b, int k, int i, double v);
difference judge_between(int a, int b);
int judge_agree(int a, int b);

/* judge_theta.c: both runs of the scheme; 1: they are done. */
int judge_run_theta(const judge_options *o);
/* 1: in some signal the scheme is so sure of itself, and so far away, that the run is doubtful. */
int judge_theta_doubts(int run, difference *d);
/* The one of two runs that the scheme is nearer to by a factor of 3, in the signal in which they differ most.
 */
int judge_theta_votes(int a, int b);
/* The scheme of second order, which damps nothing, at each of three lengths of step: it is with that of first
 * order, and not with the run. */
int judge_second_order_agrees(int run_of, int i, const judge_options *o);
/* 1 if the scheme took fewer than four steps for each event of the run: it damps a ring that makes such
 * events, and is no witness. */
int judge_theta_is_too_coarse(int run_of);

#endif
