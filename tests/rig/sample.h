/* tests/rig/sample.h - one problem (P1) made backwards from its answer, and what is known of it. */
#ifndef NONSMOOTH_TESTS_SAMPLE_H
#define NONSMOOTH_TESTS_SAMPLE_H

#include "dice.h"
#include "nonsmooth/mlcp.h"

typedef struct sample {
    int cap, m;            /* room for m <= cap */
    double *W, *q, *l, *u; /* the problem, W column by column */
    double *lambda, *y;    /* the answer it was made from */
    double *row, *col;     /* units: W = row_i (natural W_ij) col_j, all of them powers of 2 */
    double *farkas;        /* v, where none: see ns_mlcp_certificate() */
    double *work;          /* cap*cap and work2 the same, for the generators */
    double *work2;
    double *judging;  /* 3*cap: for sample_residual() */
    int none;         /* made to have no solution */
    int unique;       /* W is a P-matrix: there is no other answer */
    int exact;        /* numbers so short that q = y - W lambda was not rounded */
    const char *kind; /* how it was made */
    dice dice;
} sample;

/* Laws that are drawn: any set of them. */
enum {
    LAW_PAIR = 1,     /* [0, inf] */
    LAW_SHIFTED = 2,  /* [l, inf] */
    LAW_REVERSED = 4, /* [-inf, u] */
    LAW_BOX = 8,      /* [l, u] */
    LAW_RELAY = 16,   /* [-1, 1] */
    LAW_FIXED = 32,   /* l = u */
    LAW_EQUALITY = 64 /* [-inf, inf] */
};

int sample_create(int cap, sample *s); /* 0, or -1: no memory */
void sample_free(sample *s);

/* An empty problem of m pairs, W = 0, ready to be made with the dice of `number`. */
void sample_start(sample *s, int m);

double *sample_entry(sample *s, int i, int j); /* W_ij */
double sample_value(sample *s);                /* a number for W: short ones if s->exact */

/* A law of the set for i, lambda_i and y_i that obey it: both on a bound and 0 with probability ties. */
void sample_draw(sample *s, int i, int laws, double ties);
void sample_draw_all(sample *s, int laws, double ties);

/* Ends a problem: q = y - W lambda; then, with probability spoil, in units spread over 2^+-50 = 1e+-15. */
void sample_finish(sample *s, double spoil);
void sample_units(sample *s, int bits); /* every row and column in a unit of its own, 2^-bits .. 2^bits */

ns_mlcp sample_problem(const sample *s);

/* Natural residual of lambda with y = W lambda + q in long double, a violation of row i against the sizes of
 * the terms of that row, in the units in which the problem was made.  NAN where lambda is outside [l,u]. */
double sample_residual(const sample *s, const double *lambda);

/* By how much v proves that there is no solution, in long double, relative to the terms: ns_mlcp_certify()'s
 * claim.
 */
double sample_margin(const sample *s, const double *v);

/* Largest difference to the known lambda, in natural units, relative to the largest of them or 1; *condition
 * gets how much of a relative change of any entry of the problem comes back in it, by the equations of
 * `mode`. */
double sample_error(sample *s, const double *lambda, const ns_mode *mode, double *condition);

#endif
