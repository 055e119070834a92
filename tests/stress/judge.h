/* tests/stress/judge.h - runs a netlist several ways and says who is wrong.
 *
 * What a user gets ("auto", and "auto" with order and names shuffled, from time to time on a grid) and the
 * two kernels are compared.  If they differ by more than JUDGE_WRONG of a signal's largest value, references
 * are run: sparse at a reltol of 1e-12, and the theta scheme with small steps, which votes for the nearest.
 * Two methods that agree are right, unless a change of all values by 1e-8 moves them as far.  If all agree,
 * the theta scheme is asked whether it is somewhere else (options.theta).
 */
#ifndef NONSMOOTH_TESTS_JUDGE_H
#define NONSMOOTH_TESTS_JUDGE_H

#include "spice.h"

#define JUDGE_WRONG 1e-3

typedef enum judge_verdict {
    JUDGE_RIGHT,
    JUDGE_WRONG_AUTO,   /* what a user gets by default */
    JUDGE_WRONG_KERNEL, /* "exact" or "sparse", if asked for */
    JUDGE_REFUSED,
    JUDGE_REFUSED_KERNEL,
    JUDGE_UNDECIDED,
    JUDGE_SLOW,
    JUDGE_CRASHED,
    JUDGE_VERDICTS
} judge_verdict;

/* The runs. */
enum {
    J_AUTO,
    J_SHUFFLED,
    J_SPICE, /* "auto" in ngspice, if options.spice.models says where our code models are */
    J_EXACT,
    J_SPARSE,
    J_CANDIDATES,
    J_TIGHT = J_CANDIDATES,
    J_THETA,
    J_THETA2,
    J_VARIED,
    J_RUNS
};

typedef struct judge_options {
    double limit;  /* s of CPU for one run */
    int theta;     /* 1: the theta scheme even if all agree */
    unsigned runs; /* bits: candidates that are run; 0: all */
    int verbose;
    spice_home spice;
} judge_options;

typedef struct judge_finding {
    judge_verdict verdict;
    int culprit;    /* which run */
    char line[600]; /* what differs, for a person */
    char kind[64];  /* short, for sorting: "auto wrong v" */
    double seconds; /* of "auto" */
} judge_finding;

judge_finding judge(const netlist *n, const judge_options *o);

/* What an engine needed. */
typedef struct judge_cost {
    const char *name;
    run_end end;
    int agrees; /* 1: it is done, and its results are those of the first of these that is done */
    double seconds, effort;
} judge_cost;

/* "auto", "exact" and "sparse" with its steps of 64 h, each within `limit` s of CPU (auto: four times that).
 * 0: the netlist is not understood. */
enum { JUDGE_ENGINES = 3 };
int judge_engines(const netlist *n, double limit, judge_cost cost[JUDGE_ENGINES]);

const char *judge_name(judge_verdict v);

/* The candidates in a list of names, as bits; NULL: all, 0. */
unsigned judge_runs(const char *names);

#endif
